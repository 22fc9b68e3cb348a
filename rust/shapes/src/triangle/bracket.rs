//! Conservative f32 intersection of rays and triangles, with an interval for `t`.
//!
//! Whether a triangle is hit near its edges, and which of two almost equally distant ones is nearer, is left to f64.
//!
//! The weights are those of [`super::pretest`], with the same error bound. If all three exceed it, or all are less than
//! its negative, exact arithmetic gives them the same sign, and the triangle is hit.
//!
//! The bound on `t`. Let n and m be the numerator and denominator as computed, in error by at most N and M (64εLE² and
//! 128εE², of which 52 and 92 are needed). Exact arithmetic has t = (n + a) / (m + b) with |a| ≤ N and |b| ≤ M. It
//! differs from n / m by (a − b · n/m) / (m + b), for |m| ≥ 4M by at most (N + |n/m| · M) · 4/3 / |m|. Inverse and
//! product are rounded: n / m errs by 2ε of itself. The interval has to contain `t` as computed in f64, which differs
//! from the exact one by at most [`EdgeRay::T_ERROR`] of the reach: by εL/4, as the reach is at most L. Twice each term
//! suffices: 2 (N + |n/m| · M) / |m| where 4/3 is needed (and N and M are themselves larger than needed), 4ε |n/m|, and
//! εL/2. Underflow in n and m is part of N and M. In the quotient it is less than the least normal number, which is
//! added.
//!
//! If |m| < 4M, or L is so large that the numerator may overflow, the interval is unbounded. So it is if `t` along the
//! given direction might overflow an f64.

use super::EdgeRay;
use super::leaf_rows::Rows;
use super::pretest::{BlockRay, PretestErrors, Weights};
use raywright_base::simd::Lanes;

/// Conservative results for some triangles and one ray, or one triangle and some rays. Bits above the lanes are
/// undefined.
pub struct Bracket<F> {
    /// Lanes that may be hit.
    pub possible: u32,
    /// Lanes that are certainly hit, at any `t`.
    pub inside: u32,
    /// Lanes with a bounded interval for `t`.
    pub known: u32,
    /// The lower bound of `t` in those lanes.
    pub low: F,
    /// The upper bound of `t` in those lanes.
    pub high: F,
}

/// Bound `t` from its numerator and denominator and their error bounds. `possible` are the lanes that may be hit and
/// `inside` those that are.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
pub(super) fn bracket<const N: usize, S: Lanes<N>>(
    simd: S,
    numerator: S::F32,
    above: S::F32,
    denominator: S::F32,
    over: S::F32,
    errors: &PretestErrors,
    possible: u32,
    inside: u32,
) -> Bracket<S::F32> {
    let size = simd.abs(denominator);
    let known = simd.le(simd.mul(over, simd.splat(4.0)), size);
    let inverse = simd.div(simd.splat(1.0), denominator);
    let t = simd.mul(numerator, inverse);
    let distance = simd.abs(t);
    let room = simd.mul(simd.mul_add(distance, over, above), simd.mul(simd.abs(inverse), simd.splat(2.0)));
    let rounding = simd.mul_add(distance, simd.splat(4.0 / (1u32 << 24) as f32), simd.splat(errors.depth));
    let room = simd.add(room, rounding);
    Bracket { possible, inside, known, low: simd.sub(t, room), high: simd.add(t, room) }
}

impl EdgeRay {
    /// Twice the f64 error bound of `t`, for rays whose pretest has L = `largest`; infinite if f32 cannot bound `t`.
    #[inline(always)]
    pub(super) fn depth_error(largest: f64, scale: f64) -> f32 {
        /// Numerators may overflow beyond this.
        const LARGEST: f64 = (1u64 << 40) as f64;
        /// `t` along the given direction may be infinite beyond this.
        const GREATEST_SCALE: f64 = 1e200;
        if largest < LARGEST && scale < GREATEST_SCALE {
            (2.0 * Self::T_ERROR * largest) as f32 + f32::MIN_POSITIVE
        } else {
            f32::INFINITY
        }
    }
}

impl<const N: usize> Rows<N> {
    /// Test a ray against the triangles of a leaf.
    #[inline(always)]
    pub(super) fn bracket<S: Lanes<N>>(
        &self,
        simd: S,
        ray: &BlockRay,
        first: usize,
        count: u32,
        edges: bool,
    ) -> Bracket<S::F32> {
        let (o, d) = ray.splat(simd);
        let (weights, numerator, largest) = Weights::new(simd, self.edges(simd, first, count, edges), o, d);
        let (of_weight, above, over) = ray.errors.of(simd, largest);
        let (possible, inside) = weights.signs(simd, of_weight);
        // An early exit for empty masks is slower: the branch is hard to predict, and the caller tests for empty
        // results after the depths anyway.
        let possible = possible & ((1 << count) - 1);
        bracket(simd, numerator, above, weights.denominator, over, &ray.errors, possible, inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangle::{ALL, BlockRays, DoubleLeaves, Leaves, PlainRays, RAYS, SingleLeaves};
    use proptest::prelude::*;
    use proptest::strategy::ValueTree;
    use proptest::test_runner::{Config, TestRng, TestRunner};
    use raywright_base::math::RayBatch;
    use raywright_base::math::{DVec3, Ray, Region};
    use raywright_base::simd::{Dispatch, Kernel, Level, Scalar, Simd};

    /// The f32 result for one triangle: possible, inside, known, and the interval of `t`.
    type Said = (bool, bool, bool, f32, f32);

    /// Test the only triangle of a leaf with one ray, or with sixteen equal rays.
    struct Ask<'a, L> {
        leaves: &'a L,
        ray: &'a BlockRay,
        sixteens: &'a [BlockRays],
    }

    impl<const N: usize, L: Leaves<N>> Kernel<N> for Ask<'_, L> {
        type Output = Vec<Said>;

        #[inline(always)]
        fn run<S: Simd<N>>(self, simd: S) -> Vec<Said> {
            let mut said = vec![read(simd, Some(&self.leaves.bracket(simd, self.ray, 0, 1)), 0)];
            for rays in self.sixteens {
                let sixteen = simd.sixteen();
                let bracket = self.leaves.spread(simd, rays, 0, 1).bracket(sixteen, rays, 0, ALL);
                said.extend((0..RAYS).map(|lane| read(sixteen, bracket.as_ref(), lane)));
            }
            said
        }
    }

    #[inline(always)]
    fn read<const N: usize, S: Lanes<N>>(simd: S, bracket: Option<&Bracket<S::F32>>, lane: usize) -> Said {
        let Some(bracket) = bracket else { return (false, false, false, 0.0, 0.0) };
        let (mut low, mut high) = ([0.0; N], [0.0; N]);
        simd.store(bracket.low, &mut low);
        simd.store(bracket.high, &mut high);
        let bit = |mask: u32| mask >> lane & 1 == 1;
        (bit(bracket.possible), bit(bracket.inside), bit(bracket.known), low[lane], high[lane])
    }

    /// Results for a ray and a triangle, each with the true `t` in the leaves' units if it is hit.
    fn heard<const N: usize, L: Leaves<N>>(ray: &Ray, triangle: [DVec3; 3], share: f32) -> Vec<(Said, Option<f64>)>
    where
        Level: Dispatch<N>,
    {
        let region = Region::around(triangle);
        let leaves = L::new(&region, &[0], &[1], |_| triangle);
        let Some(edges) = EdgeRay::new(ray, &region) else { return Vec::new() };
        let met = edges.meet(triangle).map(|met| met.t * L::unit(&region));
        let mut block = L::ray(&edges, &region);
        block.errors.weight *= share;
        let mut columns = PlainRays::NONE;
        columns.take(Scalar, &RayBatch::Rows(&[*ray]), 0, &region);
        let is_plain = columns.plain & 1 == 1;
        // Rays with a common origin, also in the variant for different origins.
        let mut shared = BlockRays::NONE;
        L::take(Scalar, &columns, &region, &mut shared);
        assert!(shared.share_origin || !is_plain);
        shared.errors.weight *= share;
        let scattered = BlockRays { share_origin: false, ..shared.clone() };
        let sixteens = if is_plain { vec![shared, scattered] } else { Vec::new() };
        let levels = Level::ALL.into_iter().filter(|l| l.is_available() && l.lanes() >= N);
        let all = levels.flat_map(|level| level.dispatch(Ask { leaves: &leaves, ray: &block, sixteens: &sixteens }));
        all.map(|said| (said, met)).collect()
    }

    /// Return whether a result is correct, with intervals narrowed to a fraction of their width.
    fn is_right(((possible, inside, known, low, high), met): (Said, Option<f64>), width: f64) -> bool {
        let (low, high) = (f64::from(low), f64::from(high));
        let (middle, half) = (low / 2.0 + high / 2.0, (high / 2.0 - low / 2.0) * width);
        match met {
            Some(t) => possible && (!known || !half.is_finite() || (t - middle).abs() <= half),
            None => !inside,
        }
    }

    fn point(size: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
    }

    /// A triangle of any shape and size, and a ray to a point in it or next to it: inside, or within roundings of an
    /// edge on either side.
    fn aimed() -> impl Strategy<Value = (Ray, [DVec3; 3])> {
        let triangle = (point(1.0), [point(1.0), point(1.0), point(1.0)], 0i32..16, 0i32..10);
        let weights = (-1.0..1.0f64, 0.0..1.0f64, -30i32..2);
        let ray = (point(1.0), -20i32..10, -30i32..30, -20i32..20);
        (triangle, weights, ray).prop_map(|((at, ways, small, thin), (v, w, edge), (way, far, length, scale))| {
            let mut corners = ways.map(|way| at + way * 2f64.powi(-small));
            corners[2] = corners[1] + (corners[2] - corners[1]) * 2f64.powi(-thin);
            let corners = corners.map(|c| (c * 2f64.powi(scale)).as_vec3().as_dvec3());
            let (v, w) = (v * 2f64.powi(edge.min(0)), w * (1.0 - v));
            let target = corners[0] * (1.0 - v - w) + corners[1] * v + corners[2] * w;
            let origin = target - way * 2f64.powi(far + scale);
            let ray = Ray::new(origin, (target - origin) * 2f64.powi(length));
            // At any t, so that all lanes inside are hit.
            (Ray { t_min: f64::NEG_INFINITY, ..ray }, corners)
        })
    }

    fn both(ray: &Ray, triangle: [DVec3; 3], share: f32) -> impl Iterator<Item = (Said, Option<f64>)> {
        let narrow = heard::<4, SingleLeaves<4>>(ray, triangle, share).into_iter();
        let narrow = narrow.chain(heard::<4, DoubleLeaves<4>>(ray, triangle, share));
        let wide = heard::<8, SingleLeaves<8>>(ray, triangle, share).into_iter();
        narrow.chain(wide.chain(heard::<8, DoubleLeaves<8>>(ray, triangle, share)))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(10_000))]
        #[test]
        fn what_f32_says_is_so((ray, triangle) in aimed(), off in -30i32..20) {
            let moved = DVec3::new(1.0, -0.7, 0.3) * 2f64.powi(off);
            let shifted = triangle.map(|c| (c + moved).as_vec3().as_dvec3());
            let shifted = (Ray { origin: ray.origin + moved, ..ray }, shifted);
            for (ray, triangle) in [(ray, triangle), shifted] {
                for said in both(&ray, triangle, 1.0) {
                    prop_assert!(is_right(said, 1.0), "{:?} of {:?} and {:?}", said, ray, triangle);
                }
            }
        }
    }

    /// A vector whose coordinates are all near the largest one.
    fn long() -> impl Strategy<Value = DVec3> {
        let coordinate = (0.8..1.0f64, prop::bool::ANY).prop_map(|(x, down)| if down { -x } else { x });
        prop::array::uniform3(coordinate).prop_map(DVec3::from_array)
    }

    /// A small triangle and a distant ray that just passes one of its edges on either side, with maximum rounding.
    fn along_edges() -> impl Strategy<Value = (Ray, [DVec3; 3])> {
        let triangle = (point(1.0), long(), long(), 4i32..10);
        (triangle, (0usize..3, 0.0..1.0f64, -1.0..1.0f64, -22i32..-10), long()).prop_map(
            |((at, e, f, small), (which, part, beside, near), way)| {
                let corners = [at, at + e, at + f].map(|c| (c * 2f64.powi(-small)).as_vec3().as_dvec3());
                let beside = beside * 2f64.powi(near);
                let [a, b, c] = [0, 1, 2].map(|i| corners[(which + i) % 3]);
                let target = a * beside + (b * part + c * (1.0 - part)) * (1.0 - beside);
                let ray = Ray::new(target - way, way);
                (Ray { t_min: f64::NEG_INFINITY, ..ray }, corners)
            },
        )
    }

    /// A given number of test cases, the same on every run.
    fn cases(count: usize, of: impl Strategy<Value = (Ray, [DVec3; 3])>) -> Vec<(Ray, [DVec3; 3])> {
        let mut runner = TestRunner::new_with_rng(
            Config::default(),
            TestRng::from_seed(proptest::test_runner::RngAlgorithm::ChaCha, &[7; 32]),
        );
        (0..count).map(|_| of.new_tree(&mut runner).expect("nothing is refused").current()).collect()
    }

    #[test]
    fn bounds_a_sixty_fourth_as_large_would_be_wrong() {
        let cases = [cases(5_000, aimed()), cases(20_000, along_edges())];
        let wrong = |cases: &[(Ray, [DVec3; 3])], width: f64, share: f32| {
            cases.iter().filter(|(ray, t)| both(ray, *t, share).any(|said| !is_right(said, width))).count()
        };
        assert_eq!(cases.each_ref().map(|cases| wrong(cases, 1.0, 1.0)), [0, 0]);
        let [of_depths, of_weights] = &cases;
        let (depths, weights) = (wrong(of_depths, 1.0 / 64.0, 1.0), wrong(of_weights, 1.0, 1.0 / 64.0));
        assert!(depths > 0 && weights > 0, "{depths} of t, {weights} of weights");
    }

    #[test]
    fn most_is_decided_by_f32() {
        // From a few sizes away, at the center of a triangle of a mesh of some thousands.
        let triangle = [DVec3::ZERO, DVec3::new(0.02, 0.0, 0.001), DVec3::new(0.003, 0.02, 0.0)];
        let middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
        for way in [DVec3::new(0.3, 0.2, 1.0), DVec3::new(-2.0, 0.1, 3.0), DVec3::new(0.1, -1.0, -2.0)] {
            let ray = Ray::new(middle - way, way);
            for ((possible, inside, known, low, high), met) in both(&ray, triangle.map(|c| c.as_vec3().as_dvec3()), 1.0)
            {
                assert!(possible && inside && known && met.is_some());
                assert!(high - low < 1e-3 * low, "{low} to {high}");
            }
            let beside = Ray { origin: ray.origin + DVec3::X * 0.1, ..ray };
            assert!(both(&beside, triangle, 1.0).all(|((possible, ..), met)| !possible && met.is_none()));
        }
    }
}
