//! The ring and the horn torus.

mod line;
#[cfg(test)]
mod tests;

use super::closest_on_revolution::Around;
use super::{Bounds, Candidate, Closest, Drawn, Point, Shape};
use line::Tube;
use raywright_base::math::robust::{UNIT, normalising_scale};
use raywright_base::math::{Affine, DVec3, DoubleDouble, Frame, Ray};
use std::f64::consts::{PI, TAU};

/// All points at distance `minor` from a circle of radius `major`.
///
/// The circle lies about `centre` at right angles to the axis. The surface is a ring torus if `minor < major`, and a
/// horn torus, which touches itself in the center, if they are equal. Spindle tori, which intersect themselves, are
/// rejected.
///
/// `u` runs around the axis and `v` around the tube, from the outermost circle toward the axis' direction.
#[derive(Clone, Debug)]
pub struct Torus {
    centre: DVec3,
    frame: Frame,
    major: f64,
    minor: f64,
    /// From the scene's units to those of `tube`, a power of two.
    scale: f64,
    tube: Tube,
}

impl Torus {
    /// Create a torus from its center, its axis of any length, and its major and minor radius.
    ///
    /// # Errors
    ///
    /// A one-line message if a number is not finite, the axis has no length, a radius is not between 1e-140 and 1e140,
    /// or the minor radius exceeds the major one.
    pub fn new(centre: DVec3, axis: DVec3, major: f64, minor: f64) -> Result<Self, String> {
        if !centre.is_finite() {
            return Err(format!("center is {centre}, expected finite numbers"));
        }
        let length = axis.abs().max_element();
        if !(axis.is_finite() && length >= f64::MIN_POSITIVE) {
            return Err(format!("axis is {axis}, expected a finite vector that is not zero"));
        }
        for (name, radius) in [("major_radius", major), ("minor_radius", minor)] {
            if !(1e-140..=1e140).contains(&radius) {
                return Err(format!("{name} is {radius:e}, expected a number from 1e-140 to 1e140"));
            }
        }
        if minor > major {
            return Err(format!(
                "minor_radius is {minor}, expected at most major_radius {major}: the surface would pass through itself"
            ));
        }
        let (unit, _) = normalising_scale(length);
        let direction = (axis * unit).to_array().map(DoubleDouble::from);
        let square = direction.iter().fold(DoubleDouble::ZERO, |sum, &x| sum + x.squared());
        let exact = direction.map(|x| x / square.sqrt());
        let (scale, _) = normalising_scale(major);
        Ok(Self {
            centre,
            frame: Frame::new(DVec3::from_array(exact.map(DoubleDouble::to_f64))),
            major,
            minor,
            scale,
            tube: Tube { axis: exact, major: major * scale, minor: minor * scale },
        })
    }

    fn uv(&self, from_centre: DVec3) -> [f64; 2] {
        let p = self.frame.to_local(from_centre);
        let ring = p.x.hypot(p.y) - self.tube.major;
        [p.y.atan2(p.x), p.z.atan2(ring)].map(|angle| {
            let part = angle / TAU;
            if part < 0.0 { (part + 1.0).min(1.0) } else { part }
        })
    }

    fn point_at(&self, uv: [f64; 2]) -> Point {
        let ((sin_u, cos_u), (sin_v, cos_v)) = ((TAU * uv[0]).sin_cos(), (TAU * uv[1]).sin_cos());
        let world = |x, y, z| self.frame.to_world(DVec3::new(x, y, z));
        let (around, outwards) = (world(-sin_u, cos_u, 0.0), world(cos_u, sin_u, 0.0));
        let normal = world(cos_u * cos_v, sin_u * cos_v, sin_v);
        let up = world(-cos_u * sin_v, -sin_u * sin_v, cos_v);
        let position = self.centre + (outwards * self.major + normal * self.minor);
        Point {
            position,
            // The angles err by 2u of a turn, the frame and the sums by a few u.
            error: 32.0 * UNIT * (self.major + self.minor) + UNIT * self.centre.abs().max_element() * 2.0,
            normal,
            uv,
            dp: [around * (TAU * (self.major + self.minor * cos_v)), up * (TAU * self.minor)],
            dn: [around * (TAU * cos_v), up * TAU],
        }
    }
}

impl Shape for Torus {
    fn closest(&self, place: DVec3) -> Option<Closest> {
        let local = self.frame.to_local(place - self.centre);
        let across = local.x.hypot(local.y);
        // All points of the circle are equally near to a point on the axis, and all of the tube to a point on the
        // circle.
        let [x, y] = if across > 0.0 { [local.x / across, local.y / across] } else { [1.0, 0.0] };
        let (out, up) = (across - self.major, local.z);
        let away = out.hypot(up);
        let [out, up] = if away > 0.0 { [out / away, up / away] } else { [1.0, 0.0] };
        let radius = self.major + self.minor * out;
        let from_centre = self.frame.to_world(DVec3::new(x * radius, y * radius, self.minor * up));
        Some(Closest { position: self.centre + from_centre, uv: self.uv(from_centre * self.scale) })
    }

    fn closest_stretched(&self, to_world: &Affine, _: &Affine, place: DVec3) -> Option<Closest> {
        let around = Around::new(to_world, &self.frame, self.centre, place);
        let curve = |out| around.of_circle(out, self.major, self.minor);
        let from_centre = self.frame.to_world(around.nearest(self.major + self.minor, curve).local);
        Some(Closest { position: to_world.point(self.centre + from_centre), uv: self.uv(from_centre * self.scale) })
    }

    fn bounds(&self) -> Bounds {
        let axis = self.frame.normal;
        let across = DVec3::new(axis.y.hypot(axis.z), axis.z.hypot(axis.x), axis.x.hypot(axis.y));
        let half = across * self.major + DVec3::splat(self.minor + 8.0 * UNIT * (self.major + self.minor));
        let (min, max) = (self.centre - half, self.centre + half);
        Bounds { min: min.map(f64::next_down), max: max.map(f64::next_up) }
    }

    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        let longest = ray.direction.abs().max_element();
        let finite = ray.origin.is_finite() && ray.direction.is_finite();
        if !(finite && longest >= f64::MIN_POSITIVE && ray.t_min <= ray.t_max) {
            return false;
        }
        let (unit, _) = normalising_scale(longest);
        let q = line::relative(ray, self.centre, self.scale);
        // Reject lines from beyond 10²⁰⁰ radii.
        if !q.iter().all(|x| x.high.abs() < 1e200) {
            return false;
        }
        let (_, inverse) = normalising_scale(self.major);
        let mut stopped = false;
        line::meet(&self.tube, q, ray.direction * unit, &mut |found| {
            let t = found.t * unit * inverse;
            if t >= ray.t_min && t <= ray.t_max && t.is_finite() {
                stopped = met(Candidate { t, uv: self.uv(found.position), contact: found.contact, inner: 0 });
            }
            stopped || t > ray.t_max
        });
        stopped
    }

    fn point(&self, _ray: &Ray, _t: f64, uv: [f64; 2]) -> Point {
        self.point_at(uv)
    }

    fn area(&self) -> f64 {
        4.0 * PI * PI * self.major * self.minor
    }

    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        // The fraction of the area up to an angle is (angle + r/R · sin) / 2π, which is monotone: invert it by Newton's
        // method within a bracket.
        let (turn, bulge) = (TAU * u[1], self.minor / self.major);
        let (mut low, mut high) = ((turn - bulge).max(0.0), (turn + bulge).min(TAU));
        let mut angle = turn;
        for _ in 0..64 {
            let off = angle + bulge * angle.sin() - turn;
            if off > 0.0 {
                high = angle
            } else {
                low = angle
            }
            let next = angle - off / (1.0 + bulge * angle.cos());
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            let step = (next - angle).abs();
            angle = next;
            if step < 1e-15 {
                break;
            }
        }
        Some(Drawn { point: self.point_at([u[0], angle / TAU]), pdf: 1.0 / self.area() })
    }
}
