//! A ray in search of its first hit or any hit. f32 gives an interval for the `t` of a triangle, and decides wherever
//! that suffices; f64 decides the rest.

use super::best::{Best, is_met, primitive};
use super::node::Packed;
use super::sixteen::Sixteen;
use raywright_base::math::{Ray, RayBatch, Region};
use raywright_base::simd::Simd;
use raywright_shapes::triangle::{BlockRay, EdgeRay, Leaves, RAYS};

/// A ray in search of its first hit.
pub struct Looking {
    pub lanes: BlockRay,
    /// An interval that contains its `t_min`.
    pub t_min: (f32, f32),
    pub best: Best,
    pub ray: usize,
}

impl Looking {
    /// Extract one of sixteen rays, with index `ray` in the batch.
    #[inline(always)]
    pub fn of(rays: &Sixteen, i: usize, ray: usize) -> Self {
        let i = i & (RAYS - 1);
        Self {
            lanes: rays.blocks.of(i),
            t_min: (rays.t_min[0][i], rays.t_min[1][i]),
            best: Best { leaf: Packed::NONE, lane: 0, low: rays.t_max[0][i], high: rays.t_max[1][i] },
            ray,
        }
    }

    /// Test the triangles of a leaf. Return whether the closest hit has changed or, if any hit will do, whether there
    /// is one.
    #[inline(always)]
    pub fn visit<const ANY: bool, const N: usize, L: Leaves<N>, S: Simd<N>>(
        &mut self,
        simd: S,
        leaves: &L,
        region: &Region,
        leaf: Packed,
        rays: &RayBatch<'_>,
    ) -> bool {
        let (first, count) = leaf.leaf();
        let bracket = leaves.bracket(simd, &self.lanes, first, count);
        let best = &mut self.best;
        let beyond = simd.gt(bracket.low, simd.splat(best.high)) | simd.gt(simd.splat(self.t_min.0), bracket.high);
        let mut open = bracket.possible & !(bracket.known & beyond);
        if open == 0 {
            return false;
        }
        let mut sure = open & bracket.known & bracket.inside & simd.gt(bracket.low, simd.splat(self.t_min.1));
        if ANY {
            if sure & simd.gt(simd.splat(best.low), bracket.high) != 0 {
                return true;
            }
            while open != 0 {
                let lane = open.trailing_zeros();
                open &= open - 1;
                if decide_any(leaves, region, &rays.get(self.ray), leaf, lane) {
                    return true;
                }
            }
            return false;
        }
        let (mut low, mut high) = ([0f32; N], [0f32; N]);
        simd.store(bracket.low, &mut low);
        simd.store(bracket.high, &mut high);
        let mut changed = false;
        while sure != 0 {
            let lane = sure.trailing_zeros();
            sure &= sure - 1;
            let at = lane as usize & (N - 1);
            if high[at] < best.low {
                *best = Best { low: low[at], high: high[at], leaf, lane };
                open &= !(1 << lane);
                changed = true;
            }
        }
        while open != 0 {
            let lane = open.trailing_zeros();
            open &= open - 1;
            // A closest hit found earlier, or in this loop, may be nearer.
            let is_beyond = bracket.known >> lane & 1 == 1 && low[lane as usize & (N - 1)] > best.high;
            if !is_beyond && !best.is(leaves, leaf, lane) {
                let before = best.high;
                decide(leaves, region, &rays.get(self.ray), leaf, lane, best);
                changed |= best.high < before;
            }
        }
        changed
    }
}

/// See [`Best::decide`].
#[inline(never)]
fn decide<const N: usize, L: Leaves<N>>(
    leaves: &L,
    region: &Region,
    ray: &Ray,
    leaf: Packed,
    lane: u32,
    best: &mut Best,
) {
    if ray.misses.contains(&primitive(leaves, leaf, lane)) {
        return;
    }
    if let Some(ray) = EdgeRay::new(ray, region) {
        best.decide(leaves, L::unit(region), &ray, leaf, lane);
    }
}

/// Return whether a ray hits a triangle, decided in f64.
#[inline(never)]
fn decide_any<const N: usize, L: Leaves<N>>(leaves: &L, region: &Region, ray: &Ray, leaf: Packed, lane: u32) -> bool {
    !ray.misses.contains(&primitive(leaves, leaf, lane))
        && EdgeRay::new(ray, region).is_some_and(|ray| is_met(leaves, &ray, leaf, lane))
}
