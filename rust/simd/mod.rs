//! Floor 0: one vocabulary for every width and level of the processor's vector units.
//!
//! A kernel is written once against [`Simd`] and compiled whole for each level ([`Dispatch`]); which one runs is decided
//! once. All levels round alike: only [`Simd::mul_add`] and [`Simd::mul_sub`] may or may not be fused, and they serve tests
//! whose bounds allow for both.

mod level;
mod scalar;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use level::{Dispatch, Kernel, Level};
pub use scalar::Scalar;
#[cfg(target_arch = "x86_64")]
pub use x86::{Avx2, Sse2};

/// Vectors of `N` lanes. A value of a type that implements it proves that the processor has what it needs.
///
/// Masks are bits of a `u32`, lane 0 lowest. Comparisons with NaN are false.
pub trait Simd<const N: usize>: Copy + Send + Sync {
    /// `N` lanes of f32.
    type F32: Copy;

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
    /// Lanes where `a ≤ b`.
    fn le(self, a: Self::F32, b: Self::F32) -> u32;
    /// Lanes where `a > b`.
    fn gt(self, a: Self::F32, b: Self::F32) -> u32;

    /// Asks for every cache line of something that will be needed soon.
    fn prefetch<T>(self, what: &T);
}
