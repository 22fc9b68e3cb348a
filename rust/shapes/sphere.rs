//! The sphere.

use super::line::Line;
use super::meeting::{Meets, Solid, ball, tell};
use super::{Bounds, Candidate, Carried, Drawn, Point, Shape};
use crate::math::robust::UNIT;
use crate::math::{Affine, DVec3, Frame, Number, Ray, ellipsoid_area};
use crate::sampling::warp::{UNIFORM_SPHERE_PDF, uniform_sphere};
use std::f64::consts::{PI, TAU};

/// All points at one distance from a centre; closed.
///
/// Its coordinates are the longitude about +z from +x on, in turns, and the latitude from the pole at −z to that at +z, in half
/// turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: DVec3,
    /// The distance from it, above 0.
    pub radius: f64,
}

impl Sphere {
    /// The unit sphere around the origin.
    pub const UNIT: Self = Self { center: DVec3::ZERO, radius: 1.0 };

    /// The point of given coordinates.
    ///
    /// The direction is unit to within 4 UNIT in each coordinate; the last sum adds one UNIT of its own.
    fn at(&self, [u, v]: [f64; 2]) -> Point {
        let (direction, derivatives) = globe([u, v]);
        self.towards(direction, [u, v], derivatives)
    }

    fn towards(&self, direction: DVec3, uv: [f64; 2], derivatives: [DVec3; 2]) -> Point {
        let position = self.center + direction * self.radius;
        let error = UNIT * (position.abs().max_element() + 5.0 * self.radius);
        let dp = derivatives.map(|d| d * self.radius);
        Point { position, error, normal: direction, uv, dp, dn: derivatives }
    }

    /// 1 − cos of half the angle that it fills as seen from a place, with the unit vector from the centre to the place and the sine of
    /// that half; none from inside.
    fn cap(&self, place: DVec3) -> Option<(f64, DVec3, f64)> {
        let way = place - self.center;
        let distance = way.length();
        if distance < self.radius {
            return None;
        }
        let sine = self.radius / distance;
        let cosine = ((distance - self.radius) * (distance + self.radius)).sqrt() / distance;
        // 1 − cos = sin² / (1 + cos), so that a small cap keeps its digits.
        Some((sine * sine / (1.0 + cosine), way / distance, sine))
    }
}

/// The unit vector of a longitude and a latitude, and how it changes with either.
pub(super) fn globe([u, v]: [f64; 2]) -> (DVec3, [DVec3; 2]) {
    let ((sin, cos), (out, down)) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
    let direction = DVec3::new(out * cos, out * sin, -down);
    (direction, [DVec3::new(-out * sin, out * cos, 0.0) * TAU, DVec3::new(down * cos, down * sin, out) * PI])
}

/// The longitude and the latitude of a vector of any length.
pub(super) fn longitude_latitude(x: DVec3) -> [f64; 2] {
    let turn = x.y.atan2(x.x) / TAU;
    [if turn < 0.0 { (turn + 1.0).min(1.0) } else { turn }, x.x.hypot(x.y).atan2(-x.z) / PI]
}

impl Solid for Sphere {
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets> {
        ball(&line.from(self.center), &N::of(self.radius).times(&line.unit))
    }

    fn coordinates(&self, _: usize, point: DVec3) -> [f64; 2] {
        longitude_latitude(point)
    }

    fn reference(&self) -> DVec3 {
        self.center
    }
}

impl Shape for Sphere {
    fn bounds(&self) -> Bounds {
        // One rounding each.
        Bounds {
            min: (self.center - self.radius).to_array().map(f64::next_down).into(),
            max: (self.center + self.radius).to_array().map(f64::next_up).into(),
        }
    }

    fn support(&self, d: DVec3) -> f64 {
        let size = (d.abs() * self.center.abs()).element_sum();
        let reach = self.radius * d.length();
        d.dot(self.center) + reach + UNIT * (4.0 * size + 8.0 * reach)
    }

    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        self.meet_carried(&Carried::Ray(ray), met)
    }

    fn meet_carried(&self, ray: &Carried<'_>, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        tell(self, ray, met)
    }

    fn point(&self, _: &Ray, _: f64, uv: [f64; 2]) -> Point {
        self.at(uv)
    }

    fn area(&self) -> f64 {
        4.0 * PI * self.radius * self.radius
    }

    fn area_under(&self, map: &Affine) -> f64 {
        ellipsoid_area_under(map, DVec3::splat(self.radius))
    }

    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        let direction = uniform_sphere(u);
        let uv = longitude_latitude(direction);
        Some(Drawn { point: self.at(uv), pdf: 1.0 / self.area() })
    }

    /// Evenly in the cone that it fills, or in all directions from inside.
    ///
    /// From outside the point is found from the angle at the centre, which has no difference of great numbers in it (Pharr, Jakob,
    /// Humphreys, "Physically Based Rendering", 4th edition, 2023, section 6.2.4): a sphere may be as small or as distant as it likes.
    fn sample_from(&self, place: DVec3, u: [f64; 2]) -> Option<Drawn> {
        let Some((height, axis, sine)) = self.cap(place) else {
            let direction = uniform_sphere(u);
            let ray = Ray { t_min: f64::MIN_POSITIVE, ..Ray::new(place, direction) };
            let mut point = None;
            self.meet(&ray, &mut |met| {
                point = Some(self.at(met.uv));
                true
            });
            return Some(Drawn { point: point?, pdf: UNIFORM_SPHERE_PDF });
        };
        // x = 1 − cos θ is even in [0, height), and sin² θ = x (2 − x).
        let x = u[0] * height;
        let square = x * (2.0 - x);
        let inside = (1.0 - square / (sine * sine)).max(0.0);
        // The angle between the place and the point, as seen from the centre.
        let cosine = square / sine + (1.0 - x) * inside.sqrt();
        let across = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
        let (sin, cos) = (TAU * u[1]).sin_cos();
        let direction = Frame::new(axis).to_world(DVec3::new(across * cos, across * sin, cosine)).normalize();
        let uv = longitude_latitude(direction);
        Some(Drawn { point: self.at(uv), pdf: 1.0 / (TAU * height) })
    }

    fn pdf_from(&self, place: DVec3, direction: DVec3) -> f64 {
        let Some((height, ..)) = self.cap(place) else { return UNIFORM_SPHERE_PDF };
        if self.meet(&Ray::new(place, direction), &mut |_| true) { 1.0 / (TAU * height) } else { 0.0 }
    }
}

/// The area of the image of an ellipsoid of given semi-axes, to about 10⁻¹⁴ of itself.
///
/// The image is the unit sphere's under L diag(a), and the singular values of that map's cofactors are the products of the image's
/// semi-axes two by two.
pub(super) fn ellipsoid_area_under(map: &Affine, axes: DVec3) -> f64 {
    let [x, y, z] = axes.to_array();
    let columns = [DVec3::X * (y * z), DVec3::Y * (z * x), DVec3::Z * (x * y)].map(|c| map.cofactors(c));
    ellipsoid_area(singular_values(columns))
}

/// The singular values of a matrix of three columns, by turning pairs of columns until they are at right angles (Hestenes,
/// "Inversion of Matrices by Biorthogonalization", 1958). Small ones keep their digits as well as large ones do.
fn singular_values(mut columns: [DVec3; 3]) -> [f64; 3] {
    for _ in 0..40 {
        let mut turned = false;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b) = (columns[i], columns[j]);
            let (aa, bb, ab) = (a.length_squared(), b.length_squared(), a.dot(b));
            if ab.abs() <= UNIT * (aa * bb).sqrt() {
                continue;
            }
            turned = true;
            let slope = (bb - aa) / (2.0 * ab);
            let tangent = 1f64.copysign(slope) / (slope.abs() + slope.hypot(1.0));
            let cosine = 1.0 / tangent.hypot(1.0);
            let sine = cosine * tangent;
            (columns[i], columns[j]) = (a * cosine - b * sine, a * sine + b * cosine);
        }
        if !turned {
            break;
        }
    }
    columns.map(DVec3::length)
}
