//! Floor 0: one vocabulary for every width and level of the processor's vector units.
//!
//! A kernel is written once against [`Simd`] and compiled whole for each level ([`Dispatch`]); which one runs is
//! decided once. All levels round alike: only [`Lanes::mul_add`] and [`Lanes::mul_sub`] may or may not be fused, and
//! they serve tests whose bounds allow for both.

#[cfg(target_arch = "aarch64")]
mod arm;
mod level;
mod loops;
mod pack;
mod pair;
mod scalar;
mod transpose;
#[cfg(target_arch = "x86_64")]
mod x86;

#[cfg(target_arch = "aarch64")]
pub use arm::Neon;
pub use level::{Dispatch, Kernel, Level};
pub use loops::loops;
pub use pack::{Column, Word, pack};
pub use pair::Pair;
pub use scalar::Scalar;
pub use transpose::columns_of_four;

/// Asks for the cache line of an address, which need not be valid.
#[inline(always)]
pub fn ask_for(line: *const u8) {
    #[cfg(target_arch = "x86_64")]
    x86::prefetch(line, 1);
    #[cfg(target_arch = "aarch64")]
    arm::prefetch(line, 1);
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    let _ = line;
}
#[cfg(target_arch = "x86_64")]
pub use x86::{Avx2, Avx512, Sse2};

/// Arithmetic on vectors of `N` lanes. A value of a type that implements it proves that the processor has what it
/// needs.
///
/// Masks are bits of a `u32`, lane 0 lowest. Comparisons with NaN are false.
pub trait Lanes<const N: usize>: Copy + Send + Sync {
    /// `N` lanes of f32.
    type F32: Copy;

    /// Whether the processor has instructions that multiply and add with one rounding, to which `f64::mul_add` is
    /// compiled in a kernel; elsewhere that is a call.
    const FUSED: bool;

    /// The same number in every lane.
    fn splat(self, x: f32) -> Self::F32;
    /// Lanes from memory.
    fn load(self, from: &[f32; N]) -> Self::F32;
    /// Lanes to memory.
    fn store(self, x: Self::F32, to: &mut [f32; N]);
    /// `a + b`.
    fn add(self, a: Self::F32, b: Self::F32) -> Self::F32;
    /// `a − b`.
    fn sub(self, a: Self::F32, b: Self::F32) -> Self::F32;
    /// `a · b`.
    fn mul(self, a: Self::F32, b: Self::F32) -> Self::F32;
    /// `a / b`.
    fn div(self, a: Self::F32, b: Self::F32) -> Self::F32;
    /// `−a`.
    fn neg(self, a: Self::F32) -> Self::F32;
    /// `|a|`.
    fn abs(self, a: Self::F32) -> Self::F32;
    /// `a · b − c`, rounded once or twice.
    fn mul_sub(self, a: Self::F32, b: Self::F32, c: Self::F32) -> Self::F32;
    /// `a · b + c`, rounded once or twice.
    fn mul_add(self, a: Self::F32, b: Self::F32, c: Self::F32) -> Self::F32;
    /// The lesser of each pair.
    fn min(self, a: Self::F32, b: Self::F32) -> Self::F32;
    /// The greater of each pair.
    fn max(self, a: Self::F32, b: Self::F32) -> Self::F32;
    /// The lanes of `a` that are in `mask`, and otherwise those of `b`.
    fn select(self, mask: u32, a: Self::F32, b: Self::F32) -> Self::F32;
    /// Lanes where `a ≤ b`.
    fn le(self, a: Self::F32, b: Self::F32) -> u32;
    /// Lanes where `a > b`.
    fn gt(self, a: Self::F32, b: Self::F32) -> u32;
    /// Lanes in which `a` and `b` have the same bits.
    fn same(self, a: Self::F32, b: Self::F32) -> u32;
    /// The greatest of all lanes, none of which is NaN.
    fn greatest(self, a: Self::F32) -> f32;

    /// The least of all lanes, none of which is NaN.
    #[inline(always)]
    fn least(self, a: Self::F32) -> f32 {
        -self.greatest(self.neg(a))
    }
}

/// A level's vectors of `N` lanes, as many as a node has children, and what else nodes and queues of rays need.
pub trait Simd<const N: usize>: Lanes<N> {
    /// Vectors for sixteen rays together, of as many registers as it takes.
    type Sixteen: Lanes<16>;

    /// These.
    fn sixteen(self) -> Self::Sixteen;

    /// Writes some lanes of `nears` and `items` to the front of `to_nears` and `to_items`, and says how many they are;
    /// what is behind them is undefined. They are those of the first `count` in `order`, three bits each from the
    /// lowest, for which `nears ≤ fars`.
    #[allow(clippy::too_many_arguments)]
    fn pick(
        self,
        nears: Self::F32,
        fars: Self::F32,
        items: &[u32; N],
        order: u32,
        count: u32,
        to_nears: &mut [f32; N],
        to_items: &mut [u32; N],
    ) -> usize;

    /// Asks for so many cache lines from an address on, which need not be valid.
    fn prefetch(self, start: *const u8, lines: usize);
}

/// The order of lanes that [`Simd::pick`] takes for the lowest first.
pub const ASCENDING: u32 = 0o76543210;
