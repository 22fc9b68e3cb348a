//! Triangles that shine, as they are seen from a place.

use raywright_base::math::DVec3;
use raywright_base::math::robust::greater;
use raywright_base::math::turn::{sin_cos, upper_angle};
use raywright_base::sampling::warp;

/// A triangle as it is seen from a place. Where it is near, directions to it are drawn evenly by solid angle, after
/// Arvo ("Stratified Sampling of Spherical Triangles", 1995) but without an arc cosine: all is found from half angles,
/// and from edges rather than from differences of directions, so that a thin triangle keeps its digits as well as a fat
/// one. Where it is distant, or seen next to edge-on, points are drawn by area, which is as good there and cheaper.
pub struct SeenTriangle {
    /// The first corner, and the edges from it to the others, as seen from the place.
    corner: DVec3,
    edges: [DVec3; 2],
    /// Along the normal, twice the area long.
    area: DVec3,
    /// What it is on the unit sphere, where directions are drawn.
    spherical: Spherical,
}

/// What a near triangle is on the unit sphere.
#[derive(Clone, Copy)]
struct Spherical {
    /// The directions of the first two corners.
    a: DVec3,
    b: DVec3,
    /// From `a` to `b`.
    chord: DVec3,
    /// 0 where points are drawn by area.
    solid_angle: f64,
}

impl SeenTriangle {
    /// How far away the first corner of a distant triangle is at least, in lengths of its longer edge. Of a point drawn
    /// by area the distance then varies by a factor of 3 at most.
    const DISTANT: f64 = 2.0;

    /// The least solid angle of a near triangle. So little is seen edge-on; the angle between two edges that are nearly
    /// one would lose its digits, of which it has 7 here at least.
    const THIN: f64 = 1e-9;

    /// As seen from a place.
    #[inline(always)]
    pub fn new([a, b, c]: [DVec3; 3], place: DVec3) -> Self {
        let (corner, edges) = (a - place, [b - a, c - a]);
        let longest = greater(edges[0].length_squared(), edges[1].length_squared());
        let area = edges[0].cross(edges[1]);
        let is_distant = corner.length_squared() > Self::DISTANT * Self::DISTANT * longest;
        let mut spherical = if is_distant { Spherical::NONE } else { Spherical::new(corner, edges, area) };
        // Neither what is thin nor what is no number.
        if !(spherical.solid_angle >= Self::THIN && spherical.solid_angle < f64::INFINITY) {
            spherical.solid_angle = 0.0;
        }
        Self { corner, edges, area, spherical }
    }

    /// How high the place is above the plane, on the side of the normal, in units of its own.
    #[inline]
    pub fn height(&self) -> f64 {
        -self.corner.dot(self.area)
    }

    /// Weights of the second and third corner of a point, drawn with [`SeenTriangle::pdf`].
    #[inline(always)]
    pub fn sample(&self, u: [f64; 2]) -> [f64; 2] {
        if self.spherical.solid_angle > 0.0 {
            self.meet(self.spherical.sample(self.edges[1], u))
        } else {
            warp::uniform_triangle(u)
        }
    }

    /// The density in solid angle of a direction that meets it at a distance, under the cosine of an angle to its
    /// normal.
    #[inline(always)]
    pub fn pdf(&self, distance: f64, cosine: f64) -> f64 {
        let solid_angle = self.spherical.solid_angle;
        if solid_angle > 0.0 {
            1.0 / solid_angle
        } else {
            distance * distance / (0.5 * self.area.length() * cosine.abs())
        }
    }

    /// Where a direction meets it, as it does but for roundings (by Cramer's rule).
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
    /// That of what is distant.
    const NONE: Self = Self { a: DVec3::ZERO, b: DVec3::ZERO, chord: DVec3::ZERO, solid_angle: 0.0 };

    /// The solid angle is NaN where a corner is the place itself.
    #[inline(always)]
    fn new(corner: DVec3, edges: [DVec3; 2], area: DVec3) -> Self {
        let corners = [corner, corner + edges[0], corner + edges[1]];
        let lengths = [corners[0].length(), corners[1].length(), corners[2].length()];
        let [a, b, c] = [corners[0] / lengths[0], corners[1] / lengths[1], corners[2] / lengths[2]];
        // tan(Ω/2) by van Oosterom and Strackee ("The Solid Angle of a Plane Triangle", 1983), its numerator by the
        // plane's distance.
        let determinant = corner.dot(area).abs() / (lengths[0] * lengths[1] * lengths[2]);
        let rest = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
        let solid_angle = 2.0 * upper_angle(determinant, rest);
        // 1/|b| − 1/|a|, by the difference of squares.
        let nearer = -edges[0].dot(corners[0] + corners[1]) / ((lengths[0] + lengths[1]) * lengths[0] * lengths[1]);
        let chord = edges[0] / lengths[1] + corner * nearer;
        Self { a, b, chord, solid_angle }
    }

    /// A direction drawn evenly. The first number takes a part of the angle, bounded by an arc from `b` to a point `q`
    /// of the arc from `a` to the third corner: with `t` the unit tangent of that arc at `a`, and φ the way to `q`
    /// along it,
    ///
    /// tan(Ω'/2) = det(a, b, q) / (1 + a·b + b·q + q·a)  for  q = a cos φ + t sin φ
    ///
    /// is solved by tan(φ/2) = tan(Ω'/2) (1 + a·b) / (det(a, b, t) − tan(Ω'/2) b·t). The second number goes along the
    /// arc from `b` to `q`, evenly by its height 1 − cos.
    #[inline(always)]
    fn sample(&self, edge: DVec3, u: [f64; 2]) -> DVec3 {
        let Self { a, b, chord, solid_angle } = *self;
        let tangent = (edge - a * a.dot(edge)).normalize();
        let [sin, cos] = sin_cos(0.5 * solid_angle * u[0]);
        let along = sin * (1.0 + a.dot(b));
        let against = cos * a.dot(chord.cross(tangent)).abs() - sin * chord.dot(tangent);
        let length = along * along + against * against;
        // From a to q, without the difference of the two.
        let step = (tangent * against - a * along) * (2.0 * along / length);
        let arc = if length > 0.0 { step - chord } else { -chord };
        // 1 − q·b is half the square of the chord between them.
        let height = 0.5 * arc.length_squared() * u[1];
        let side = (arc - b * b.dot(arc)).try_normalize().unwrap_or(DVec3::ZERO);
        b * (1.0 - height) + side * greater(height * (2.0 - height), 0.0).sqrt()
    }
}
