//! The edge test: a ray hits a triangle if it passes all three edges on the same side.
//!
//! With corners `a b c` relative to the ray's origin, the weight of `a` is `d · (b × c)`, computed doubled as `d · ((b
//! − c) × (b + c))`. This form cancels less far from the origin, and reversing the edge negates it exactly. (It is the
//! side product of two lines in Plücker coordinates.) It is computed in f64 with an error bound; if the bound leaves
//! the sign open, the sign is computed exactly. So the decision is exact for the given numbers, and neighbors that
//! share an edge never disagree.
//!
//! The bound. Let u = 2⁻⁵³, M bound every coordinate of a corner relative to the origin, D < 2 every coordinate of the
//! direction. A relative corner errs by uM, a sum or difference of two by 4uM and is at most 2M. So a product of two of
//! them errs by 2·(2M·4uM) + u·4M² = 20uM², a component of the cross product by 2·20uM² + u·8M² = 48uM², its product
//! with d by 56uM²D and the sum of three by 3·56uM²D + u·(16 + 24)M²D = 208uM²D, to first order. 256uM²D leaves room
//! for higher orders, for small coordinates of the direction that scaling has rounded, and for the rounding of M and D
//! themselves. Underflow is not included: if coordinates are so small, or so large that products overflow, the decision
//! is exact.
//!
//! If the weights decide, `t` and its comparisons with the ray's ends are computed to the nearest f64
//! ([`super::depth`]); where that leaves them open, from exact integers.

use super::depth::{Depth, quotient};
use crate::{Candidate, Contact};
use raywright_base::math::robust::{UNIT, greater, lesser, normalising_scale};
use raywright_base::math::{DVec3, Ray, Region, exact_depth, exact_edges, exact_turn};

/// A ray prepared for edge tests: the direction scaled by a power of two so that its largest coordinate lies in [1, 2),
/// and error bounds.
#[derive(Clone, Copy, Debug)]
pub struct EdgeRay {
    /// The origin as given.
    pub origin: DVec3,
    /// The origin relative to the region's center.
    pub local: DVec3,
    /// Scaled by `scale`.
    pub direction: DVec3,
    /// The direction as given, for exact decisions.
    unscaled: DVec3,
    /// `t` along the given direction is `scale` times `t` along the scaled one.
    pub scale: f64,
    /// Along the scaled direction.
    pub t_min: f64,
    /// Along the scaled direction.
    pub t_max: f64,
    /// The axis of the direction's largest coordinate.
    axis: usize,
    /// Bound on the error of an edge's weight.
    sign_error: f64,
    /// Maximum error of `t` along the scaled direction before it is recomputed from exact weights.
    t_error: f64,
    /// Bounds the coordinates relevant for `t`: the origin, or where the ray approaches a distant scene, plus the
    /// region's radius.
    pub reach: f64,
    /// Bound on every coordinate relative to the origin.
    pub largest: f64,
    /// Bound on |origin| + |corner| in every coordinate.
    pub absolute: f64,
    /// True if the origin is so distant that the ray is moved to the scene before box tests.
    pub is_far: bool,
}

/// The f64 result for a ray and a triangle.
enum Weighed {
    /// A certain miss.
    Passed,
    /// A certain hit, with the corners' weights and their coordinates along the direction's largest axis.
    Met([f64; 3], [f64; 3]),
    Open,
}

/// The interval of `t` along the scaled direction, as cheaply computed in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum About {
    /// A miss.
    Missed,
    /// A hit within this interval.
    Between(f64, f64),
    /// Undecided.
    Open,
}

/// The least f64 above 0.
pub(super) const LEAST: f64 = f64::from_bits(1);

/// Conversion of `t` along a scaled direction.
#[derive(Clone, Copy, Debug)]
pub struct Along {
    /// `t` along the given direction over `t` along the scaled one.
    pub scale: f64,
    /// Bound on every coordinate of a corner relative to the origin.
    pub largest: f64,
}

impl Along {
    /// Maximum difference of `t` along the scaled direction between hits of the same point on two triangles that share
    /// it. Their weights are exact, and nine roundings of depths below `largest` remain.
    pub fn same_point(&self) -> f64 {
        32.0 * UNIT * self.largest
    }
}

impl EdgeRay {
    /// An origin is distant beyond this many radii.
    pub const FAR: f64 = 8.0;

    /// Error bound of `t` as a fraction of `reach`; box tests allow for as much.
    pub const T_ERROR: f64 = 1.0 / (1u64 << 26) as f64;

    /// Below it, products of three coordinates in the formula for `t` may underflow.
    const SMALLEST: f64 = 1e-90;

    /// Above it they may overflow.
    const GREATEST: f64 = 1e101;

    /// Error bound of an edge's weight if every coordinate of a corner relative to the origin is at most `largest`;
    /// infinite if f64 is never certain.
    #[inline(always)]
    pub fn sign_error(largest: f64) -> f64 {
        if largest > Self::SMALLEST && largest < Self::GREATEST {
            256.0 * UNIT * 2.0 * largest * largest
        } else {
            f64::INFINITY
        }
    }

    /// Scale an end of a ray. A subnormal result may be rounded, and is then moved by `inwards` so that the interval
    /// never grows.
    #[inline(always)]
    pub(super) fn scaled_end(t: f64, inverse: f64, scale: f64, inwards: f64) -> f64 {
        let end = t * inverse;
        let is_beyond = if inwards > 0.0 { end * scale < t } else { end * scale > t };
        end + if is_beyond { inwards } else { 0.0 }
    }

    /// Prepare a ray for the triangles of a region. None if it cannot hit anything: a number is NaN or infinite, the
    /// direction is zero (or has no normal coordinate), or `t_min > t_max`.
    #[inline(always)]
    pub fn new(ray: &Ray, region: &Region) -> Option<Self> {
        // Zero times infinity or NaN is NaN: one comparison tests six numbers.
        let zero = ray.origin * 0.0 + ray.direction * 0.0;
        let finite = zero.x + zero.y + zero.z == 0.0;
        let size = ray.direction.abs();
        let longest = greater(greater(size.x, size.y), size.z);
        let axis = if size.x == longest { 0 } else { 2 - usize::from(size.y == longest) };
        if !(finite && longest >= f64::MIN_POSITIVE && ray.t_min <= ray.t_max) {
            return None;
        }
        let (scale, inverse) = normalising_scale(longest);
        let local = ray.origin - region.centre;
        let far = local.abs();
        let far = greater(greater(far.x, far.y), far.z);
        let largest = far + region.radius;
        // A ray moved to the scene starts within √3 radii of the center, if it hits at all.
        let is_far = far > Self::FAR * region.radius;
        let reach = if is_far { 3.0 * region.radius } else { largest };
        let absolute = ray.origin.abs();
        Some(Self {
            origin: ray.origin,
            local,
            direction: ray.direction * scale,
            unscaled: ray.direction,
            scale,
            t_min: Self::scaled_end(ray.t_min, inverse, scale, LEAST),
            t_max: Self::scaled_end(ray.t_max, inverse, scale, -LEAST),
            axis,
            sign_error: Self::sign_error(largest),
            t_error: Self::T_ERROR * reach,
            reach,
            largest,
            absolute: greater(greater(absolute.x, absolute.y), absolute.z) + region.extent,
            is_far,
        })
    }

    /// Intersect a triangle, exactly decided. Every kernel ends here, so that all return the same bits.
    #[inline(always)]
    pub fn meet(&self, corners: [DVec3; 3]) -> Option<Candidate> {
        self.meet_in(false, corners)
    }

    /// The same in a kernel, where multiplication may be `fused`.
    #[inline(always)]
    pub fn meet_in(&self, fused: bool, corners: [DVec3; 3]) -> Option<Candidate> {
        match self.weigh(corners) {
            Weighed::Passed => return None,
            Weighed::Met(w, _) => {
                let depth = self.depth(fused, corners);
                if depth.is_known() {
                    return self.accept(w, w[0] + w[1] + w[2], depth.t, Contact::Inside);
                }
                if depth.is_beyond(self.t_min, self.t_max) {
                    return None;
                }
            }
            Weighed::Open => {}
        }
        self.meet_closely(corners)
    }

    /// Intersect a triangle approximately, for results certainly clear of the ray's ends.
    #[inline(always)]
    pub fn meet_about(&self, corners: [DVec3; 3]) -> About {
        let (w, z) = match self.weigh(corners) {
            Weighed::Passed => return About::Missed,
            Weighed::Open => return About::Open,
            Weighed::Met(w, z) => (w, z),
        };
        // The weighted mean of the corners' depths, in error by at most `t_error`.
        let sum = w[0] + w[1] + w[2];
        let t = (w[0] * z[0] + w[1] * z[1] + w[2] * z[2]) / (sum * self.direction[self.axis]);
        let (low, high) = (t - 2.0 * self.t_error, t + 2.0 * self.t_error);
        if high < self.t_min || low > self.t_max {
            return About::Missed;
        }
        let is_between = low > self.t_min && high < self.t_max && (high * self.scale).is_finite();
        if is_between { About::Between(low, high) } else { About::Open }
    }

    #[inline(always)]
    fn weigh(&self, corners: [DVec3; 3]) -> Weighed {
        let [a, b, c] = [corners[0] - self.origin, corners[1] - self.origin, corners[2] - self.origin];
        let volume = |v: DVec3, w: DVec3| self.direction.dot((v - w).cross(v + w));
        let w = [volume(b, c), volume(c, a), volume(a, b)];
        let above = self.sign_error;
        if (w[0] > above || w[1] > above || w[2] > above) && (w[0] < -above || w[1] < -above || w[2] < -above) {
            return Weighed::Passed;
        }
        let k = self.axis;
        let z = [a[k], b[k], c[k]];
        // If a weight is NaN, so is the sum, and the comparison fails.
        let least = lesser(lesser(w[0].abs(), w[1].abs()), w[2].abs());
        let sum = w[0] + w[1] + w[2];
        let range = greater(greater(z[0], z[1]), z[2]) - lesser(lesser(z[0], z[1]), z[2]);
        let is_certain = least > self.sign_error && 6.0 * self.sign_error * range <= self.t_error * sum.abs();
        if is_certain { Weighed::Met(w, z) } else { Weighed::Open }
    }

    #[inline(always)]
    fn depth(&self, fused: bool, [a, b, c]: [DVec3; 3]) -> Depth {
        let of = [[a.x, a.y, a.z], [b.x, b.y, b.z], [c.x, c.y, c.z]];
        let (o, d) = (self.origin, self.direction);
        Depth::new(fused, [o.x, o.y, o.z], [d.x, d.y, d.z], of)
    }

    /// A tighter test for rays from afar. With edges computed from the corners themselves, and E a bound on their
    /// coordinates, an edge errs by uE; the sum of two relative corners by 4uM and is at most 2M. So a product of the
    /// two errs by 2uEM + 4uEM + 2uEM = 8uEM, a component of the cross product by 16uEM + 4uEM, its product with d by
    /// 2·20uEM + 8uEM, and the sum of three by 3·48uEM + (16 + 24)uEM = 184uEM, to first order. 256uEM is allowed.
    #[cold]
    #[inline(never)]
    fn meet_closely(&self, original: [DVec3; 3]) -> Option<Candidate> {
        let [a, b, c] = original;
        let edges = [b - c, c - a, a - b];
        let largest = edges[0].abs().max(edges[1].abs()).max(edges[2].abs()).max_element();
        // Otherwise underflow in t is less than a rounding.
        if self.sign_error == f64::INFINITY || largest * self.largest * self.largest < 1e-270 {
            return self.meet_exactly(original);
        }
        let error = 256.0 * UNIT * largest * self.largest;
        let [a, b, c] = [a - self.origin, b - self.origin, c - self.origin];
        let volume = |edge: DVec3, sum: DVec3| self.direction.dot(edge.cross(sum));
        let w = [volume(edges[0], b + c), volume(edges[1], c + a), volume(edges[2], a + b)];
        if w.iter().any(|&x| x > error) && w.iter().any(|&x| x < -error) {
            return None;
        }
        let k = self.axis;
        let z = [a[k], b[k], c[k]];
        let sum = w[0] + w[1] + w[2];
        let range = z[0].max(z[1]).max(z[2]) - z[0].min(z[1]).min(z[2]);
        if w.iter().all(|x| x.abs() > error) && 6.0 * error * range <= self.t_error * sum.abs() {
            let depth = self.depth(false, original);
            if depth.is_known() {
                return self.accept(w, sum, depth.t, Contact::Inside);
            }
            if depth.is_beyond(self.t_min, self.t_max) {
                return None;
            }
        }
        self.meet_exactly(original)
    }

    /// The exact test, if rounding leaves a weight's sign or `t` open.
    #[cold]
    #[inline(never)]
    fn meet_exactly(&self, corners: [DVec3; 3]) -> Option<Candidate> {
        let w = exact_edges(self.origin, self.unscaled, corners);
        let sum = w[0] + w[1] + w[2];
        if w.iter().any(|&x| x > 0.0) && w.iter().any(|&x| x < 0.0) || w == [0.0; 3] {
            // A miss, or an edge-on triangle.
            return None;
        }
        let [over, under] = exact_depth(self.origin, self.unscaled, corners);
        // Scaled in two steps, which overflow or underflow only if `t` does.
        let power = over.exponent - under.exponent - exponent(self.scale);
        let half = power.clamp(-2000, 2000) / 2;
        let t =
            quotient(false, over.parts(), under.parts()) * 2f64.powi(half) * 2f64.powi(power.clamp(-2000, 2000) - half);
        // Turn −0 into +0.
        self.accept(w, sum, t + 0.0, self.contact(w, sum, corners))
    }

    /// The kind of contact with a triangle with these exact weights.
    fn contact(&self, w: [f64; 3], sum: f64, [a, b, c]: [DVec3; 3]) -> Contact {
        let mut contact = Contact::Inside;
        for (w, from, to) in [(w[0], b, c), (w[1], c, a), (w[2], a, b)] {
            if w == 0.0 {
                let turn = exact_turn(self.unscaled, from, to);
                if f64::from(turn) * sum <= 0.0 {
                    return Contact::Touching;
                }
                contact = Contact::Crossing;
            }
        }
        contact
    }

    /// The conversion of `t` along the scaled direction.
    #[inline(always)]
    pub fn along(&self) -> Along {
        Along { scale: self.scale, largest: self.largest }
    }

    #[inline(always)]
    fn accept(&self, w: [f64; 3], sum: f64, t: f64, contact: Contact) -> Option<Candidate> {
        // Reject hits whose `t` along a short direction overflows.
        (t >= self.t_min && t <= self.t_max && (t * self.scale).is_finite()).then(|| Candidate {
            t,
            uv: [w[1] / sum, w[2] / sum],
            contact,
            inner: 0,
        })
    }
}

/// The exponent of a power of two, which may be subnormal.
fn exponent(x: f64) -> i32 {
    let biased = (x.to_bits() >> 52) as i32 & 0x7ff;
    if biased == 0 { 52 - 1074 - x.to_bits().leading_zeros() as i32 + 11 } else { biased - 1023 }
}
