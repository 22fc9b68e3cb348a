//! Floor 0: SIMD vectors, generic over width and instruction set.
//!
//! A kernel is written once against [`Simd`] and compiled as a whole for each level ([`Dispatch`]); the choice is made
//! once. All levels round alike, except that [`Lanes::mul_add`] and [`Lanes::mul_sub`] may be fused. They are used only
//! in tests whose bounds allow for both.

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

use std::sync::atomic::{Ordering, compiler_fence};

/// Prefetch the cache line of an address, which need not be valid.
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

/// Arithmetic on vectors of `N` lanes. A value of an implementing type proves that the processor supports it.
///
/// Masks are bits of a `u32`, lane 0 lowest. Comparisons with NaN are false.
pub trait Lanes<const N: usize>: Copy + Send + Sync {
    /// `N` lanes of f32.
    type F32: Copy;

    /// True if the processor has fused multiply-add instructions, to which `f64::mul_add` is compiled in a kernel;
    /// otherwise that is a function call.
    const FUSED: bool;

    /// Broadcast a number to every lane.
    fn splat(self, x: f32) -> Self::F32;
    /// Load from memory.
    fn load(self, from: &[f32; N]) -> Self::F32;
    /// Store to memory.
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
    /// The lanewise minimum.
    fn min(self, a: Self::F32, b: Self::F32) -> Self::F32;
    /// The lanewise maximum.
    fn max(self, a: Self::F32, b: Self::F32) -> Self::F32;
    /// Blend: the lanes of `a` that are in `mask`, else those of `b`.
    fn select(self, mask: u32, a: Self::F32, b: Self::F32) -> Self::F32;
    /// Store the lanes of `a` that are in `mask`; others keep their numbers.
    #[inline(always)]
    fn store_some(self, mask: u32, a: Self::F32, to: &mut [f32; N]) {
        let blended = self.select(mask, a, self.load(to));
        // Without it, load, blend and store become a masked store, which takes processors of AMD twelve cycles.
        compiler_fence(Ordering::SeqCst);
        self.store(blended, to);
    }
    /// Lanes where `a ≤ b`.
    fn le(self, a: Self::F32, b: Self::F32) -> u32;
    /// Lanes where `a > b`.
    fn gt(self, a: Self::F32, b: Self::F32) -> u32;
    /// Lanes in which `a` and `b` have the same bits.
    fn same(self, a: Self::F32, b: Self::F32) -> u32;
    /// The maximum of all lanes, none of which is NaN.
    fn greatest(self, a: Self::F32) -> f32;

    /// The minimum of all lanes, none of which is NaN.
    #[inline(always)]
    fn least(self, a: Self::F32) -> f32 {
        -self.greatest(self.neg(a))
    }
}

/// A level's vectors of `N` lanes, the number of a node's children, with further operations for nodes and ray packets.
pub trait Simd<const N: usize>: Lanes<N> {
    /// Vectors for sixteen rays, in as many registers as needed.
    type Sixteen: Lanes<16>;

    /// The number of registers that they take.
    const REGISTERS: u32;

    /// Convert to those vectors.
    fn sixteen(self) -> Self::Sixteen;

    /// Compact the lanes with `nears ≤ fars` among the first `count` in `order`, which has three bits per lane from the
    /// lowest. Their `nears` and `items` are written to the front of `to_nears` and `to_items`; the entries after them
    /// are undefined. Return their number.
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

    /// Prefetch a number of cache lines from an address, which need not be valid.
    fn prefetch(self, start: *const u8, lines: usize);
}

/// The order of lanes in [`Simd::pick`] that starts with the lowest.
pub const ASCENDING: u32 = 0o76543210;
