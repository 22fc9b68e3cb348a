//! Lanes of x86-64: SSE2, which every such processor has, and AVX2 with FMA.

use super::Simd;
use std::arch::x86_64::*;

/// SSE2: four lanes.
#[derive(Clone, Copy, Debug)]
pub struct Sse2(());

impl Sse2 {
    /// Every x86-64 processor has it.
    #[allow(clippy::new_without_default)]
    pub fn new() -> Self {
        Self(())
    }
}

/// AVX2 and FMA: four lanes or eight.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

impl Avx2 {
    /// Some on a processor that has it.
    pub fn detect() -> Option<Self> {
        (is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")).then_some(Self(()))
    }
}

#[inline(always)]
fn prefetch<T>(what: &T) {
    const LINE: usize = 64;
    let start = std::ptr::from_ref(what).cast::<i8>();
    for offset in (0..size_of::<T>()).step_by(LINE) {
        // SAFETY: every x86-64 processor has the instruction, and the address lies within `what`.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(offset)) }
    }
}

/// Makes safe, always inlined methods of intrinsics.
macro_rules! lanes {
    ($($name:ident($($arg:ident: $type:ty),*) $(-> $ret:ty)? = $body:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, $($arg: $type),*) $(-> $ret)? {
            // SAFETY: `self` exists only where the processor has the instructions, and references to arrays of N
            // numbers are valid for N numbers; no alignment is assumed.
            unsafe { $body }
        }
    )*};
}

impl Simd<4> for Sse2 {
    type F32 = __m128;

    lanes! {
        splat(x: f32) -> __m128 = _mm_set1_ps(x);
        load(from: &[f32; 4]) -> __m128 = _mm_loadu_ps(from.as_ptr());
        store(x: __m128, to: &mut [f32; 4]) = _mm_storeu_ps(to.as_mut_ptr(), x);
        add(a: __m128, b: __m128) -> __m128 = _mm_add_ps(a, b);
        sub(a: __m128, b: __m128) -> __m128 = _mm_sub_ps(a, b);
        mul(a: __m128, b: __m128) -> __m128 = _mm_mul_ps(a, b);
        neg(a: __m128) -> __m128 = _mm_xor_ps(_mm_set1_ps(-0.0), a);
        abs(a: __m128) -> __m128 = _mm_andnot_ps(_mm_set1_ps(-0.0), a);
        mul_sub(a: __m128, b: __m128, c: __m128) -> __m128 = _mm_sub_ps(_mm_mul_ps(a, b), c);
        mul_add(a: __m128, b: __m128, c: __m128) -> __m128 = _mm_add_ps(_mm_mul_ps(a, b), c);
        min(a: __m128, b: __m128) -> __m128 = _mm_min_ps(a, b);
        max(a: __m128, b: __m128) -> __m128 = _mm_max_ps(a, b);
        le(a: __m128, b: __m128) -> u32 = _mm_movemask_ps(_mm_cmple_ps(a, b)) as u32;
        gt(a: __m128, b: __m128) -> u32 = _mm_movemask_ps(_mm_cmpgt_ps(a, b)) as u32;
    }

    #[inline(always)]
    fn prefetch<T>(self, what: &T) {
        prefetch(what);
    }
}

impl Simd<4> for Avx2 {
    type F32 = __m128;

    lanes! {
        splat(x: f32) -> __m128 = _mm_set1_ps(x);
        load(from: &[f32; 4]) -> __m128 = _mm_loadu_ps(from.as_ptr());
        store(x: __m128, to: &mut [f32; 4]) = _mm_storeu_ps(to.as_mut_ptr(), x);
        add(a: __m128, b: __m128) -> __m128 = _mm_add_ps(a, b);
        sub(a: __m128, b: __m128) -> __m128 = _mm_sub_ps(a, b);
        mul(a: __m128, b: __m128) -> __m128 = _mm_mul_ps(a, b);
        neg(a: __m128) -> __m128 = _mm_xor_ps(_mm_set1_ps(-0.0), a);
        abs(a: __m128) -> __m128 = _mm_andnot_ps(_mm_set1_ps(-0.0), a);
        mul_sub(a: __m128, b: __m128, c: __m128) -> __m128 = _mm_fmsub_ps(a, b, c);
        mul_add(a: __m128, b: __m128, c: __m128) -> __m128 = _mm_fmadd_ps(a, b, c);
        min(a: __m128, b: __m128) -> __m128 = _mm_min_ps(a, b);
        max(a: __m128, b: __m128) -> __m128 = _mm_max_ps(a, b);
        le(a: __m128, b: __m128) -> u32 = _mm_movemask_ps(_mm_cmple_ps(a, b)) as u32;
        gt(a: __m128, b: __m128) -> u32 = _mm_movemask_ps(_mm_cmpgt_ps(a, b)) as u32;
    }

    #[inline(always)]
    fn prefetch<T>(self, what: &T) {
        prefetch(what);
    }
}

impl Simd<8> for Avx2 {
    type F32 = __m256;

    lanes! {
        splat(x: f32) -> __m256 = _mm256_set1_ps(x);
        load(from: &[f32; 8]) -> __m256 = _mm256_loadu_ps(from.as_ptr());
        store(x: __m256, to: &mut [f32; 8]) = _mm256_storeu_ps(to.as_mut_ptr(), x);
        add(a: __m256, b: __m256) -> __m256 = _mm256_add_ps(a, b);
        sub(a: __m256, b: __m256) -> __m256 = _mm256_sub_ps(a, b);
        mul(a: __m256, b: __m256) -> __m256 = _mm256_mul_ps(a, b);
        neg(a: __m256) -> __m256 = _mm256_xor_ps(_mm256_set1_ps(-0.0), a);
        abs(a: __m256) -> __m256 = _mm256_andnot_ps(_mm256_set1_ps(-0.0), a);
        mul_sub(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fmsub_ps(a, b, c);
        mul_add(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fmadd_ps(a, b, c);
        min(a: __m256, b: __m256) -> __m256 = _mm256_min_ps(a, b);
        max(a: __m256, b: __m256) -> __m256 = _mm256_max_ps(a, b);
        le(a: __m256, b: __m256) -> u32 = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32;
        gt(a: __m256, b: __m256) -> u32 = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(a, b)) as u32;
    }

    #[inline(always)]
    fn prefetch<T>(self, what: &T) {
        prefetch(what);
    }
}
