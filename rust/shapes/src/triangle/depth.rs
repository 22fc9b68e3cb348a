//! Correctly rounded `t` at which a line intersects a triangle's plane.
//!
//! With edges e = b − a and f = c − a, s = a − o and n = e × f, t is s · n over d · n. Both are computed as sums of two
//! f64 (Dekker, "A Floating-Point Technique for Extending the Available Precision", 1971). So is their quotient, which
//! is rounded once. So `t` is exact where an f64 can represent it, and never on the other side of an f64 than the exact
//! one. Comparing it with a ray's ends decides as exact arithmetic would: a hit at either end counts. A ray that ends
//! at the `t` of a hit still has that hit, and a ray that starts at the next f64 does not.
//!
//! The bound. Let u = 2⁻⁵³, E bound every coordinate of e and f, L those of s, and D < 2 those of d. The differences
//! are exact as sums of two f64. A product in n errs by 8u²E², and n by 2·8u²E² + (6 + 8)u²E² = 30u²E²; its low part is
//! at most 8uE². A product in s · n errs by (8 + 2 + 10 + 12 + 8)u²LE² and 30u²LE² for n; three of them by 210u²LE²,
//! and their sum by (24 + 36 + 10 + 46)u²LE² more: 512u²LE² is allowed where 326 are needed. In the same way d · n errs
//! by 490u²E², of which 768 are allowed. The quotient adds less than 16u² of itself. Underflow is less than the added
//! constants if coordinates are below 1e101.

use raywright_base::math::robust::{UNIT, greater};

/// Three coordinates.
type Vector = [f64; 3];

/// Maximum error of a known `t` before rounding, as a share of it.
const SHARE: f64 = UNIT / 16.0;

/// The intersection of a line with a plane.
#[derive(Clone, Copy)]
pub(super) struct Depth {
    /// The computed value, rounded once.
    pub t: f64,
    /// Half a bound on its error before rounding, times `size`.
    error: f64,
    /// The denominator's magnitude.
    size: f64,
    denominator_error: f64,
}

impl Depth {
    /// Intersect the line from `o` along `d`, scaled to below 2, with a triangle's plane. The rounding error of a
    /// product is the same number with or without `fused` multiplication ([`raywright_base::simd::Lanes::FUSED`]).
    #[inline(always)]
    pub fn new(fused: bool, o: Vector, d: Vector, [a, b, c]: [Vector; 3]) -> Self {
        const OF_NUMERATOR: f64 = 512.0 * UNIT * UNIT;
        const OF_DENOMINATOR: f64 = 768.0 * UNIT * UNIT;
        let (e, e_low) = difference(b, a);
        let (f, f_low) = difference(c, a);
        let (s, s_low) = difference(a, o);
        let (e_split, f_split) = (split(e), split(f));
        let (x, x_low) = minor(fused, 1, 2, (e, e_low, e_split), (f, f_low, f_split));
        let (y, y_low) = minor(fused, 2, 0, (e, e_low, e_split), (f, f_low, f_split));
        let (z, z_low) = minor(fused, 0, 1, (e, e_low, e_split), (f, f_low, f_split));
        let (n, n_low) = ([x, y, z], [x_low, y_low, z_low]);
        let n_split = split(n);
        let numerator = dot(fused, (s, s_low, split(s)), (n, n_low, n_split));
        let denominator = dot_single(fused, (d, split(d)), (n, n_low, n_split));
        let t = quotient(fused, numerator, denominator);
        let edge = greater(largest(e), largest(f));
        let square = edge * edge;
        let numerator_error = OF_NUMERATOR * square * largest(s) + 1e-210;
        let denominator_error = OF_DENOMINATOR * square + 1e-290;
        let error = numerator_error + t.abs() * denominator_error;
        Self { t, error, size: denominator.0.abs(), denominator_error }
    }

    /// Bound on the error of `t` before rounding; infinite or NaN if unknown.
    #[inline(always)]
    fn error(&self) -> f64 {
        let error = 2.0 * self.error / self.size;
        if self.size >= 4.0 * self.denominator_error { error } else { f64::INFINITY }
    }

    /// Return whether `t` is the f64 nearest to the exact one, except within 2⁻³ ulp of a tie.
    #[inline(always)]
    pub fn is_known(&self) -> bool {
        self.error() <= SHARE * self.t.abs()
    }

    /// Return whether [`Depth::is_known`] is certainly true, without a division. Where that matters the factor of two
    /// covers the roundings: the error is never subnormal, and an overflow needs an infinite `t`.
    #[inline(always)]
    pub fn is_surely_known(&self) -> bool {
        (self.size >= 4.0 * self.denominator_error) & (4.0 * self.error <= SHARE * self.t.abs() * self.size)
    }

    /// Return whether the f64 nearest to the exact `t` is certainly less than `t_min` or greater than `t_max`.
    #[inline(always)]
    pub fn is_beyond(&self, t_min: f64, t_max: f64) -> bool {
        let room = self.error() + 4.0 * UNIT * self.t.abs();
        (self.t + room < t_min) | (self.t - room > t_max)
    }
}

/// The quotient of two double-doubles, rounded.
#[inline(always)]
pub(super) fn quotient(fused: bool, (n, n_low): (f64, f64), (d, d_low): (f64, f64)) -> f64 {
    let first = n / d;
    let (product, rest) = product(fused, first, halves(first), d, halves(d));
    let left = ((n - product) - rest) + (n_low - first * d_low);
    first + left / d
}

/// Differences of coordinates, and their rounding errors (Knuth, 1969).
#[inline(always)]
fn difference(v: Vector, w: Vector) -> (Vector, Vector) {
    let (x, x_low) = sum(v[0], -w[0]);
    let (y, y_low) = sum(v[1], -w[1]);
    let (z, z_low) = sum(v[2], -w[2]);
    ([x, y, z], [x_low, y_low, z_low])
}

#[inline(always)]
fn sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// Split a number into two of half the length (Veltkamp, 1968).
#[inline(always)]
fn halves(x: f64) -> (f64, f64) {
    let c = 134_217_729.0 * x;
    let high = c - (c - x);
    (high, x - high)
}

#[inline(always)]
fn split(v: Vector) -> [(f64, f64); 3] {
    [halves(v[0]), halves(v[1]), halves(v[2])]
}

/// The product of two numbers, given with their halves, and its rounding error.
#[inline(always)]
fn product(fused: bool, a: f64, (ah, al): (f64, f64), b: f64, (bh, bl): (f64, f64)) -> (f64, f64) {
    let product = a * b;
    let rest = if fused { a.mul_add(b, -product) } else { al * bl - (((product - ah * bh) - al * bh) - ah * bl) };
    (product, rest)
}

/// Three double-double coordinates: high parts, low parts, and the halves of the high parts.
type Long = (Vector, Vector, [(f64, f64); 3]);

/// The product of two coordinates.
#[inline(always)]
fn times(fused: bool, (v, v_low, v_split): Long, i: usize, (w, w_low, w_split): Long, j: usize) -> (f64, f64) {
    let (high, low) = product(fused, v[i], v_split[i], w[j], w_split[j]);
    (high, low + (v[i] * w_low[j] + v_low[i] * w[j]))
}

/// `e_i f_j − e_j f_i`.
#[inline(always)]
fn minor(fused: bool, i: usize, j: usize, e: Long, f: Long) -> (f64, f64) {
    let (p, p_low) = times(fused, e, i, f, j);
    let (q, q_low) = times(fused, e, j, f, i);
    let (high, low) = sum(p, -q);
    (high, low + (p_low - q_low))
}

/// The dot product. Its low part is at most half an ulp of the high part, barring near-total cancellation.
#[inline(always)]
fn dot(fused: bool, v: Long, w: Long) -> (f64, f64) {
    total([times(fused, v, 0, w, 0), times(fused, v, 1, w, 1), times(fused, v, 2, w, 2)])
}

/// The dot product with a vector in f64, without the terms that are zero.
#[inline(always)]
fn dot_single(fused: bool, (v, v_split): (Vector, [(f64, f64); 3]), (w, w_low, w_split): Long) -> (f64, f64) {
    let (x, x_low) = product(fused, v[0], v_split[0], w[0], w_split[0]);
    let (y, y_low) = product(fused, v[1], v_split[1], w[1], w_split[1]);
    let (z, z_low) = product(fused, v[2], v_split[2], w[2], w_split[2]);
    total([(x, x_low + v[0] * w_low[0]), (y, y_low + v[1] * w_low[1]), (z, z_low + v[2] * w_low[2])])
}

/// The sum of three double-doubles.
#[inline(always)]
fn total([(x, x_low), (y, y_low), (z, z_low)]: [(f64, f64); 3]) -> (f64, f64) {
    let (xy, first) = sum(x, y);
    let (all, second) = sum(xy, z);
    let low = ((x_low + y_low) + z_low) + (first + second);
    let high = all + low;
    (high, low - (high - all))
}

#[inline(always)]
fn largest(v: Vector) -> f64 {
    greater(greater(v[0].abs(), v[1].abs()), v[2].abs())
}

#[cfg(test)]
mod tests {
    use super::super::{About, EdgeRay, EdgeRays};
    use super::*;
    use crate::oracle::{Exact, cross, dot, minus, vector};
    use proptest::prelude::*;
    use raywright_base::math::{DVec3, Ray, RayBatch, Region};

    fn exact(ray: &Ray, corners: [DVec3; 3]) -> Exact {
        let [a, b, c] = corners.map(vector);
        let n = cross(&minus(&b, &a), &minus(&c, &a));
        dot(&n, &minus(&a, &vector(ray.origin))).over(&dot(&n, &vector(ray.direction)))
    }

    fn point(size: f64) -> impl Strategy<Value = DVec3> {
        let grid = prop::array::uniform3(-8i32..=8).prop_map(|p| DVec3::from_array(p.map(|x| f64::from(x) / 8.0)));
        let any = prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array);
        prop_oneof![grid, any].prop_map(move |p| p * size)
    }

    /// A triangle of any shape, and a ray to a point in it from any distance, even 0.
    fn aimed() -> impl Strategy<Value = (Ray, [DVec3; 3])> {
        let triangle = (point(1.0), [point(1.0), point(1.0), point(1.0)], 0i32..20, 0i32..20);
        let ray = (point(1.0), 0.0..1.0f64, 0.0..1.0f64, -60i32..20, -300i32..300);
        let scale = prop_oneof![Just(0), -90i32..90, -330i32..330];
        (triangle, ray, scale).prop_map(|((at, ways, small, thin), (way, v, w, far, length), scale)| {
            let mut corners = ways.map(|way| at + way * 2f64.powi(-small));
            corners[2] = corners[1] + (corners[2] - corners[1]) * 2f64.powi(-thin);
            let (v, w) = (v, w * (1.0 - v));
            let target = corners[0] * (1.0 - v - w) + corners[1] * v + corners[2] * w;
            let origin = target - way * 2f64.powi(far);
            let scale = 2f64.powi(scale);
            let ray = Ray::new(origin * scale, way * 2f64.powi(length));
            (Ray { t_min: f64::NEG_INFINITY, ..ray }, corners.map(|c| c * scale))
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(10_000))]
        #[test]
        fn t_is_the_nearest_f64_and_both_ends_are_closed((ray, corners) in aimed()) {
            let region = Region::around(corners);
            let meet = |ray: &Ray| {
                let ready = EdgeRay::new(ray, &region)?;
                ready.meet(corners).map(|met| met.t * ready.scale)
            };
            let Some(t) = meet(&ray) else { return Ok(()) };
            let wanted = exact(&ray, corners);
            // Correctly rounded except for ties, and for a second rounding of subnormal results.
            let off = (&wanted - &Exact::new(t)).abs();
            let most = if t.abs() > 1e-300 { (t.abs().next_up() - t.abs()) * 0.625 } else { f64::MIN_POSITIVE };
            prop_assert!(!Exact::new(most).less(&off), "{t} {ray:?}");
            prop_assert_eq!(t == 0.0, wanted.sign().is_eq() || t.abs() < f64::MIN_POSITIVE && t == 0.0);
            let asked = |t_min: f64, t_max: f64| meet(&Ray { t_min, t_max, ..ray });
            prop_assert_eq!(asked(t, t), Some(t));
            prop_assert_eq!(asked(t, f64::INFINITY), Some(t));
            prop_assert_eq!(asked(f64::NEG_INFINITY, t), Some(t));
            prop_assert_eq!(asked(t.next_up(), f64::INFINITY), None);
            prop_assert_eq!(asked(f64::NEG_INFINITY, t.next_down()), None);
        }

        #[test]
        fn what_is_said_about_t_holds((ray, corners) in aimed(), past in -2i32..=2) {
            let Some(ready) = EdgeRay::new(&ray, &Region::around(corners)) else { return Ok(()) };
            let far = ready.meet(corners).map_or(0.0, |met| met.t * ready.scale);
            let shift = far.abs() * 1e-8 * f64::from(past);
            let line = (f64::NEG_INFINITY, f64::INFINITY);
            for (t_min, t_max) in [line, (far + shift, f64::INFINITY), (far, far + shift)] {
                let asked = Ray { t_min, t_max, ..ray };
                let Some(ready) = EdgeRay::new(&asked, &Region::around(corners)) else { continue };
                let met = ready.meet(corners);
                match ready.meet_about(corners) {
                    About::Missed => prop_assert!(met.is_none()),
                    About::Between(low, high) => prop_assert!(met.is_some_and(|met| low <= met.t && met.t <= high)),
                    About::Open => {}
                }
            }
        }

        #[test]
        fn sixteen_rays_have_the_bits_of_one((ray, corners) in aimed(), past in -2i32..=2) {
            let region = Region::around(corners);
            let Some(ready) = EdgeRay::new(&ray, &region) else { return Ok(()) };
            let Some(met) = ready.meet(corners) else { return Ok(()) };
            let step = |t: f64, _| if past > 0 { t.next_up() } else { t.next_down() };
            let t = (0..past.abs()).fold(met.t * ready.scale, step);
            for (t_min, t_max) in [(f64::NEG_INFINITY, f64::INFINITY), (t, f64::INFINITY), (f64::NEG_INFINITY, t)] {
                let ray = Ray { t_min, t_max, ..ray };
                let wanted = EdgeRay::new(&ray, &region).and_then(|ready| ready.meet(corners));
                let mut rays = EdgeRays::default();
                rays.take(&RayBatch::Rows(&[ray]), 0);
                let plain = rays.prepare(&region) & 1;
                for fused in [false, true] {
                    let found = rays.meet(fused, corners, plain);
                    match wanted {
                        Some(met) if found.met == 1 => {
                            prop_assert_eq!((found.t[0], [found.uv[0][0], found.uv[1][0]]), (met.t, met.uv));
                        }
                        Some(_) => prop_assert_eq!(found.open, plain),
                        None => prop_assert_eq!(found.met, 0),
                    }
                }
            }
        }
    }

    /// For a thousand generic rays `t` is known without exact arithmetic.
    #[test]
    fn most_rays_need_no_exact_arithmetic() {
        let corners = [[0.1, 0.2, 0.3], [1.1, 0.3, 0.2], [0.2, 1.3, 0.4]];
        for i in 0..1000 {
            let (sin, cos) = (f64::from(i) * 0.7).sin_cos();
            let far = 10f64.powi(i % 7 - 2);
            let depth =
                Depth::new(false, [0.4 + cos * far, 0.5 + sin * far, 0.3 + 1.7 * far], [-cos, -sin, -1.7], corners);
            assert!(depth.is_known() && (depth.t / far - 1.0).abs() < 0.5 + 0.1 / far, "{far} {}", depth.t);
        }
        // The surface that a ray has left is rejected without exact arithmetic, too.
        for off in [1e-15, 1e-20] {
            let depth =
                Depth::new(false, [0.5, 0.5, off], [0.3, 0.2, 1.0], [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
            assert!(!depth.is_known() && depth.is_beyond(0.0, f64::INFINITY));
        }
    }
}
