//! The closest point to the apex of a solid cone, among a triangle's points inside the cone.
//!
//! Triangle and cone are convex, and so is their intersection: there is one closest point. It is the triangle's point
//! closest to the apex, if that is in the cone. Otherwise it lies on the cone's surface: from a point inside the cone,
//! a step toward the triangle's closest point would decrease the distance. The triangle's plane cuts the cone's surface
//! in a conic section. By symmetry, the section's closest point lies in the plane through the axis and the normal, on
//! one generator of the cone. If that point is in the triangle, it is the result. If not, the closest point is on an
//! edge, by the same argument. Along an edge, the signed distance from the cone is convex as well. Its minimum has a
//! closed form, and Newton's method converges monotonically to the zero beside it.
//!
//! The bound. Let M be the largest coordinate of a corner relative to the apex, and u = 2⁻⁵³. A point q, of height z
//! over the apex and at distance ρ from the axis, is outside the cone by ρ cos α − z sin α. That is convex in q and
//! errs by less than 64uM: z errs by 6u|q|, of which 2u are the axis's own, ρ by 12u|q|, with |q| ≤ √3·M, and q itself,
//! on an edge, by 4uM. Points outside by at most δ = 2⁻⁴⁴·M count as inside, in units in which M lies in [1, 2). So a
//! triangle with a point in the cone is always found, and one that misses the cone by more than 2⁻⁴³·M never. The
//! distance is that for a cone whose surface is moved by no more than δ. If only interior points of the triangle are in
//! the cone, the axis hits the triangle, which is decided exactly ([`EdgeRay`]).

use super::nearest::cross;
use super::{EdgeRay, length, nearest_point, point_of};
use raywright_base::math::robust::{greater, lesser, normalising_scale};
use raywright_base::math::{DVec3, Ray, Region};

/// An infinite solid cone: all points whose direction from the apex is within an angle of the axis. It is a ray if that
/// angle is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidCone {
    /// The apex.
    pub apex: DVec3,
    /// The axis, a unit vector to within rounding.
    pub axis: DVec3,
    /// The axis as given.
    direction: DVec3,
    /// The sine of the half-angle.
    pub sine: f64,
    /// The cosine of the half-angle.
    pub cosine: f64,
    /// Maximum distance from the apex, in the scene's units.
    pub most: f64,
}

/// Points outside a cone by at most this touch it, for triangles whose largest coordinate from the apex lies in [1, 2).
const DELTA: f64 = 1.0 / (1u64 << 44) as f64;

/// Maximum coordinate for which differences and their differences are finite.
const LARGE: f64 = f64::MAX / 8.0;

impl SolidCone {
    /// The cone from `apex` along `direction`, of any length, with the given half-angle in degrees. None if it is empty
    /// or invalid. That is, a number is NaN or infinite, the direction is zero (or has no normal coordinate), the angle
    /// is not in 0..90, or `most` is negative or NaN.
    pub fn new(apex: DVec3, direction: DVec3, half_angle: f64, most: f64) -> Option<Self> {
        let longest = direction.abs().max_element();
        let is_cone = apex.is_finite() && direction.is_finite() && longest >= f64::MIN_POSITIVE;
        if !(is_cone && (0.0..90.0).contains(&half_angle) && most >= 0.0) {
            return None;
        }
        let axis = (direction * normalising_scale(longest).0).normalize();
        let (sine, cosine) = half_angle.to_radians().sin_cos();
        Some(Self { apex, axis, direction, sine, cosine, most })
    }

    /// A direction whose dot product with all points of the cone, relative to the apex, is at most 0: among those, the
    /// one nearest to `towards`. None on the axis.
    #[inline(always)]
    pub fn away(&self, towards: DVec3) -> Option<DVec3> {
        let across = self.across(towards);
        let size = across.length();
        (size > 0.0).then(|| across * (self.cosine / size) - self.axis * self.sine)
    }

    /// The component of a vector orthogonal to the axis. Projected twice, so that it is orthogonal to within rounding
    /// of its own length, however short.
    #[inline(always)]
    fn across(&self, vector: DVec3) -> DVec3 {
        let across = vector - self.axis * self.axis.dot(vector);
        across - self.axis * self.axis.dot(across)
    }

    /// The signed distance of a point relative to the apex from the cone's surface; negative inside.
    #[inline(always)]
    fn outside(&self, q: DVec3) -> f64 {
        let z = self.axis.dot(q);
        (q - self.axis * z).length() * self.cosine - z * self.sine
    }

    #[inline(always)]
    fn counts(&self, q: DVec3) -> bool {
        self.outside(q) <= DELTA && self.axis.dot(q) >= -DELTA
    }

    /// The distance from the apex to the closest point of a triangle inside the cone. None if there is none within
    /// `most`. The corners are finite.
    pub fn nearest(&self, corners: [DVec3; 3]) -> Option<f64> {
        self.nearest_of_all(corners).filter(|&distance| distance <= self.most && distance.is_finite())
    }

    fn nearest_of_all(&self, corners: [DVec3; 3]) -> Option<f64> {
        let to = corners.map(|c| c - self.apex);
        let largest = to[0].abs().max(to[1].abs()).max(to[2].abs()).max_element();
        // Infinite if a difference is.
        if largest > LARGE {
            const LESS: f64 = 1.0 / 32.0;
            let small = Self { apex: self.apex * LESS, ..*self };
            return small.nearest_of_all(corners.map(|c| c * LESS)).map(|distance| distance / LESS);
        }
        let (scale, inverse) = normalising_scale(greater(largest, f64::MIN_POSITIVE));
        let q = to.map(|c| c * scale);
        if self.is_apart(q) {
            return None;
        }
        let nearest = nearest_point(corners, self.apex);
        if self.counts((point_of(corners, nearest.uv) - self.apex) * scale) {
            return Some(nearest.distance);
        }
        let along =
            [(corners[2] - corners[1]) * scale, (corners[0] - corners[2]) * scale, (corners[1] - corners[0]) * scale];
        let on_edges = [(q[1], along[0]), (q[2], along[1]), (q[0], along[2])]
            .into_iter()
            .filter_map(|(from, along)| self.nearest_on_edge(from, along))
            .min_by(f64::total_cmp);
        let normal = cross(along[2], along[0]);
        let on_face = self.generator(normal, q).and_then(|way| self.met(corners, normal, q, way, way));
        let distance = match (on_edges, on_face) {
            (Some(a), Some(b)) => lesser(a, b),
            (a, b) => a.or(b).or_else(|| self.met(corners, normal, q, self.direction, self.axis))?,
        };
        // Rounding must not make it less than the distance to the triangle itself.
        Some(greater(distance * inverse, nearest.distance))
    }

    /// Return whether a plane through the apex, or normal to the axis there, separates triangle and cone.
    #[inline(always)]
    fn is_apart(&self, q: [DVec3; 3]) -> bool {
        let is_beyond = |way: DVec3| q.iter().all(|c| way.dot(*c) > 2.0 * DELTA);
        is_beyond(-self.axis) || self.away(q[0] + q[1] + q[2]).is_some_and(is_beyond)
    }

    /// The direction of the generator on which a triangle's plane is closest to the apex within the cone. None if the
    /// closest point is inside the cone, or the cone recedes from the plane.
    #[inline(always)]
    fn generator(&self, normal: DVec3, q: [DVec3; 3]) -> Option<DVec3> {
        let normal = if normal.dot(q[0]) < 0.0 { -normal } else { normal };
        let up = normal.dot(self.axis);
        let across = self.across(normal);
        let size = across.length();
        let is_steep = up >= self.cosine * normal.length();
        (!is_steep && size > 0.0).then(|| self.axis * self.cosine + across * (self.sine / size))
    }

    /// The distance from the apex to the triangle along a direction. Whether it is hit is decided exactly for the given
    /// direction. The distance along `unit` comes from the normal, which errs less than the weights for a small distant
    /// triangle.
    fn met(&self, corners: [DVec3; 3], normal: DVec3, q: [DVec3; 3], way: DVec3, unit: DVec3) -> Option<f64> {
        let ray = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(self.apex, way) };
        EdgeRay::new(&ray, &Region::around(corners))?.meet(corners)?;
        let squares = q.map(|c| c.length_squared());
        let (least, most) = if squares[0] <= squares[1] { (0, 1) } else { (1, 0) };
        let (least, most) =
            (if squares[2] < squares[least] { 2 } else { least }, if squares[2] > squares[most] { 2 } else { most });
        // A triangle that is hit is not edge-on. If its normal underflows, it is so small that any corner will do.
        let t = normal.dot(q[least]) / normal.dot(unit);
        let t = if t.is_finite() { t } else { q[least].dot(unit) };
        (t >= -DELTA).then(|| lesser(greater(t, 0.0), squares[most].sqrt()))
    }

    /// The least distance from the apex among an edge's points inside the cone.
    fn nearest_on_edge(&self, from: DVec3, along: DVec3) -> Option<f64> {
        let (z, rise) = (self.axis.dot(from), self.axis.dot(along));
        // Points behind the apex are outside, which the signed distance does not guarantee for a very narrow cone.
        let (mut low, mut high) = (0.0, 1.0);
        if z < -DELTA && z + rise < -DELTA {
            return None;
        }
        if z < -DELTA {
            low = lesser((-DELTA - z) / rise, 1.0);
        } else if z + rise < -DELTA {
            high = greater((-DELTA - z) / rise, 0.0);
        }
        let clamp = |s: f64| lesser(greater(s, low), high);
        let at = |s: f64| from + along * s;
        let (across, aside) = (from - self.axis * z, along - self.axis * rise);
        let square = aside.length_squared();
        let speed = square.sqrt();
        // The minimum of the signed distance along the edge: there the edge's distance to the axis grows as fast as the
        // cone's radius.
        let slope = self.sine * rise / (self.cosine * speed);
        let inmost = if slope > -1.0 && slope < 1.0 && square > 0.0 {
            let apart = across.cross(aside).length() / speed;
            clamp((apart * slope / ((1.0 - slope) * (1.0 + slope)).sqrt() - across.dot(aside) / speed) / speed)
        } else if rise > 0.0 {
            high
        } else {
            low
        };
        let depth = self.outside(at(inmost));
        if depth > DELTA {
            return None;
        }
        let length_squared = along.length_squared();
        let nearest = if length_squared > 0.0 { clamp(-from.dot(along) / length_squared) } else { inmost };
        if self.outside(at(nearest)) <= 0.0 {
            return Some(length(at(nearest)));
        }
        if depth > 0.0 {
            return Some(length(at(inmost)));
        }
        let derivative = |s: f64| {
            let from_axis = across + aside * s;
            self.cosine * from_axis.dot(aside) / from_axis.length() - self.sine * rise
        };
        // From outside in: the tangent of a convex function reaches zero before the function does.
        let (mut inside, mut outer) = (inmost, nearest);
        for _ in 0..128 {
            let newton = outer - self.outside(at(outer)) / derivative(outer);
            let is_between = (newton - inside) * (newton - outer) < 0.0;
            let s = if is_between { newton } else { 0.5 * (inside + outer) };
            if s == inside || s == outer {
                break;
            }
            if self.outside(at(s)) > 0.0 {
                outer = s;
            } else {
                inside = s;
                if is_between {
                    break;
                }
            }
        }
        Some(length(at(inside)))
    }
}
