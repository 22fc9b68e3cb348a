//! What a ray hits first, or whether it hits anything: f32 says between which two numbers the `t` of a triangle lies,
//! and decides wherever that is enough; f64 decides the rest. What has won is computed in f64 once, at the end
//! ([`Winners`]), by the formula that all accelerators have.

use super::WideBvh;
use super::answer::Answer;
use super::best::{Best, between, meet};
use super::errand::{Errand, Visited};
use super::node::Packed;
use super::sixteen::Sixteen;
use super::winners::Winners;
use crate::math::{Ray, RayBatch, Region};
use crate::shapes::triangle::{BlockRay, EdgeRay, Leaves, RAYS};
use crate::simd::Simd;

/// The first hits of rays, or whether they have any.
pub struct First<'a, A> {
    pub rays: &'a RayBatch<'a>,
    pub answer: &'a mut A,
    pub winners: Winners,
}

impl<A: Answer> First<'_, A> {
    /// Nothing better is to be found for ray `i`.
    #[inline(always)]
    pub fn conclude<const N: usize, L: Leaves<N>>(&mut self, bvh: &WideBvh<N, L>, i: usize, best: &Best) {
        if best.leaf == Packed::NONE {
            self.answer.miss(i);
        } else if A::ANY {
            self.answer.hit(i, 0.0, [0.0; 2], 0);
        } else {
            self.winners.add(bvh, self.rays, i, best, self.answer);
        }
    }
}

/// A ray that looks for its first hit.
pub struct Looking {
    pub lanes: BlockRay,
    /// Between these its `t_min` lies.
    pub t_min: (f32, f32),
    pub best: Best,
    pub ray: usize,
}

impl Looking {
    /// One of sixteen, ray `ray` of the batch.
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

    /// Tests the triangles of a leaf. Whether what is known has changed; if any hit will do, whether there is one.
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
            // What has won already, or won meanwhile, may lie before it.
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
    if let Some(ray) = EdgeRay::new(ray, region) {
        best.decide(leaves, L::unit(region), &ray, leaf, lane);
    }
}

/// Whether a ray meets a triangle, decided in f64.
#[inline(never)]
fn decide_any<const N: usize, L: Leaves<N>>(leaves: &L, region: &Region, ray: &Ray, leaf: Packed, lane: u32) -> bool {
    EdgeRay::new(ray, region).is_some_and(|ray| meet(leaves, &ray, leaf, lane).is_some())
}

impl<const N: usize, L: Leaves<N>, A: Answer> Errand<N, L> for First<'_, A> {
    type Flight = Looking;
    const NEAREST_FIRST: bool = !A::ANY;

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
                // Whatever it is.
                flight.best.leaf = at;
                return Visited::Answered;
            }
        } else if flight.visit::<false, N, L, S>(simd, &bvh.leaves, &bvh.region, at, self.rays) {
            return Visited::Until(f64::from(flight.best.high) / L::unit(&bvh.region));
        }
        Visited::Nothing
    }

    #[inline(always)]
    fn finish(&mut self, bvh: &WideBvh<N, L>, flight: &Looking) {
        self.conclude(bvh, flight.ray, &flight.best);
    }

    #[inline(always)]
    fn miss(&mut self, i: usize) {
        self.answer.miss(i);
    }

    #[inline(always)]
    fn end(&mut self, bvh: &WideBvh<N, L>) {
        self.winners.settle(bvh, self.rays, self.answer);
    }
}
