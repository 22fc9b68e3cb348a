//! Computation of closest hits in f64, sixteen at a time.

use super::WideBvh;
use super::best::{Best, meet, primitive};
use super::bests::Bests;
use super::hit_sink::Answer;
use super::node::Packed;
use raywright_base::math::{Ray, RayBatch};
use raywright_base::simd::Lanes;
use raywright_shapes::triangle::{Column, EdgeRay, EdgeRays, Leaves, Met, RAYS, Real};

/// A method that computes closest hits.
pub trait Settling {
    /// Add the hit of ray `i`.
    fn add<const N: usize, L: Leaves<N>, A: Answer, S: Lanes<RAYS>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        rays: &RayBatch<'_>,
        i: usize,
        best: &Best,
        answer: &mut A,
    );

    /// Compute and store all pending hits.
    fn settle<const N: usize, L: Leaves<N>, A: Answer, S: Lanes<RAYS>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        rays: &RayBatch<'_>,
        answer: &mut A,
    );
}

/// Each hit by itself, at once: sixteen together take as long as one.
pub struct Alone;

impl Settling for Alone {
    #[inline(always)]
    fn add<const N: usize, L: Leaves<N>, A: Answer, S: Lanes<RAYS>>(
        &mut self,
        _: S,
        bvh: &WideBvh<N, L>,
        rays: &RayBatch<'_>,
        i: usize,
        best: &Best,
        answer: &mut A,
    ) {
        alone(bvh, rays, i, best.leaf, best.lane, answer);
    }

    #[inline(always)]
    fn settle<const N: usize, L: Leaves<N>, A: Answer, S: Lanes<RAYS>>(
        &mut self,
        _: S,
        _: &WideBvh<N, L>,
        _: &RayBatch<'_>,
        _: &mut A,
    ) {
    }
}

/// Finished rays with the triangles they hit. While one group of sixteen fills up, the previous one waits. Scalar
/// stores must not be followed at once by vector loads of the same data, which would stall.
pub struct Winners {
    sixteens: [RefinedBatch; 2],
    /// The group that fills up.
    filling: usize,
}

/// Up to sixteen finished rays.
struct RefinedBatch {
    rays: [usize; RAYS],
    leaves: Column<Packed>,
    lanes: Column<u32>,
    edges: EdgeRays,
    /// The triangles' corners, by corner and axis.
    corners: [[Column<f64>; 3]; 3],
    len: usize,
}

impl Winners {
    /// Without hits.
    pub fn new() -> Self {
        Self { sixteens: [RefinedBatch::new(), RefinedBatch::new()], filling: 0 }
    }
}

impl Settling for Winners {
    #[inline(always)]
    fn add<const N: usize, L: Leaves<N>, A: Answer, S: Lanes<RAYS>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        rays: &RayBatch<'_>,
        i: usize,
        best: &Best,
        answer: &mut A,
    ) {
        if let Some(primitives) = answer.primitives() {
            primitives[i] = primitive(&bvh.leaves, best.leaf, best.lane);
            return;
        }
        let filling = &mut self.sixteens[self.filling & 1];
        filling.put(bvh, rays, i, best);
        if filling.len == RAYS {
            self.filling ^= 1;
            self.sixteens[self.filling & 1].settle(simd, bvh, rays, answer);
        }
    }

    #[inline(always)]
    fn settle<const N: usize, L: Leaves<N>, A: Answer, S: Lanes<RAYS>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        rays: &RayBatch<'_>,
        answer: &mut A,
    ) {
        for sixteen in &mut self.sixteens {
            sixteen.settle(simd, bvh, rays, answer);
        }
    }
}

impl RefinedBatch {
    fn new() -> Self {
        Self {
            rays: [0; RAYS],
            leaves: [Packed::NONE; RAYS],
            lanes: [0; RAYS],
            edges: EdgeRays::default(),
            corners: [[[0.0; RAYS]; 3]; 3],
            len: 0,
        }
    }

    #[inline(always)]
    fn put<const N: usize, L: Leaves<N>>(&mut self, bvh: &WideBvh<N, L>, rays: &RayBatch<'_>, i: usize, best: &Best) {
        let at = self.len & (RAYS - 1);
        (self.rays[at], self.leaves[at], self.lanes[at]) = (i, best.leaf, best.lane);
        self.edges.put(at, &rays.get(i));
        let (first, count) = best.leaf.leaf();
        let [a, b, c] = bvh.leaves.corners(first, count, best.lane as usize & (N - 1));
        let to = &mut self.corners;
        (to[0][0][at], to[0][1][at], to[0][2][at]) = (a.x, a.y, a.z);
        (to[1][0][at], to[1][1][at], to[1][2][at]) = (b.x, b.y, b.z);
        (to[2][0][at], to[2][1][at], to[2][2][at]) = (c.x, c.y, c.z);
        self.len = at + 1;
    }

    /// Compute and store the pending hits of a group.
    #[inline(always)]
    fn settle<const N: usize, L: Leaves<N>, A: Answer, S: Lanes<RAYS>>(
        &mut self,
        _: S,
        bvh: &WideBvh<N, L>,
        rays: &RayBatch<'_>,
        answer: &mut A,
    ) {
        let count = std::mem::take(&mut self.len).min(RAYS);
        if count == 0 {
            return;
        }
        let here = !(u32::MAX << count);
        let plain = self.edges.prepare(&bvh.region) & here;
        let all = self.edges.won(S::FUSED, &self.corners, plain);
        let mut met = all.met;
        while met != 0 {
            let i = met.trailing_zeros() as usize & (RAYS - 1);
            met &= met - 1;
            let number = primitive(&bvh.leaves, self.leaves[i], self.lanes[i]);
            let uv = [all.uv[0][i], all.uv[1][i]];
            answer.hit(self.rays[i], all.t[i], uv, number);
        }
        let mut rest = here & !all.met;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize & (RAYS - 1);
            rest &= rest - 1;
            alone(bvh, rays, self.rays[i], self.leaves[i], self.lanes[i], answer);
        }
    }
}

/// The triangles that up to sixteen rays have hit.
struct Triangles<T> {
    /// By corner and axis.
    corners: [[Column<T>; 3]; 3],
    primitives: Column<u32>,
}

impl<T: Real> Triangles<T> {
    /// Load the triangles of the rays in `hits`. Neighbors often hit the same one, which is loaded once.
    #[inline(always)]
    fn load<const N: usize, L: Leaves<N, Real = T>, S: Lanes<RAYS>>(
        &mut self,
        simd: S,
        leaves: &L,
        bests: &Bests,
        hits: u32,
    ) {
        let mut rest = hits;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize & (RAYS - 1);
            let like = rest & bests.like(simd, i);
            rest &= !like;
            let best = bests.get(i);
            let (first, count) = best.leaf.leaf();
            let lane = best.lane as usize & (N - 1);
            let (primitive, corners) = (leaves.primitive(first, count, lane), leaves.coordinates(first, count, lane));
            let is_lone = like & like.wrapping_sub(1) == 0;
            for (to, corner) in self.corners.iter_mut().zip(corners) {
                for (to, x) in to.iter_mut().zip(corner) {
                    if is_lone {
                        to[i] = x;
                    } else {
                        x.spread(simd, like, to);
                    }
                }
            }
            for (k, to) in self.primitives.iter_mut().enumerate() {
                *to = if like >> k & 1 == 1 { primitive } else { *to };
            }
        }
    }
}

/// Buffers for the hits of sixteen rays: clearing them would take as long as filling them.
pub struct Refining<T> {
    edges: EdgeRays,
    triangles: Triangles<T>,
}

impl<T: Real> Refining<T> {
    /// For no rays.
    pub fn new() -> Self {
        let triangles = Triangles { corners: [[[T::default(); RAYS]; 3]; 3], primitives: [0; RAYS] };
        Self { edges: EdgeRays::default(), triangles }
    }

    /// Compute and store the hits of up to sixteen consecutive rays from `start`.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    pub fn settle<const N: usize, L: Leaves<N, Real = T>, A: Answer, S: Lanes<RAYS>>(
        &mut self,
        simd: S,
        bvh: &WideBvh<N, L>,
        rays: &RayBatch<'_>,
        start: usize,
        count: usize,
        bests: &Bests,
        answer: &mut A,
    ) {
        let hits = bests.hits(simd);
        if hits == 0 {
            answer.some(start, count, 0, &Met::NONE, &[0; RAYS]);
            return;
        }
        if let Some(primitives) = answer.primitives() {
            for (i, to) in primitives[start..][..count].iter_mut().enumerate() {
                let best = bests.get(i);
                *to = if hits >> i & 1 == 1 { primitive(&bvh.leaves, best.leaf, best.lane) } else { Ray::NO_TRIANGLE };
            }
            return;
        }
        let Self { edges, triangles } = self;
        edges.take(rays, start);
        let first = hits.trailing_zeros() as usize;
        let together = hits & !bests.like(simd, first) == 0 && edges.share_origin();
        // Before the rays are prepared, so that scalar stores complete before the data are loaded as vectors.
        let best = bests.get(first);
        if together {
            triangles.primitives = [primitive(&bvh.leaves, best.leaf, best.lane); RAYS];
        } else {
            triangles.load(simd, &bvh.leaves, bests, hits);
        }
        let plain = edges.prepare(&bvh.region) & hits;
        let all = if together {
            let (first, count) = best.leaf.leaf();
            edges.won_together(S::FUSED, bvh.leaves.corners(first, count, best.lane as usize & (N - 1)), plain)
        } else {
            edges.won(S::FUSED, &triangles.corners, plain)
        };
        answer.some(start, count, all.met, &all, &triangles.primitives);
        let mut rest = hits & !all.met;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize & (RAYS - 1);
            rest &= rest - 1;
            let best = bests.get(i);
            alone(bvh, rays, start + i, best.leaf, best.lane, answer);
        }
    }
}

/// Compute a hit that is undecided in the group of sixteen.
#[inline(never)]
fn alone<const N: usize, L: Leaves<N>, A: Answer>(
    bvh: &WideBvh<N, L>,
    rays: &RayBatch<'_>,
    ray: usize,
    leaf: Packed,
    lane: u32,
    answer: &mut A,
) {
    let edges = EdgeRay::new(&rays.get(ray), &bvh.region);
    match edges.and_then(|edges| Some((edges.scale, meet(&bvh.leaves, &edges, leaf, lane)?))) {
        Some((scale, met)) => answer.hit(ray, met.t * scale, met.uv, primitive(&bvh.leaves, leaf, lane)),
        None => {
            debug_assert!(L::PRECISION == "plain", "what has won is met");
            answer.miss(ray);
        }
    }
}
