//! The edge form: a ray meets a triangle where it passes all three edges on the same side.
//!
//! With corners `a b c` relative to the ray's origin, the weight of `a` is `d · (b × c)`, twice over and written
//! `d · ((b − c) × (b + c))`, which loses less to cancellation far from the origin and is negated exactly when the
//! edge is walked the other way. (It is the side product of two lines in Plücker coordinates.) It is computed in f64
//! with a bound on its error; where the bound leaves the sign open the sign is found exactly. So the decision is the
//! exact one for the numbers given, and neighbours that share an edge never disagree.
//!
//! The bound. Let u = 2⁻⁵³, M bound every coordinate of a corner relative to the origin, D < 2 every coordinate of the
//! direction. A relative corner errs by uM, a sum or difference of two by 4uM and is at most 2M. So a product of two of
//! them errs by 2·(2M·4uM) + u·4M² = 20uM², a component of the cross product by 2·20uM² + u·8M² = 48uM², its product
//! with d by 56uM²D and the sum of three by 3·56uM²D + u·(16 + 24)M²D = 208uM²D, to first order. 256uM²D leaves room
//! for the higher orders, for a direction whose small parts were rounded in scaling, and for M, D themselves being
//! computed. What underflows is no part of it: coordinates so small, or so large that products overflow, are decided
//! exactly.
//!
//! Where the weights decide, `t` is computed to the nearest f64 ([`super::depth`]), and so are its comparisons with the
//! ends of the ray; where that leaves it open, from exact integers.

use super::depth::{Depth, quotient};
use crate::{Candidate, Contact};
use raywright_base::math::robust::{UNIT, greater, lesser, normalising_scale};
use raywright_base::math::{DVec3, Ray, Region, exact_depth, exact_edges, exact_turn};

/// A ray made ready for edge tests: the direction scaled by a power of two so that its largest coordinate lies in
/// [1, 2), and what is known beforehand about errors.
#[derive(Clone, Copy, Debug)]
pub struct EdgeRay {
    /// As given.
    pub origin: DVec3,
    /// The origin relative to the region's centre.
    pub local: DVec3,
    /// Scaled by `scale`.
    pub direction: DVec3,
    /// As given, for exact decisions.
    unscaled: DVec3,
    /// `t` as given is `scale` times `t` along the scaled direction.
    pub scale: f64,
    /// Of the scaled direction.
    pub t_min: f64,
    /// Of the scaled direction.
    pub t_max: f64,
    /// The direction's largest coordinate.
    axis: usize,
    /// Bound on the error of an edge's weight.
    sign_error: f64,
    /// How far `t` may be off along the scaled direction before it is computed anew from exact weights.
    t_error: f64,
    /// Bounds the coordinates that `t` is measured against: the origin, or where the ray nears a far scene, plus the
    /// region's radius.
    pub reach: f64,
    /// Bounds every coordinate relative to the origin.
    pub largest: f64,
    /// Bounds the sum of a coordinate of the origin and one of a corner, in magnitude.
    pub absolute: f64,
    /// Whether the origin is so far that the ray is moved up to the scene before boxes are tested.
    pub is_far: bool,
}

/// What f64 says of a ray and a triangle where its bounds leave no doubt.
enum Weighed {
    /// It is passed by.
    Passed,
    /// It is met, with these weights of its corners, which lie so far along the direction's largest coordinate.
    Met([f64; 3], [f64; 3]),
    Open,
}

/// Between which `t` along the scaled direction a triangle is met, as far as f64 says it without effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum About {
    /// It is not met.
    Missed,
    /// It is met between these.
    Between(f64, f64),
    /// More has to be known.
    Open,
}

/// The least f64 above 0.
pub(super) const LEAST: f64 = f64::from_bits(1);

/// How `t` along a scaled direction is to be read.
#[derive(Clone, Copy, Debug)]
pub struct Along {
    /// `t` as given over `t` along the scaled direction.
    pub scale: f64,
    /// Bounds every coordinate of a corner relative to the origin.
    pub largest: f64,
}

impl Along {
    /// How far apart along the scaled direction the same point may be found on two triangles that share it: their
    /// weights are exact, and nine roundings of depths below `largest` remain.
    pub fn same_point(&self) -> f64 {
        32.0 * UNIT * self.largest
    }
}

impl EdgeRay {
    /// Beyond so many radii an origin is far.
    pub const FAR: f64 = 8.0;

    /// How far `t` may be off, as a part of `reach`; box tests leave as much room.
    pub const T_ERROR: f64 = 1.0 / (1u64 << 26) as f64;

    /// Below it products of three coordinates, of which `t` is made, may underflow.
    const SMALLEST: f64 = 1e-90;

    /// Above it they may overflow.
    const GREATEST: f64 = 1e101;

    /// Bound on the error of an edge's weight where every coordinate of a corner relative to the origin is at most
    /// `largest`; infinite where nothing is certain in f64.
    #[inline(always)]
    pub fn sign_error(largest: f64) -> f64 {
        if largest > Self::SMALLEST && largest < Self::GREATEST {
            256.0 * UNIT * 2.0 * largest * largest
        } else {
            f64::INFINITY
        }
    }

    /// An end of a ray along its scaled direction. Where that is subnormal it may be rounded, but never so that what
    /// lies beyond the end counts: it moves by `inwards` then.
    #[inline(always)]
    pub(super) fn scaled_end(t: f64, inverse: f64, scale: f64, inwards: f64) -> f64 {
        let end = t * inverse;
        let is_beyond = if inwards > 0.0 { end * scale < t } else { end * scale > t };
        end + if is_beyond { inwards } else { 0.0 }
    }

    /// Makes a ray ready for the triangles of a region. None if it cannot hit anything: something is NaN or infinite,
    /// the direction is zero (or has no coordinate that is a normal number), or `t_min > t_max`.
    #[inline(always)]
    pub fn new(ray: &Ray, region: &Region) -> Option<Self> {
        // Zero times infinity or NaN is NaN: one comparison for six numbers.
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
        // Where a ray that is moved up to the scene starts is within √3 radii of the centre, if it hits at all.
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

    /// Where a triangle is met, if it is: decided for certain. Every kernel ends here, so that all give the same bits.
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

    /// Whether a triangle is met, and about where, if that is far enough from the ends of the ray to be sure.
    #[inline(always)]
    pub fn meet_about(&self, corners: [DVec3; 3]) -> About {
        let (w, z) = match self.weigh(corners) {
            Weighed::Passed => return About::Missed,
            Weighed::Open => return About::Open,
            Weighed::Met(w, z) => (w, z),
        };
        // The mean of the corners' depths, off by no more than `t_error`.
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
        // Should a weight be NaN, so is the sum, and the comparison with it fails.
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

    /// The same where that is not enough, as it is from far away. With edges taken from the corners themselves, and E a
    /// bound on their coordinates, an edge errs by uE; the sum of two relative corners by 4uM and is at most 2M. So a
    /// product of the two errs by 2uEM + 4uEM + 2uEM = 8uEM, a component of the cross product by 16uEM + 4uEM, its
    /// product with d by 2·20uEM + 8uEM, and the sum of three by 3·48uEM + (16 + 24)uEM = 184uEM, to first order.
    /// 256uEM is allowed.
    #[cold]
    #[inline(never)]
    fn meet_closely(&self, original: [DVec3; 3]) -> Option<Candidate> {
        let [a, b, c] = original;
        let edges = [b - c, c - a, a - b];
        let largest = edges[0].abs().max(edges[1].abs()).max(edges[2].abs()).max_element();
        // What underflows in t is then less than a rounding.
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

    /// The same where rounding leaves the sign of a weight open, or `t` uncertain.
    #[cold]
    #[inline(never)]
    fn meet_exactly(&self, corners: [DVec3; 3]) -> Option<Candidate> {
        let w = exact_edges(self.origin, self.unscaled, corners);
        let sum = w[0] + w[1] + w[2];
        if w.iter().any(|&x| x > 0.0) && w.iter().any(|&x| x < 0.0) || w == [0.0; 3] {
            // Passed by; or without area as the ray sees it.
            return None;
        }
        let [over, under] = exact_depth(self.origin, self.unscaled, corners);
        // Along the scaled direction, in steps that leave the range of f64 only where `t` does.
        let power = over.exponent - under.exponent - exponent(self.scale);
        let half = power.clamp(-2000, 2000) / 2;
        let t =
            quotient(false, over.parts(), under.parts()) * 2f64.powi(half) * 2f64.powi(power.clamp(-2000, 2000) - half);
        // Zero is always the positive one.
        self.accept(w, sum, t + 0.0, self.contact(w, sum, corners))
    }

    /// How a triangle with these exact weights is met.
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

    /// How `t` along the scaled direction is to be read.
    #[inline(always)]
    pub fn along(&self) -> Along {
        Along { scale: self.scale, largest: self.largest }
    }

    #[inline(always)]
    fn accept(&self, w: [f64; 3], sum: f64, t: f64, contact: Contact) -> Option<Candidate> {
        // What lies so far along a short direction that an f64 cannot say it is no hit either.
        (t >= self.t_min && t <= self.t_max && (t * self.scale).is_finite()).then(|| Candidate {
            t,
            uv: [w[1] / sum, w[2] / sum],
            contact,
            inner: 0,
        })
    }
}

/// That of a power of two, which may be subnormal.
fn exponent(x: f64) -> i32 {
    let biased = (x.to_bits() >> 52) as i32 & 0x7ff;
    if biased == 0 { 52 - 1074 - x.to_bits().leading_zeros() as i32 + 11 } else { biased - 1023 }
}
