//! A leaf's triangles prepared for sixteen rays at once: terms that depend on the triangle alone are computed once, in
//! parallel over the leaf.
//!
//! The weights are those of [`super::pretest`], in an order that applies the edges last. With n = f × e and c = d × s,
//! the weight of b is −f · c, that of c is e · c, their sum with that of a is d · n, and the numerator of t is −s · n.
//! The bounds are unchanged. A product in c errs by 4εL + 2εL + 2εL, and so c by 16εL + 4εL = 20εL; it is at most 4L. A
//! product in f · c errs by 4εLE + 20εLE + 4εLE, and the weight by 84εLE + 20εLE = 104εLE, as before. A product in n
//! errs by 3εE², and so n by 8εE²; it is at most 2E². A product in d · n errs by 4εE² + 16εE² + 4εE², and the sum by
//! 92εE², as before; one in s · n by 4εLE² + 8εLE² + 2εLE², and the sum by 52εLE², as before.
//!
//! If all rays have the same origin, as camera rays do, s depends on the triangle alone, too. Then the weight of b is d
//! · r with r = f × s, and that of c is d · q with q = s × e. Both vectors err by 10εLE, as q does there, and the
//! weights by 104εLE.

use super::bracket::{Bracket, bracket};
use super::leaf_rows::Rows;
use super::pretest::{BlockRays, Weights, cross, difference, dot, largest};
use super::sixteen_rays::RAYS;
use raywright_base::simd::Lanes;

/// The terms of some triangles that do not depend on the ray's direction; vectors by axis.
pub struct Spread<const N: usize> {
    /// The corner; for a common origin, q.
    a: [[f32; N]; 3],
    /// The edges from there; for a common origin, the second one is r.
    e: [[f32; N]; 3],
    f: [[f32; N]; 3],
    n: [[f32; N]; 3],
    /// The numerator of t, for a common origin.
    numerator: [f32; N],
    /// Error bounds of the weights, and of the numerator and denominator of t.
    above: [f32; N],
    numerator_error: [f32; N],
    over: [f32; N],
}

impl<const N: usize> Rows<N> {
    /// Prepare the triangles of a leaf for sixteen rays.
    #[inline(always)]
    pub(super) fn spread<S: Lanes<N>>(
        &self,
        simd: S,
        rays: &BlockRays,
        first: usize,
        count: u32,
        edges: bool,
    ) -> Spread<N> {
        let [a, e, f] = self.edges(simd, first, count, edges);
        let n = cross(simd, f, e);
        let size = simd.max(largest(simd, e), largest(simd, f));
        let (above, numerator_error, over) = rays.errors.of(simd, size);
        let mut spread = Spread {
            a: [[0.0; N]; 3],
            e: [[0.0; N]; 3],
            f: [[0.0; N]; 3],
            n: [[0.0; N]; 3],
            numerator: [0.0; N],
            above: [0.0; N],
            numerator_error: [0.0; N],
            over: [0.0; N],
        };
        let vectors = if rays.share_origin {
            let o = [simd.splat(rays.origin[0][0]), simd.splat(rays.origin[1][0]), simd.splat(rays.origin[2][0])];
            let s = difference(simd, o, a);
            simd.store(simd.neg(dot(simd, s, n)), &mut spread.numerator);
            [cross(simd, s, e), e, cross(simd, f, s)]
        } else {
            [a, e, f]
        };
        for axis in 0..3 {
            simd.store(vectors[0][axis], &mut spread.a[axis]);
            simd.store(vectors[1][axis], &mut spread.e[axis]);
            simd.store(vectors[2][axis], &mut spread.f[axis]);
            simd.store(n[axis], &mut spread.n[axis]);
        }
        simd.store(above, &mut spread.above);
        simd.store(numerator_error, &mut spread.numerator_error);
        simd.store(over, &mut spread.over);
        spread
    }
}

impl<const N: usize> Spread<N> {
    /// Test one of the triangles against the rays in `asked` conservatively; an empty result if none hits.
    #[inline(always)]
    pub fn bracket<S: Lanes<RAYS>>(
        &self,
        simd: S,
        rays: &BlockRays,
        lane: usize,
        asked: u32,
    ) -> Option<Bracket<S::F32>> {
        let lane = lane & (N - 1);
        let (o, d) = rays.load(simd);
        let n = spread_one(simd, &self.n, lane);
        let denominator = dot(simd, d, n);
        let (u, v, s);
        if rays.share_origin {
            u = dot(simd, d, spread_one(simd, &self.f, lane));
            v = dot(simd, d, spread_one(simd, &self.a, lane));
            s = None;
        } else {
            let away = difference(simd, o, spread_one(simd, &self.a, lane));
            let c = cross(simd, d, away);
            u = simd.neg(dot(simd, spread_one(simd, &self.f, lane), c));
            v = dot(simd, spread_one(simd, &self.e, lane), c);
            s = Some(away);
        }
        let w = simd.sub(simd.sub(denominator, u), v);
        let weights = Weights { weights: [u, v, w], denominator };
        let (possible, inside) = weights.signs(simd, simd.splat(self.above[lane]));
        let possible = possible & asked;
        if possible == 0 {
            return None;
        }
        let numerator = match s {
            Some(s) => simd.neg(dot(simd, s, n)),
            None => simd.splat(self.numerator[lane]),
        };
        let (above, over) = (simd.splat(self.numerator_error[lane]), simd.splat(self.over[lane]));
        Some(bracket(simd, numerator, above, denominator, over, &rays.errors, possible, inside))
    }
}

/// A vector of one triangle, broadcast to every lane.
#[inline(always)]
fn spread_one<const N: usize, S: Lanes<RAYS>>(simd: S, vectors: &[[f32; N]; 3], lane: usize) -> [S::F32; 3] {
    [simd.splat(vectors[0][lane]), simd.splat(vectors[1][lane]), simd.splat(vectors[2][lane])]
}
