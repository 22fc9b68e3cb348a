//! Sampling of emissive triangles from a receiver.

use raywright_base::math::DVec3;
use raywright_base::math::robust::greater;
use raywright_base::math::trig::{sin_cos, upper_angle};
use raywright_base::sampling::warp;

/// A triangle seen from a position. A near triangle is sampled uniformly by solid angle, after Arvo ("Stratified
/// Sampling of Spherical Triangles", 1995) but without an arc cosine. All quantities come from half angles, and from
/// edges rather than differences of directions, so that thin triangles keep their digits. A distant or nearly edge-on
/// triangle is sampled by area, which is equally good there and cheaper.
pub struct SeenTriangle {
    /// First corner, and the edges from it to the others, relative to the position.
    corner: DVec3,
    edges: [DVec3; 2],
    /// Normal vector with twice the area as length.
    area: DVec3,
    /// The spherical triangle, used for sampling by solid angle.
    spherical: Spherical,
}

/// A near triangle projected onto the unit sphere.
#[derive(Clone, Copy)]
struct Spherical {
    /// Directions of the first two corners.
    a: DVec3,
    b: DVec3,
    /// From `a` to `b`.
    chord: DVec3,
    /// 0 if points are sampled by area.
    solid_angle: f64,
}

impl SeenTriangle {
    /// Minimum distance of the first corner of a distant triangle, in lengths of its longer edge. The distance of
    /// points sampled by area then varies by a factor of 3 at most.
    const DISTANT: f64 = 2.0;

    /// Minimum solid angle of a near triangle. Below it the triangle is nearly edge-on, and the angle between nearly
    /// parallel edges would lose its digits; here it keeps at least 7.
    const THIN: f64 = 1e-9;

    /// Precomputes the sampling of a triangle from a position.
    #[inline(always)]
    pub fn new([a, b, c]: [DVec3; 3], place: DVec3) -> Self {
        let (corner, edges) = (a - place, [b - a, c - a]);
        let longest = greater(edges[0].length_squared(), edges[1].length_squared());
        let area = edges[0].cross(edges[1]);
        let is_distant = corner.length_squared() > Self::DISTANT * Self::DISTANT * longest;
        let mut spherical = if is_distant { Spherical::NONE } else { Spherical::new(corner, edges, area) };
        // Rejects thin triangles and NaN.
        if !(spherical.solid_angle >= Self::THIN && spherical.solid_angle < f64::INFINITY) {
            spherical.solid_angle = 0.0;
        }
        Self { corner, edges, area, spherical }
    }

    /// Height of the position above the plane on the normal's side, up to a positive factor.
    #[inline]
    pub fn height(&self) -> f64 {
        -self.corner.dot(self.area)
    }

    /// Samples a point with density [`SeenTriangle::pdf`]; returns the barycentric coordinates of the second and third
    /// corner.
    #[inline(always)]
    pub fn sample(&self, u: [f64; 2]) -> [f64; 2] {
        if self.spherical.solid_angle > 0.0 {
            self.meet(self.spherical.sample(self.edges[1], u))
        } else {
            warp::uniform_triangle(u)
        }
    }

    /// Density by solid angle of a direction that hits the triangle at a distance; the cosine is that to its normal.
    #[inline(always)]
    pub fn pdf(&self, distance: f64, cosine: f64) -> f64 {
        let solid_angle = self.spherical.solid_angle;
        if solid_angle > 0.0 {
            1.0 / solid_angle
        } else {
            distance * distance / (0.5 * self.area.length() * cosine.abs())
        }
    }

    /// Intersection of a direction with the triangle, by Cramer's rule. The direction is known to hit, up to roundings.
    #[inline(always)]
    fn meet(&self, direction: DVec3) -> [f64; 2] {
        let [first, second] = self.edges;
        let across = direction.cross(second);
        let determinant = first.dot(across);
        let v = -self.corner.dot(across) / determinant;
        let w = -direction.dot(self.corner.cross(first)) / determinant;
        let (v, w) = (greater(v, 0.0), greater(w, 0.0));
        let sum = greater(v + w, 1.0);
        [v / sum, w / sum]
    }
}

impl Spherical {
    /// Marks a distant triangle.
    const NONE: Self = Self { a: DVec3::ZERO, b: DVec3::ZERO, chord: DVec3::ZERO, solid_angle: 0.0 };

    /// Computes the spherical triangle; its solid angle is NaN if a corner coincides with the position.
    #[inline(always)]
    fn new(corner: DVec3, edges: [DVec3; 2], area: DVec3) -> Self {
        let corners = [corner, corner + edges[0], corner + edges[1]];
        let lengths = [corners[0].length(), corners[1].length(), corners[2].length()];
        let [a, b, c] = [corners[0] / lengths[0], corners[1] / lengths[1], corners[2] / lengths[2]];
        // tan(Ω/2) by van Oosterom and Strackee ("The Solid Angle of a Plane Triangle", 1983), with its numerator from
        // the plane's distance.
        let determinant = corner.dot(area).abs() / (lengths[0] * lengths[1] * lengths[2]);
        let rest = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
        let solid_angle = 2.0 * upper_angle(determinant, rest);
        // 1/|b| − 1/|a|, by the difference of squares.
        let nearer = -edges[0].dot(corners[0] + corners[1]) / ((lengths[0] + lengths[1]) * lengths[0] * lengths[1]);
        let chord = edges[0] / lengths[1] + corner * nearer;
        Self { a, b, chord, solid_angle }
    }

    /// Samples a direction uniformly. The first number selects a part of the solid angle, bounded by the arc from `b`
    /// to a point `q` on the arc from `a` to the third corner. Let `t` be the unit tangent of that arc at `a`, and φ
    /// the angle to `q`. Then
    ///
    /// tan(Ω'/2) = det(a, b, q) / (1 + a·b + b·q + q·a)  for  q = a cos φ + t sin φ
    ///
    /// is solved by tan(φ/2) = tan(Ω'/2) (1 + a·b) / (det(a, b, t) − tan(Ω'/2) b·t). The second number selects a point
    /// on the arc from `b` to `q`, uniform in its height 1 − cos.
    #[inline(always)]
    fn sample(&self, edge: DVec3, u: [f64; 2]) -> DVec3 {
        let Self { a, b, chord, solid_angle } = *self;
        let tangent = (edge - a * a.dot(edge)).normalize();
        let [sin, cos] = sin_cos(0.5 * solid_angle * u[0]);
        let along = sin * (1.0 + a.dot(b));
        let against = cos * a.dot(chord.cross(tangent)).abs() - sin * chord.dot(tangent);
        let length = along * along + against * against;
        // From a to q, without subtracting the two.
        let step = (tangent * against - a * along) * (2.0 * along / length);
        let arc = if length > 0.0 { step - chord } else { -chord };
        // 1 − q·b is half the squared chord between them.
        let height = 0.5 * arc.length_squared() * u[1];
        let side = (arc - b * b.dot(arc)).try_normalize().unwrap_or(DVec3::ZERO);
        b * (1.0 - height) + side * greater(height * (2.0 - height), 0.0).sqrt()
    }
}
