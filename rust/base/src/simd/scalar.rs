//! Lanes as plain arrays, for processors without a level of their own, and as the reference for the other levels.
//!
//! Tests compile every kernel for it. Operations are function calls there, which takes an eighth less time to compile,
//! and no longer to run.

use super::{Lanes, Simd};
use std::array::from_fn;

/// No explicit vector instructions.
#[derive(Clone, Copy, Debug)]
pub struct Scalar;

#[inline(always)]
fn mask<const N: usize>(lane: impl Fn(usize) -> bool) -> u32 {
    (0..N).fold(0, |m, i| m | u32::from(lane(i)) << i)
}

/// [`Simd::pick`] lane by lane and branchless: each lane is written, and overwritten unless it counts.
#[inline(always)]
pub(super) fn pick_by_lane<const N: usize>(
    nears: [f32; N],
    picked: u32,
    items: &[u32; N],
    order: u32,
    count: u32,
    to_nears: &mut [f32; N],
    to_items: &mut [u32; N],
) -> usize {
    let mut to = 0;
    for i in 0..N {
        let lane = (order >> (3 * i)) as usize & (N - 1);
        to_nears[to & (N - 1)] = nears[lane];
        to_items[to & (N - 1)] = items[lane];
        to += (picked >> lane & 1) as usize & usize::from((i as u32) < count);
    }
    to
}

impl<const N: usize> Lanes<N> for Scalar {
    type F32 = [f32; N];
    const FUSED: bool = false;

    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn splat(self, x: f32) -> [f32; N] {
        [x; N]
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn load(self, from: &[f32; N]) -> [f32; N] {
        *from
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn store(self, x: [f32; N], to: &mut [f32; N]) {
        *to = x;
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn add(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        from_fn(|i| a[i] + b[i])
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn sub(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        from_fn(|i| a[i] - b[i])
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn mul(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        from_fn(|i| a[i] * b[i])
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn div(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        from_fn(|i| a[i] / b[i])
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn neg(self, a: [f32; N]) -> [f32; N] {
        a.map(|x| -x)
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn abs(self, a: [f32; N]) -> [f32; N] {
        a.map(|x| x.abs())
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn mul_sub(self, a: [f32; N], b: [f32; N], c: [f32; N]) -> [f32; N] {
        from_fn(|i| a[i] * b[i] - c[i])
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn mul_add(self, a: [f32; N], b: [f32; N], c: [f32; N]) -> [f32; N] {
        from_fn(|i| a[i] * b[i] + c[i])
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn min(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        from_fn(|i| if a[i] < b[i] { a[i] } else { b[i] })
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn max(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        from_fn(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn select(self, mask: u32, a: [f32; N], b: [f32; N]) -> [f32; N] {
        from_fn(|i| if mask >> i & 1 == 1 { a[i] } else { b[i] })
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn le(self, a: [f32; N], b: [f32; N]) -> u32 {
        mask::<N>(|i| a[i] <= b[i])
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn gt(self, a: [f32; N], b: [f32; N]) -> u32 {
        mask::<N>(|i| a[i] > b[i])
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn same(self, a: [f32; N], b: [f32; N]) -> u32 {
        mask::<N>(|i| a[i].to_bits() == b[i].to_bits())
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn greatest(self, a: [f32; N]) -> f32 {
        a.into_iter().fold(f32::NEG_INFINITY, |most, x| if x > most { x } else { most })
    }
}

impl<const N: usize> Simd<N> for Scalar {
    type Sixteen = Self;
    const REGISTERS: u32 = 16;

    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn sixteen(self) -> Self {
        self
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn pick(
        self,
        nears: [f32; N],
        fars: [f32; N],
        items: &[u32; N],
        order: u32,
        count: u32,
        to_nears: &mut [f32; N],
        to_items: &mut [u32; N],
    ) -> usize {
        pick_by_lane(nears, mask::<N>(|i| nears[i] <= fars[i]), items, order, count, to_nears, to_items)
    }
    #[cfg_attr(test, inline(never))]
    #[cfg_attr(not(test), inline(always))]
    fn prefetch(self, _: *const u8, _: usize) {}
}
