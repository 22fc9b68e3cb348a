//! The conservative f32 pretest of triangles before the decision in f64: it rejects only certain misses.
//!
//! The test is that of Möller and Trumbore ("Fast, Minimum Storage Ray/Triangle Intersection", 1997), which takes half
//! the work of the edge test. With edges e = b − a and f = c − a, the ray from s relative to a, p = d × f and q = s ×
//! e, the corners' weights are u = s · p of b, v = d · q of c, and w = e · p − u − v of a. A triangle is rejected only
//! if one weight is certainly positive and another certainly negative.
//!
//! The bound. Let ε = 2⁻²⁴, E bound every coordinate of e and f, L bound |origin| + |corner| in every coordinate, and D
//! < 2 those of the direction. The edges err by εE, s by 2εL for rounding the origin and the difference, and d by 2ε. A
//! product in p errs by 2εE + 2εE + 2εE, and so p by 12εE + 4εE = 16εE; it is at most 4E. A product in q errs by 2εLE +
//! εLE + εLE, and so q by 8εLE + 2εLE = 10εLE; it is at most 2LE. A product in u errs by 8εLE + 16εLE + 4εLE, and so u
//! by 84εLE + 20εLE = 104εLE. A product in v errs by 4εLE + 20εLE + 4εLE, and v like u. A product in e · p errs by
//! (4 + 16 + 4)εE², and the sum by 92εE², which is at most 184εLE, since E ≤ 2L. So w errs by 184εLE + 208εLE and, for
//! its own two roundings, 48εLE: 440εLE, to first order; fused operations err less. 512εLE is allowed. Underflow in p
//! or q loses at most 2⁻¹⁴⁸ a coordinate, 2⁻¹⁴⁵L in a weight, and elsewhere less than 2⁻¹⁴⁶: 2⁻¹⁴⁰L + 2⁻¹²⁶ is added.
//! (The latter is the least normal number: a subnormal one would slow down every sum.) With L below 2⁶⁰ no sum exceeds
//! 96L² < 2¹²⁷; beyond it, where infinities of either sign may appear, nothing is rejected.
//!
//! Most remaining triangles lie behind the ray, on the surface that it leaves. The ray's parameter is t = f · q / e ·
//! p. It is negative if numerator and denominator certainly have opposite signs, and the triangle is then rejected if
//! the ray allows no negative t. A product in f · q errs by 2εLE² + 10εLE² + 2εLE², and the sum by 52εLE²: 64εLE² is
//! allowed, and 128εE² for the denominator. With L below 2⁴⁰ no sum exceeds 6LE² < 2¹²⁵; beyond it nothing is rejected
//! by t.
//!
//! f64 corners are stored relative to the scene's center, in box units: a corner, and its two edges computed in f64.
//! All are rounded to f32. An edge then errs by εE as before, and s by ε|corner| more, which with ε|origin| is εL: the
//! bounds are the same. (Edges between rounded corners would have terms in L² that do not shrink with the triangle, and
//! almost no triangle of a fine mesh would be rejected.)

use super::{Column, EdgeRay, PlainRays, RAYS};
use raywright_base::math::DVec3;
use raywright_base::math::robust::greater;
use raywright_base::simd::Lanes;

/// The corners' weights and the denominator of t, lane by lane.
pub(super) struct Weights<F> {
    /// The weights of b, c and a.
    pub weights: [F; 3],
    pub denominator: F,
}

impl<F: Copy> Weights<F> {
    /// Compute them for triangles given by corner and edges, with the numerator of t and the largest coordinate of an
    /// edge.
    #[inline(always)]
    pub fn new<const N: usize, S: Lanes<N, F32 = F>>(
        simd: S,
        [a, e, f]: [[F; 3]; 3],
        o: [F; 3],
        d: [F; 3],
    ) -> (Self, F, F) {
        let s = difference(simd, o, a);
        let p = cross(simd, d, f);
        let q = cross(simd, s, e);
        let u = dot(simd, s, p);
        let v = dot(simd, d, q);
        let denominator = dot(simd, e, p);
        let w = simd.sub(simd.sub(denominator, u), v);
        let largest = simd.max(largest(simd, e), largest(simd, f));
        (Self { weights: [u, v, w], denominator }, dot(simd, f, q), largest)
    }

    /// Lanes in which no two weights certainly differ in sign, and lanes in which all certainly have the same sign;
    /// `above` bounds the weights' errors.
    #[inline(always)]
    pub fn signs<const N: usize, S: Lanes<N, F32 = F>>(&self, simd: S, above: F) -> (u32, u32) {
        let [u, v, w] = self.weights;
        let (least, greatest) = (simd.min(simd.min(u, v), w), simd.max(simd.max(u, v), w));
        let below = simd.neg(above);
        let passed = simd.gt(greatest, above) & simd.gt(below, least);
        (!passed, simd.gt(least, above) | simd.gt(below, greatest))
    }
}

/// Lanes in which f32 cannot reject the triangle; bits above the lanes are set.
#[inline(always)]
pub(super) fn not_rejected<const N: usize, S: Lanes<N>>(
    simd: S,
    triangle: [[S::F32; 3]; 3],
    o: [S::F32; 3],
    d: [S::F32; 3],
    errors: &PretestErrors,
) -> u32 {
    let (weights, numerator, largest) = Weights::new(simd, triangle, o, d);
    let (of_weight, _, over) = errors.of(simd, largest);
    let (possible, _) = weights.signs(simd, of_weight);
    let of_numerator = simd.mul(largest, simd.mul(largest, simd.splat(errors.numerator)));
    let (above, denominator) = (simd.add(of_numerator, simd.splat(errors.least)), weights.denominator);
    let behind = simd.gt(numerator, above) & simd.gt(simd.neg(over), denominator)
        | simd.gt(simd.neg(above), numerator) & simd.gt(denominator, over);
    possible & !behind
}

/// A ray prepared for the f32 pretest.
#[derive(Clone, Copy, Debug)]
pub struct BlockRay {
    /// The origin, in the leaves' units.
    pub origin: [f32; 3],
    /// The scaled direction.
    pub direction: [f32; 3],
    pub(super) errors: PretestErrors,
}

/// Sixteen rays prepared for the f32 pretest.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct BlockRays {
    /// The origins, in the leaves' units, by axis.
    pub origin: [Column<f32>; 3],
    /// The scaled directions, by axis.
    pub direction: [Column<f32>; 3],
    /// True if all rays have the same origin.
    pub(super) share_origin: bool,
    pub(super) errors: PretestErrors,
}

impl BlockRay {
    /// A ray from an origin in the leaves' units, rounded to f32; `largest` is L.
    #[inline(always)]
    pub(super) fn new(origin: DVec3, ray: &EdgeRay, largest: f64) -> Self {
        let (o, d) = (origin.as_vec3(), ray.direction.as_vec3());
        let errors = PretestErrors::new(largest, ray.t_min >= 0.0, ray.scale);
        Self { origin: [o.x, o.y, o.z], direction: [d.x, d.y, d.z], errors }
    }

    /// Origin and direction, broadcast to every lane.
    // Written out axis by axis, as are all functions called from here on. Closures and iterators between here and the
    // kernel's entry are not always compiled for its SIMD level, and then every operation is a call.
    #[inline(always)]
    pub(super) fn splat<const N: usize, S: Lanes<N>>(&self, simd: S) -> ([S::F32; 3], [S::F32; 3]) {
        let (o, d) = (&self.origin, &self.direction);
        ([simd.splat(o[0]), simd.splat(o[1]), simd.splat(o[2])], [simd.splat(d[0]), simd.splat(d[1]), simd.splat(d[2])])
    }
}

impl BlockRays {
    /// No rays.
    pub const NONE: Self = Self {
        origin: [[0.0; RAYS]; 3],
        direction: [[0.0; RAYS]; 3],
        share_origin: false,
        errors: PretestErrors { weight: 0.0, numerator: 0.0, least: 0.0, depth: 0.0 },
    };

    /// Set the error bounds to zero, as most ray tracers assume, to measure what that would save.
    pub fn believe(&mut self) {
        self.errors = PretestErrors { weight: 0.0, numerator: 0.0, least: 0.0, depth: 0.0 };
    }

    /// Extend the bounds to cover other rays as well.
    #[inline(always)]
    pub fn unite(&mut self, others: &Self) {
        let (a, b) = (&self.origin, &others.origin);
        let is_shared = a[0][0] == b[0][0] && a[1][0] == b[1][0] && a[2][0] == b[2][0];
        self.share_origin &= others.share_origin & is_shared;
        let (errors, other) = (&mut self.errors, &others.errors);
        errors.weight = greater(errors.weight, other.weight);
        errors.numerator = greater(errors.numerator, other.numerator);
        errors.least = greater(errors.least, other.least);
        errors.depth = greater(errors.depth, other.depth);
    }

    /// Take sixteen rays from origins in the leaves' units; `largest` is the greatest L.
    // In place, vector by vector: a copy by larger vectors than were stored has to wait for the stores.
    #[inline(always)]
    pub(super) fn take<S: Lanes<RAYS>>(&mut self, simd: S, origin: &[Column<f32>; 3], rays: &PlainRays, largest: f64) {
        // The interval of `t` rejects hits behind the ray.
        self.errors = PretestErrors::new(largest, false, rays.scale);
        let mut differ = 0;
        for axis in 0..3 {
            let (numbers, first) = (simd.load(&origin[axis]), simd.splat(origin[axis][0]));
            differ |= simd.gt(numbers, first) | simd.gt(first, numbers);
            simd.store(numbers, &mut self.origin[axis]);
            simd.store(simd.load(&rays.direction[axis]), &mut self.direction[axis]);
        }
        self.share_origin = differ == 0;
    }

    /// Origins and directions, one vector per coordinate.
    #[inline(always)]
    pub(super) fn load<S: Lanes<RAYS>>(&self, simd: S) -> ([S::F32; 3], [S::F32; 3]) {
        let (o, d) = (&self.origin, &self.direction);
        ([simd.load(&o[0]), simd.load(&o[1]), simd.load(&o[2])], [simd.load(&d[0]), simd.load(&d[1]), simd.load(&d[2])])
    }

    /// One of the rays.
    #[inline(always)]
    pub fn of(&self, i: usize) -> BlockRay {
        let i = i & (RAYS - 1);
        let (o, d) = (&self.origin, &self.direction);
        BlockRay { origin: [o[0][i], o[1][i], o[2][i]], direction: [d[0][i], d[1][i], d[2][i]], errors: self.errors }
    }
}

/// Error bounds of the f32 pretest.
#[derive(Clone, Copy, Debug)]
pub(super) struct PretestErrors {
    /// For a weight, relative to the largest edge.
    pub(super) weight: f32,
    /// For the numerator of t, relative to the squared largest edge.
    numerator: f32,
    /// An absolute term of every bound.
    pub(super) least: f32,
    /// For t itself ([`EdgeRay::depth_error`]).
    pub(super) depth: f32,
}

impl PretestErrors {
    /// Bounds for L = `largest`. `forwards` says that no t below 0 is allowed. `t` along the given direction is at most
    /// `scale` times that along the scaled one.
    #[inline(always)]
    fn new(largest: f64, forwards: bool, scale: f64) -> Self {
        const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
        const OVERFLOW: f64 = (1u64 << 60) as f64;
        const NUMERATOR_OVERFLOW: f64 = (1u64 << 40) as f64;
        const UNDERFLOW: f64 = f64::from_bits((1023 - 140) << 52);
        let weight = if largest < OVERFLOW { 512.0 * largest } else { f64::INFINITY };
        let numerator = if forwards && largest < NUMERATOR_OVERFLOW { 64.0 * largest } else { f64::INFINITY };
        Self {
            // The rounding to nearest is covered by the terms of higher order.
            weight: (UNIT * weight) as f32,
            numerator: (UNIT * numerator) as f32,
            least: (UNDERFLOW * largest) as f32 + f32::MIN_POSITIVE,
            depth: EdgeRay::depth_error(largest, scale),
        }
    }

    /// Error bounds of a weight, and of the numerator and denominator of t, given the largest coordinate of an edge.
    #[inline(always)]
    pub(super) fn of<const N: usize, S: Lanes<N>>(&self, simd: S, largest: S::F32) -> (S::F32, S::F32, S::F32) {
        const DENOMINATOR: f32 = 128.0 / (1u32 << 24) as f32;
        let (weight, least) = (simd.mul(largest, simd.splat(self.weight)), simd.splat(self.least));
        // 64εLE², where the weight has 512εLE.
        let numerator = simd.mul_add(simd.mul(largest, weight), simd.splat(0.125), least);
        let denominator = simd.mul_add(simd.mul(largest, largest), simd.splat(DENOMINATOR), least);
        (simd.add(weight, least), numerator, denominator)
    }
}

#[inline(always)]
pub(super) fn difference<const N: usize, S: Lanes<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> [S::F32; 3] {
    [simd.sub(a[0], b[0]), simd.sub(a[1], b[1]), simd.sub(a[2], b[2])]
}

#[inline(always)]
pub(super) fn sum<const N: usize, S: Lanes<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> [S::F32; 3] {
    [simd.add(a[0], b[0]), simd.add(a[1], b[1]), simd.add(a[2], b[2])]
}

/// The largest coordinate in magnitude.
#[inline(always)]
pub(super) fn largest<const N: usize, S: Lanes<N>>(simd: S, v: [S::F32; 3]) -> S::F32 {
    simd.max(simd.max(simd.abs(v[0]), simd.abs(v[1])), simd.abs(v[2]))
}

#[inline(always)]
pub(super) fn cross<const N: usize, S: Lanes<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> [S::F32; 3] {
    [
        simd.mul_sub(a[1], b[2], simd.mul(a[2], b[1])),
        simd.mul_sub(a[2], b[0], simd.mul(a[0], b[2])),
        simd.mul_sub(a[0], b[1], simd.mul(a[1], b[0])),
    ]
}

#[inline(always)]
pub(super) fn dot<const N: usize, S: Lanes<N>>(simd: S, a: [S::F32; 3], b: [S::F32; 3]) -> S::F32 {
    simd.mul_add(a[2], b[2], simd.mul_add(a[1], b[1], simd.mul(a[0], b[0])))
}
