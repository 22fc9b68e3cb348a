//! SIMD lanes of 64-bit ARM: NEON, which every such processor has.

use super::scalar::pick_by_lane;
use super::{Lanes, Pair, Simd};
use std::arch::aarch64::*;
use std::arch::asm;

/// NEON: four lanes.
#[derive(Clone, Copy, Debug)]
pub struct Neon(());

impl Neon {
    /// Available on every 64-bit ARM processor.
    #[allow(clippy::new_without_default)]
    pub fn new() -> Self {
        Self(())
    }
}

/// The bit mask of a comparison.
#[inline(always)]
fn mask(lanes: uint32x4_t) -> u32 {
    const BITS: [u32; 4] = [1, 2, 4, 8];
    // SAFETY: every 64-bit ARM processor has the instructions, and four numbers are read.
    unsafe { vaddvq_u32(vandq_u32(lanes, vld1q_u32(BITS.as_ptr()))) }
}

/// Defines safe, always inlined methods of intrinsics.
macro_rules! lanes {
    ($($name:ident($($arg:ident: $type:ty),*) $(-> $ret:ty)? = $body:expr;)*) => {$(
        #[inline(always)]
        #[allow(unused_unsafe)]
        fn $name(self, $($arg: $type),*) $(-> $ret)? {
            // SAFETY: every 64-bit ARM processor has the instructions, and references to arrays of four numbers are
            // valid for four numbers; no alignment is assumed.
            unsafe { $body }
        }
    )*};
}

impl Lanes<4> for Neon {
    type F32 = float32x4_t;
    const FUSED: bool = true;

    lanes! {
        splat(x: f32) -> float32x4_t = vdupq_n_f32(x);
        load(from: &[f32; 4]) -> float32x4_t = vld1q_f32(from.as_ptr());
        store(x: float32x4_t, to: &mut [f32; 4]) = vst1q_f32(to.as_mut_ptr(), x);
        add(a: float32x4_t, b: float32x4_t) -> float32x4_t = vaddq_f32(a, b);
        sub(a: float32x4_t, b: float32x4_t) -> float32x4_t = vsubq_f32(a, b);
        mul(a: float32x4_t, b: float32x4_t) -> float32x4_t = vmulq_f32(a, b);
        div(a: float32x4_t, b: float32x4_t) -> float32x4_t = vdivq_f32(a, b);
        neg(a: float32x4_t) -> float32x4_t = vnegq_f32(a);
        abs(a: float32x4_t) -> float32x4_t = vabsq_f32(a);
        mul_sub(a: float32x4_t, b: float32x4_t, c: float32x4_t) -> float32x4_t = vfmaq_f32(vnegq_f32(c), a, b);
        mul_add(a: float32x4_t, b: float32x4_t, c: float32x4_t) -> float32x4_t = vfmaq_f32(c, a, b);
        // NEON's own instructions return NaN if either is NaN, and distinguish zeros.
        min(a: float32x4_t, b: float32x4_t) -> float32x4_t = vbslq_f32(vcltq_f32(a, b), a, b);
        max(a: float32x4_t, b: float32x4_t) -> float32x4_t = vbslq_f32(vcgtq_f32(a, b), a, b);
        select(mask: u32, a: float32x4_t, b: float32x4_t) -> float32x4_t = {
            const BITS: [u32; 4] = [1, 2, 4, 8];
            vbslq_f32(vtstq_u32(vdupq_n_u32(mask), vld1q_u32(BITS.as_ptr())), a, b)
        };
        le(a: float32x4_t, b: float32x4_t) -> u32 = mask(vcleq_f32(a, b));
        gt(a: float32x4_t, b: float32x4_t) -> u32 = mask(vcgtq_f32(a, b));
        same(a: float32x4_t, b: float32x4_t) -> u32 = {
            mask(vceqq_u32(vreinterpretq_u32_f32(a), vreinterpretq_u32_f32(b)))
        };
        greatest(a: float32x4_t) -> f32 = vmaxvq_f32(a);
    }
}

impl Simd<4> for Neon {
    type Sixteen = Pair<Pair<Self>>;
    const REGISTERS: u32 = 4;

    #[inline(always)]
    fn sixteen(self) -> Pair<Pair<Self>> {
        Pair(Pair(self))
    }

    #[inline(always)]
    fn pick(
        self,
        nears: float32x4_t,
        fars: float32x4_t,
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
        const LINE: usize = 64;
        for line in 0..lines {
            let address = start.wrapping_add(line * LINE);
            // SAFETY: every 64-bit ARM processor has the instruction, which never faults, whatever the address.
            unsafe { asm!("prfm pldl1keep, [{}]", in(reg) address, options(nostack, preserves_flags, readonly)) }
        }
    }
}
