//! The disk, whole or with a round hole.

use super::line::Line;
use super::meeting::{Meets, Solid, tell};
use super::plane::crossing;
use super::{Bounds, Candidate, Carried, Drawn, Point, Shape};
use crate::math::robust::UNIT;
use crate::math::{Affine, DVec3, Frame, Number, Ray, Triple};
use std::cmp::Ordering;
use std::f64::consts::{PI, TAU};

/// The points of a plane between two distances from a centre, both included.
///
/// Its coordinates are the angle about the normal, in turns, and the way from the outer rim inwards to the inner one, or to the
/// centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Disk {
    /// Its centre.
    pub center: DVec3,
    /// At right angles to it, to its outside; of any length but 0.
    pub normal: DVec3,
    /// The distance of its rim.
    pub radius: f64,
    /// The distance of the hole's rim; 0 of a whole disk.
    pub inner_radius: f64,
}

impl Disk {
    fn frame(&self) -> Frame {
        Frame::new((self.normal / self.normal.abs().max_element()).normalize())
    }

    fn at(&self, [u, v]: [f64; 2]) -> Point {
        let Frame { tangent, bitangent, normal } = self.frame();
        let (sin, cos) = (TAU * u).sin_cos();
        let out = tangent * cos + bitangent * sin;
        let width = self.radius - self.inner_radius;
        let radius = self.inner_radius + width * (1.0 - v);
        let position = self.center + out * radius;
        // The last sum; and the radius times a frame whose axes are at right angles to within 8 UNIT.
        let error = UNIT * (position.abs().max_element() + 16.0 * self.radius);
        let round = (bitangent * cos - tangent * sin) * (TAU * radius);
        Point { position, error, normal, uv: [u, v], dp: [round, out * -width], dn: [DVec3::ZERO; 2] }
    }
}

impl Solid for Disk {
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets<N>> {
        let line = line.from(self.center);
        let (w, d) = (&line.origin, &line.direction);
        let normal = Triple::of(self.normal);
        // Where the plane is met, times n · d: (n · d) w − (n · w) d = n × (w × d).
        let along = normal.dot(d);
        if along.sign()? == Ordering::Equal {
            return Some(Meets::new(false));
        }
        let there = normal.cross(&w.cross(d));
        let square = there.dot(&there);
        let against = |radius: f64| {
            let limit = N::of(radius).times(&line.unit).times(&along);
            square.minus(&limit.squared()).sign()
        };
        if against(self.radius)? == Ordering::Greater
            || (self.inner_radius > 0.0 && against(self.inner_radius)? == Ordering::Less)
        {
            return Some(Meets::new(false));
        }
        crossing(&line, &normal)
    }

    #[inline(always)]
    fn surface<N: Number>(&self, _: usize, point: &Triple<N>, _: &N) -> N {
        Triple::of(self.normal).dot(point)
    }

    fn coordinates(&self, _: usize, point: DVec3) -> [f64; 2] {
        let local = self.frame().to_local(point);
        let turn = local.y.atan2(local.x) / TAU;
        let v = (self.radius - local.x.hypot(local.y)) / (self.radius - self.inner_radius);
        [if turn < 0.0 { (turn + 1.0).min(1.0) } else { turn }, v.clamp(0.0, 1.0)]
    }

    fn reference(&self) -> DVec3 {
        self.center
    }
}

impl Shape for Disk {
    fn bounds(&self) -> Bounds {
        Bounds::of_support(|d| self.support(d))
    }

    fn support(&self, d: DVec3) -> f64 {
        let normal = self.frame().normal;
        let size = (d.abs() * self.center.abs()).element_sum();
        d.dot(self.center)
            + self.radius * d.cross(normal).length()
            + UNIT * (4.0 * size + 16.0 * self.radius * d.length())
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
        PI * (self.radius - self.inner_radius) * (self.radius + self.inner_radius)
    }

    fn area_under(&self, map: &Affine) -> f64 {
        self.area() * map.cofactors(self.frame().normal).length()
    }

    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        // Even in the square of the distance.
        let (inner, outer) = (self.inner_radius, self.radius);
        let radius = (inner * inner + u[1] * (outer - inner) * (outer + inner)).sqrt();
        let v = ((outer - radius) / (outer - inner)).clamp(0.0, 1.0);
        Some(Drawn { point: self.at([u[0], v]), pdf: 1.0 / self.area() })
    }
}
