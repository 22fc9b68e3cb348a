//! SIMD lanes of x86-64: SSE2, which every such processor has, AVX2 with FMA, and AVX-512.

use super::scalar::pick_by_lane;
use super::{Lanes, Pair, Simd};
use std::arch::x86_64::*;
use std::sync::OnceLock;

/// SSE2: four lanes.
#[derive(Clone, Copy, Debug)]
pub struct Sse2(());

impl Sse2 {
    /// Available on every x86-64 processor.
    #[allow(clippy::new_without_default)]
    pub fn new() -> Self {
        Self(())
    }
}

/// AVX2 and FMA: eight lanes.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

impl Avx2 {
    /// Some if the processor supports it.
    #[inline]
    pub fn detect() -> Option<Self> {
        static HAS: OnceLock<bool> = OnceLock::new();
        // Every processor with AVX2 has the others, and kernels are compiled for them.
        let has = || {
            is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("popcnt")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("lzcnt")
        };
        HAS.get_or_init(has).then_some(Self(()))
    }
}

/// AVX-512 with vectors of every length: eight or sixteen lanes, and masked compression.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(());

impl Avx512 {
    /// Some if the processor supports it.
    #[inline]
    pub fn detect() -> Option<Self> {
        static HAS: OnceLock<bool> = OnceLock::new();
        let has = || {
            is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw")
                && Avx2::detect().is_some()
        };
        HAS.get_or_init(has).then_some(Self(()))
    }
}

/// For each mask of eight lanes, the indices of its lanes, lowest first, one byte each.
static FRONT: [u64; 256] = {
    let mut front = [0; 256];
    let mut picked = 0;
    while picked < 256 {
        let (mut lane, mut place) = (0, 0);
        while lane < 8 {
            if picked >> lane & 1 == 1 {
                front[picked] |= lane << (8 * place);
                place += 1;
            }
            lane += 1;
        }
        picked += 1;
    }
    front
};

#[inline(always)]
pub(super) fn prefetch(start: *const u8, lines: usize) {
    const LINE: usize = 64;
    for line in 0..lines {
        // SAFETY: every x86-64 processor has the instruction, which never faults, whatever the address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(line * LINE).cast()) }
    }
}

/// The maximum of four.
#[inline(always)]
fn greatest(a: __m128) -> f32 {
    // SAFETY: every x86-64 processor has the instructions.
    unsafe {
        let a = _mm_max_ps(a, _mm_movehl_ps(a, a));
        _mm_cvtss_f32(_mm_max_ss(a, _mm_shuffle_ps::<1>(a, a)))
    }
}

/// Defines safe, always inlined methods of intrinsics.
macro_rules! lanes {
    ($($name:ident($($arg:ident: $type:ty),*) $(-> $ret:ty)? = $body:expr;)*) => {$(
        #[inline(always)]
        #[allow(unused_unsafe)]
        fn $name(self, $($arg: $type),*) $(-> $ret)? {
            // SAFETY: `self` exists only where the processor has the instructions, and references to arrays of N
            // numbers are valid for N numbers; no alignment is assumed.
            unsafe { $body }
        }
    )*};
}

impl Lanes<4> for Sse2 {
    type F32 = __m128;
    const FUSED: bool = false;

    lanes! {
        splat(x: f32) -> __m128 = _mm_set1_ps(x);
        load(from: &[f32; 4]) -> __m128 = _mm_loadu_ps(from.as_ptr());
        store(x: __m128, to: &mut [f32; 4]) = _mm_storeu_ps(to.as_mut_ptr(), x);
        add(a: __m128, b: __m128) -> __m128 = _mm_add_ps(a, b);
        sub(a: __m128, b: __m128) -> __m128 = _mm_sub_ps(a, b);
        mul(a: __m128, b: __m128) -> __m128 = _mm_mul_ps(a, b);
        div(a: __m128, b: __m128) -> __m128 = _mm_div_ps(a, b);
        neg(a: __m128) -> __m128 = _mm_xor_ps(_mm_set1_ps(-0.0), a);
        abs(a: __m128) -> __m128 = _mm_andnot_ps(_mm_set1_ps(-0.0), a);
        mul_sub(a: __m128, b: __m128, c: __m128) -> __m128 = _mm_sub_ps(_mm_mul_ps(a, b), c);
        mul_add(a: __m128, b: __m128, c: __m128) -> __m128 = _mm_add_ps(_mm_mul_ps(a, b), c);
        min(a: __m128, b: __m128) -> __m128 = _mm_min_ps(a, b);
        max(a: __m128, b: __m128) -> __m128 = _mm_max_ps(a, b);
        select(mask: u32, a: __m128, b: __m128) -> __m128 = {
            let bit = _mm_setr_epi32(1, 2, 4, 8);
            let lanes = _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(mask as i32), bit), bit));
            _mm_or_ps(_mm_and_ps(lanes, a), _mm_andnot_ps(lanes, b))
        };
        le(a: __m128, b: __m128) -> u32 = _mm_movemask_ps(_mm_cmple_ps(a, b)) as u32;
        gt(a: __m128, b: __m128) -> u32 = _mm_movemask_ps(_mm_cmpgt_ps(a, b)) as u32;
        same(a: __m128, b: __m128) -> u32 = {
            let same = _mm_cmpeq_epi32(_mm_castps_si128(a), _mm_castps_si128(b));
            _mm_movemask_ps(_mm_castsi128_ps(same)) as u32
        };
        greatest(a: __m128) -> f32 = greatest(a);
    }
}

impl Simd<4> for Sse2 {
    type Sixteen = Pair<Pair<Self>>;
    const REGISTERS: u32 = 4;

    #[inline(always)]
    fn sixteen(self) -> Pair<Pair<Self>> {
        Pair(Pair(self))
    }

    #[inline(always)]
    fn pick(
        self,
        nears: __m128,
        fars: __m128,
        items: &[u32; 4],
        order: u32,
        count: u32,
        to_nears: &mut [f32; 4],
        to_items: &mut [u32; 4],
    ) -> usize {
        let mut distances = [0.0; 4];
        self.store(nears, &mut distances);
        pick_by_lane(distances, self.le(nears, fars), items, order, count, to_nears, to_items)
    }

    #[inline(always)]
    fn prefetch(self, start: *const u8, lines: usize) {
        prefetch(start, lines);
    }
}

impl Lanes<8> for Avx2 {
    type F32 = __m256;
    const FUSED: bool = true;

    lanes! {
        splat(x: f32) -> __m256 = _mm256_set1_ps(x);
        load(from: &[f32; 8]) -> __m256 = _mm256_loadu_ps(from.as_ptr());
        store(x: __m256, to: &mut [f32; 8]) = _mm256_storeu_ps(to.as_mut_ptr(), x);
        add(a: __m256, b: __m256) -> __m256 = _mm256_add_ps(a, b);
        sub(a: __m256, b: __m256) -> __m256 = _mm256_sub_ps(a, b);
        mul(a: __m256, b: __m256) -> __m256 = _mm256_mul_ps(a, b);
        div(a: __m256, b: __m256) -> __m256 = _mm256_div_ps(a, b);
        neg(a: __m256) -> __m256 = _mm256_xor_ps(_mm256_set1_ps(-0.0), a);
        abs(a: __m256) -> __m256 = _mm256_andnot_ps(_mm256_set1_ps(-0.0), a);
        mul_sub(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fmsub_ps(a, b, c);
        mul_add(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fmadd_ps(a, b, c);
        min(a: __m256, b: __m256) -> __m256 = _mm256_min_ps(a, b);
        max(a: __m256, b: __m256) -> __m256 = _mm256_max_ps(a, b);
        select(mask: u32, a: __m256, b: __m256) -> __m256 = {
            let bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let lanes = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(mask as i32), bit), bit);
            _mm256_blendv_ps(b, a, _mm256_castsi256_ps(lanes))
        };
        le(a: __m256, b: __m256) -> u32 = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32;
        gt(a: __m256, b: __m256) -> u32 = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(a, b)) as u32;
        same(a: __m256, b: __m256) -> u32 = {
            let same = _mm256_cmpeq_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b));
            _mm256_movemask_ps(_mm256_castsi256_ps(same)) as u32
        };
        greatest(a: __m256) -> f32 = greatest(_mm_max_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a)));
    }
}

impl Simd<8> for Avx2 {
    type Sixteen = Pair<Self>;
    const REGISTERS: u32 = 2;

    #[inline(always)]
    fn sixteen(self) -> Pair<Self> {
        Pair(self)
    }

    #[inline(always)]
    fn pick(
        self,
        nears: __m256,
        fars: __m256,
        items: &[u32; 8],
        order: u32,
        count: u32,
        to_nears: &mut [f32; 8],
        to_items: &mut [u32; 8],
    ) -> usize {
        // SAFETY: `self` exists only where the processor has the instructions, and the references are to as many
        // numbers.
        unsafe {
            let lanes =
                _mm256_srlv_epi32(_mm256_set1_epi32(order as i32), _mm256_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21));
            let nears = _mm256_permutevar8x32_ps(nears, lanes);
            let fars = _mm256_permutevar8x32_ps(fars, lanes);
            let items = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(items.as_ptr().cast()), lanes);
            let picked = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(nears, fars)) as usize & ((1 << count) - 1);
            let front = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(FRONT[picked & 0xff] as i64));
            _mm256_storeu_ps(to_nears.as_mut_ptr(), _mm256_permutevar8x32_ps(nears, front));
            _mm256_storeu_si256(to_items.as_mut_ptr().cast(), _mm256_permutevar8x32_epi32(items, front));
            picked.count_ones() as usize
        }
    }

    #[inline(always)]
    fn prefetch(self, start: *const u8, lines: usize) {
        prefetch(start, lines);
    }
}

impl Lanes<8> for Avx512 {
    type F32 = __m256;
    const FUSED: bool = true;

    lanes! {
        splat(x: f32) -> __m256 = _mm256_set1_ps(x);
        load(from: &[f32; 8]) -> __m256 = _mm256_loadu_ps(from.as_ptr());
        store(x: __m256, to: &mut [f32; 8]) = _mm256_storeu_ps(to.as_mut_ptr(), x);
        add(a: __m256, b: __m256) -> __m256 = _mm256_add_ps(a, b);
        sub(a: __m256, b: __m256) -> __m256 = _mm256_sub_ps(a, b);
        mul(a: __m256, b: __m256) -> __m256 = _mm256_mul_ps(a, b);
        div(a: __m256, b: __m256) -> __m256 = _mm256_div_ps(a, b);
        neg(a: __m256) -> __m256 = _mm256_xor_ps(_mm256_set1_ps(-0.0), a);
        abs(a: __m256) -> __m256 = _mm256_andnot_ps(_mm256_set1_ps(-0.0), a);
        mul_sub(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fmsub_ps(a, b, c);
        mul_add(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fmadd_ps(a, b, c);
        min(a: __m256, b: __m256) -> __m256 = _mm256_min_ps(a, b);
        max(a: __m256, b: __m256) -> __m256 = _mm256_max_ps(a, b);
        select(mask: u32, a: __m256, b: __m256) -> __m256 = _mm256_mask_blend_ps(mask as u8, b, a);
        le(a: __m256, b: __m256) -> u32 = u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b));
        gt(a: __m256, b: __m256) -> u32 = u32::from(_mm256_cmp_ps_mask::<_CMP_GT_OQ>(a, b));
        same(a: __m256, b: __m256) -> u32 = {
            u32::from(_mm256_cmpeq_epi32_mask(_mm256_castps_si256(a), _mm256_castps_si256(b)))
        };
        greatest(a: __m256) -> f32 = greatest(_mm_max_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a)));
    }
}

impl Lanes<16> for Avx512 {
    type F32 = __m512;
    const FUSED: bool = true;

    lanes! {
        splat(x: f32) -> __m512 = _mm512_set1_ps(x);
        load(from: &[f32; 16]) -> __m512 = _mm512_loadu_ps(from.as_ptr());
        store(x: __m512, to: &mut [f32; 16]) = _mm512_storeu_ps(to.as_mut_ptr(), x);
        add(a: __m512, b: __m512) -> __m512 = _mm512_add_ps(a, b);
        sub(a: __m512, b: __m512) -> __m512 = _mm512_sub_ps(a, b);
        mul(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps(a, b);
        div(a: __m512, b: __m512) -> __m512 = _mm512_div_ps(a, b);
        neg(a: __m512) -> __m512 = _mm512_xor_ps(_mm512_set1_ps(-0.0), a);
        abs(a: __m512) -> __m512 = _mm512_andnot_ps(_mm512_set1_ps(-0.0), a);
        mul_sub(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fmsub_ps(a, b, c);
        mul_add(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fmadd_ps(a, b, c);
        min(a: __m512, b: __m512) -> __m512 = _mm512_min_ps(a, b);
        max(a: __m512, b: __m512) -> __m512 = _mm512_max_ps(a, b);
        select(mask: u32, a: __m512, b: __m512) -> __m512 = _mm512_mask_blend_ps(mask as u16, b, a);
        le(a: __m512, b: __m512) -> u32 = u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b));
        gt(a: __m512, b: __m512) -> u32 = u32::from(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(a, b));
        same(a: __m512, b: __m512) -> u32 = {
            u32::from(_mm512_cmpeq_epi32_mask(_mm512_castps_si512(a), _mm512_castps_si512(b)))
        };
        greatest(a: __m512) -> f32 = {
            let a = _mm256_max_ps(_mm512_castps512_ps256(a), _mm512_extractf32x8_ps::<1>(a));
            greatest(_mm_max_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a)))
        };
    }
}

impl Simd<8> for Avx512 {
    type Sixteen = Self;
    const REGISTERS: u32 = 1;

    #[inline(always)]
    fn sixteen(self) -> Self {
        self
    }

    #[inline(always)]
    fn pick(
        self,
        nears: __m256,
        fars: __m256,
        items: &[u32; 8],
        order: u32,
        count: u32,
        to_nears: &mut [f32; 8],
        to_items: &mut [u32; 8],
    ) -> usize {
        // SAFETY: `self` exists only where the processor has the instructions, and the references are to as many
        // numbers.
        unsafe {
            let lanes =
                _mm256_srlv_epi32(_mm256_set1_epi32(order as i32), _mm256_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21));
            let nears = _mm256_permutexvar_ps(lanes, nears);
            let fars = _mm256_permutexvar_ps(lanes, fars);
            let items = _mm256_permutexvar_epi32(lanes, _mm256_loadu_si256(items.as_ptr().cast()));
            let picked = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(nears, fars) & ((1u32 << count) - 1) as u8;
            // Compressed in a register first: a compressing store to memory is many times slower.
            _mm256_storeu_ps(to_nears.as_mut_ptr(), _mm256_maskz_compress_ps(picked, nears));
            _mm256_storeu_si256(to_items.as_mut_ptr().cast(), _mm256_maskz_compress_epi32(picked, items));
            picked.count_ones() as usize
        }
    }

    #[inline(always)]
    fn prefetch(self, start: *const u8, lines: usize) {
        prefetch(start, lines);
    }
}
