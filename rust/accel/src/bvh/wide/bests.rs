//! The closest hits of sixteen rays so far, and tests of triangles against all of them.

use super::WideBvh;
use super::best::{Best, is_met, primitive};
use super::looking::Looking;
use super::node::Packed;
use super::sixteen::Sixteen;
use raywright_base::math::RayBatch;
use raywright_base::simd::{Lanes, Simd};
use raywright_shapes::triangle::{ALL, Column, EdgeRay, Leaves, RAYS, Spread};

/// Return whether so few of sixteen rays visit a leaf that testing them one by one is cheaper: up to two thirds of its
/// triangles if sixteen rays fit into a register, five sixths if they do not.
#[inline(always)]
pub fn are_few<const N: usize, S: Simd<N>>(_: S, asked: u32, leaf: Packed) -> bool {
    6 * asked.count_ones() <= if S::REGISTERS == 1 { 4 } else { 5 } * leaf.leaf().1
}

/// The closest hits of sixteen rays so far in SoA layout; see [`Best`].
pub struct Bests {
    low: Column<f32>,
    pub high: Column<f32>,
    /// The bits of [`Packed`] leaves, stored as f32 for blends.
    leaf: Column<f32>,
    /// The bits of lanes, stored likewise.
    lane: Column<f32>,
    /// The rays with a hit, if any hit will do.
    pub answered: u32,
}

impl Bests {
    /// For no rays.
    pub const NOTHING: Self = Self {
        low: [0.0; RAYS],
        high: [0.0; RAYS],
        leaf: [f32::from_bits(Packed::NONE.bits()); RAYS],
        lane: [0.0; RAYS],
        answered: 0,
    };

    /// Start without hits, for rays that end at their `t_max`.
    #[inline(always)]
    pub fn clear<S: Lanes<RAYS>>(&mut self, simd: S, rays: &Sixteen) {
        simd.store(simd.load(&rays.t_max[0]), &mut self.low);
        simd.store(simd.load(&rays.t_max[1]), &mut self.high);
        simd.store(simd.splat(f32::from_bits(Packed::NONE.bits())), &mut self.leaf);
        simd.store(simd.splat(0.0), &mut self.lane);
        self.answered = 0;
    }

    /// The closest hit of one ray.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Best {
        let i = i & (RAYS - 1);
        let (leaf, lane) = (Packed::of(self.leaf[i].to_bits()), self.lane[i].to_bits());
        Best { low: self.low[i], high: self.high[i], leaf, lane }
    }

    #[inline(always)]
    pub fn note(&mut self, i: usize, best: Best) {
        let i = i & (RAYS - 1);
        (self.low[i], self.high[i]) = (best.low, best.high);
        (self.leaf[i], self.lane[i]) = (f32::from_bits(best.leaf.bits()), f32::from_bits(best.lane));
    }

    /// Extract one ray, given the batch index of the first one.
    #[inline(always)]
    pub fn looking(&self, rays: &Sixteen, i: usize, start: usize) -> Looking {
        Looking { best: self.get(i), ..Looking::of(rays, i, start + i) }
    }

    /// The rays with a hit.
    #[inline(always)]
    pub fn hits<S: Lanes<RAYS>>(&self, simd: S) -> u32 {
        ALL & !simd.same(simd.load(&self.leaf), simd.splat(f32::from_bits(Packed::NONE.bits())))
    }

    /// The rays that hit the same triangle as ray `i`.
    #[inline(always)]
    pub fn like<S: Lanes<RAYS>>(&self, simd: S, i: usize) -> u32 {
        let i = i & (RAYS - 1);
        simd.same(simd.load(&self.leaf), simd.splat(self.leaf[i]))
            & simd.same(simd.load(&self.lane), simd.splat(self.lane[i]))
    }

    /// Update the limits of some rays in box units; `limits` are the previous ones.
    #[inline(always)]
    pub fn limits<S: Lanes<RAYS>>(&self, simd: S, to_box: f64, changed: u32, limits: S::F32) -> S::F32 {
        // A power of two. If it overflows an f32, nothing is culled.
        let to_box = to_box as f32;
        if to_box > f32::MAX {
            return simd.select(changed, simd.splat(f32::INFINITY), limits);
        }
        let least = simd.splat(f32::MIN_POSITIVE);
        simd.select(changed, simd.mul_add(simd.load(&self.high), simd.splat(to_box), least), limits)
    }

    /// Test a leaf against a few rays one by one, each against all of its triangles. Returns the same as
    /// [`Bests::test`].
    #[inline(always)]
    pub fn visit_alone<const ANY: bool, const N: usize, L: Leaves<N>, S: Simd<N>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        rays: &Sixteen,
        from: (&RayBatch<'_>, usize),
        leaf: Packed,
        asked: u32,
    ) -> u32 {
        let (mut changed, mut rest) = (0, asked);
        while rest != 0 {
            let i = rest.trailing_zeros() as usize & (RAYS - 1);
            rest &= rest - 1;
            let mut ray = self.looking(rays, i, from.1);
            let has_changed = ray.visit::<ANY, N, L, S>(simd, &bvh.leaves, &bvh.region, leaf, from.0);
            if !ANY {
                // The new closest hit may have the same bound in f32.
                self.note(i, ray.best);
            }
            changed |= u32::from(has_changed) << i;
        }
        changed
    }

    /// Test a leaf against the rays in `asked`, each triangle against all of them. Returns the same as [`Bests::test`].
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    pub fn visit<const ANY: bool, const N: usize, L: Leaves<N>, S: Simd<N>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        rays: &Sixteen,
        from: (&RayBatch<'_>, usize),
        triangles: &Spread<N>,
        leaf: Packed,
        asked: u32,
    ) -> u32 {
        let mut changed = 0;
        for lane in 0..leaf.leaf().1 {
            // If any hit will do, finished rays drop out.
            let asked = if ANY { asked & !changed } else { asked };
            changed |= self.test::<ANY, N, L, _>(simd.sixteen(), bvh, rays, from, triangles, leaf, lane, asked);
        }
        changed
    }

    /// Test the triangle in a lane of a leaf against the rays in `asked`. Return the rays whose closest hit has changed
    /// or, if any hit will do, those with a hit.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn test<const ANY: bool, const N: usize, L: Leaves<N>, S: Lanes<RAYS>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        rays: &Sixteen,
        from: (&RayBatch<'_>, usize),
        triangles: &Spread<N>,
        leaf: Packed,
        lane: u32,
        asked: u32,
    ) -> u32 {
        let Some(bracket) = triangles.bracket(simd, &rays.blocks, lane as usize, asked) else { return 0 };
        let (low, high) = (simd.load(&self.low), simd.load(&self.high));
        let (earliest, latest) = (simd.load(&rays.t_min[0]), simd.load(&rays.t_min[1]));
        let beyond = simd.gt(bracket.low, high) | simd.gt(earliest, bracket.high);
        let mut open = bracket.possible & !(bracket.known & beyond);
        if open == 0 {
            return 0;
        }
        let sure = bracket.known & bracket.inside & simd.gt(bracket.low, latest) & simd.gt(low, bracket.high);
        let sure = open & sure;
        open &= !sure;
        let mut changed = sure;
        if !ANY {
            simd.store_some(sure, bracket.low, &mut self.low);
            simd.store_some(sure, bracket.high, &mut self.high);
            simd.store_some(sure, simd.splat(f32::from_bits(leaf.bits())), &mut self.leaf);
            simd.store_some(sure, simd.splat(f32::from_bits(lane)), &mut self.lane);
        }
        while open != 0 {
            let i = open.trailing_zeros() as usize;
            open &= open - 1;
            if from.0.misses(from.1 + i, primitive(&bvh.leaves, leaf, lane)) {
                continue;
            }
            changed |= u32::from(self.decide::<ANY, N, L>(bvh, from.0, from.1, i, leaf, lane)) << i;
        }
        changed
    }

    /// Decide in f64 for a ray and a triangle.
    #[inline(never)]
    fn decide<const ANY: bool, const N: usize, L: Leaves<N>>(
        &mut self,
        bvh: &WideBvh<N, L>,
        rays: &RayBatch<'_>,
        start: usize,
        i: usize,
        leaf: Packed,
        lane: u32,
    ) -> bool {
        let mut best = self.get(i);
        if !ANY && best.is(&bvh.leaves, leaf, lane) {
            return false;
        }
        let Some(ray) = EdgeRay::new(&rays.get(start + i), &bvh.region) else { return false };
        if ANY {
            return is_met(&bvh.leaves, &ray, leaf, lane);
        }
        let before = best.high;
        best.decide(&bvh.leaves, L::unit(&bvh.region), &ray, leaf, lane);
        self.note(i, best);
        best.high < before
    }
}
