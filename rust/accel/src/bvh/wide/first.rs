//! The visitor for first hits and occlusion ([`Looking`]). Closest hits are computed in f64 once, at the end
//! ([`Winners`]), by the formula that all accelerators share.

use super::WideBvh;
use super::best::{Best, between};
use super::hit_sink::Answer;
use super::leaf_visitor::{Errand, Visited};
use super::looking::Looking;
use super::node::Packed;
use super::refine_hits::{Settling, Winners};
use super::sixteen::Sixteen;
use raywright_base::math::RayBatch;
use raywright_base::simd::Simd;
use raywright_shapes::triangle::{EdgeRay, Leaves, RAYS};

/// The visitor for first hits or occlusion.
pub struct First<'a, A, W = Winners> {
    pub rays: &'a RayBatch<'a>,
    pub answer: &'a mut A,
    pub winners: W,
}

impl<A: Answer, W: Settling> First<'_, A, W> {
    /// Finish ray `i`, whose closest hit is final.
    #[inline(always)]
    pub fn conclude<const N: usize, L: Leaves<N>, S: Simd<N>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        i: usize,
        best: &Best,
    ) {
        if best.leaf == Packed::NONE {
            self.answer.miss(i);
        } else if A::ANY {
            self.answer.hit(i, 0.0, [0.0; 2], 0);
        } else {
            self.winners.add(simd.sixteen(), bvh, self.rays, i, best, self.answer);
        }
    }
}

impl<const N: usize, L: Leaves<N>, A: Answer, W: Settling> Errand<N, L> for First<'_, A, W> {
    type Flight = Looking;
    const NEAREST_FIRST: bool = !A::ANY;
    const SHORTENS: bool = !A::ANY;

    #[inline(always)]
    fn start(&mut self, bvh: &WideBvh<N, L>, i: usize, edges: &EdgeRay) -> Looking {
        let unit = L::unit(&bvh.region);
        Looking {
            lanes: L::ray(edges, &bvh.region),
            t_min: between(edges.t_min * unit),
            best: Best::until(edges.t_max * unit),
            ray: i,
        }
    }

    #[inline(always)]
    fn limit(bvh: &WideBvh<N, L>, flight: &Looking) -> f64 {
        f64::from(flight.best.high) / L::unit(&bvh.region)
    }

    #[inline(always)]
    fn launch(&mut self, _: &WideBvh<N, L>, i: usize, rays: &Sixteen, lane: usize) -> Option<(Looking, f32)> {
        Some((Looking::of(rays, lane, i), rays.slabs.limit[lane & (RAYS - 1)]))
    }

    #[inline(always)]
    fn visit<S: Simd<N>>(&mut self, simd: S, bvh: &WideBvh<N, L>, flight: &mut Looking, at: Packed) -> Visited {
        if A::ANY {
            if flight.visit::<true, N, L, S>(simd, &bvh.leaves, &bvh.region, at, self.rays) {
                // Any hit will do.
                flight.best.leaf = at;
                return Visited::Answered;
            }
        } else if flight.visit::<false, N, L, S>(simd, &bvh.leaves, &bvh.region, at, self.rays) {
            return Visited::Until(f64::from(flight.best.high) / L::unit(&bvh.region));
        }
        Visited::Nothing
    }

    #[inline(always)]
    fn finish<S: Simd<N>>(&mut self, simd: S, bvh: &WideBvh<N, L>, flight: &Looking) {
        self.conclude(simd, bvh, flight.ray, &flight.best);
    }

    #[inline(always)]
    fn miss(&mut self, i: usize) {
        self.answer.miss(i);
    }

    #[inline(always)]
    fn end<S: Simd<N>>(&mut self, simd: S, bvh: &WideBvh<N, L>) {
        self.winners.settle(simd.sixteen(), bvh, self.rays, self.answer);
    }
}
