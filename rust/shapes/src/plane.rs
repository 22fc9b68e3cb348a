//! The infinite plane.

use super::line::Line;
use super::meeting::tell;
use super::solid::{Meet, Meets, Solid};
use super::{Bounds, Candidate, Carried, Closest, Contact, Drawn, Point, Shape};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{Affine, DVec3, Frame, Number, Ray, Triple};
use std::cmp::Ordering;

/// The least reported error of a point, well above the range where products underflow.
const LEAST: f64 = 1e-100;

/// The plane through a point, normal to a vector of any length but 0.
///
/// u and v are the coordinates from the point along two unit axes in the plane, modulo 1: they repeat with period 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// A point on it.
    pub point: DVec3,
    /// The normal of the outside.
    pub normal: DVec3,
}

impl Plane {
    fn frame(&self) -> Frame {
        // Scaled first, so that no square overflows or underflows.
        Frame::new((self.normal / self.normal.abs().max_element()).normalize())
    }
}

impl Solid for Plane {
    fn meets<N: Number>(&self, line: &Line<N>) -> Option<Meets<N>> {
        crossing(&line.from(self.point), &Triple::of(self.normal))
    }

    #[inline(always)]
    fn surface<N: Number>(&self, _: usize, point: &Triple<N>, _: &N) -> N {
        Triple::of(self.normal).dot(point)
    }

    fn coordinates(&self, _: usize, point: DVec3) -> [f64; 2] {
        let local = self.frame().to_local(point);
        [local.x, local.y].map(|x| x - x.floor())
    }

    fn reference(&self) -> DVec3 {
        self.point
    }
}

/// Intersect a line with the plane through the origin. Parallel and contained lines do not intersect it.
#[inline]
pub(super) fn crossing<N: Number>(line: &Line<N>, normal: &Triple<N>) -> Option<Meets<N>> {
    let (along, height) = (normal.dot(&line.direction), normal.dot(&line.origin));
    if along.sign()? == Ordering::Equal {
        return Some(Meets::new(false));
    }
    let t = height.negated().over(&along);
    let meet = Meet { t, slope: along, bend: N::of(0.0), surface: 0, part: 0, contact: Contact::Inside };
    Some(Meets::new(false).with(meet))
}

impl Shape for Plane {
    fn is_closed(&self) -> bool {
        false
    }

    fn closest(&self, place: DVec3) -> Option<Closest> {
        let normal = self.frame().normal;
        let away = place - self.point;
        let along = away - normal * normal.dot(away);
        Some(Closest { position: self.point + along, uv: self.coordinates(0, along) })
    }

    /// The image is a plane too.
    fn closest_under(&self, to_world: &Affine, to_object: &Affine, place: DVec3) -> Option<Closest> {
        let image = Self { point: to_world.point(self.point), normal: to_object.transposed(self.normal) };
        let position = image.closest(place)?.position;
        Some(Closest { position, uv: self.coordinates(0, to_object.point(position) - self.point) })
    }

    /// Unbounded, but flat if the normal is parallel to an axis.
    fn bounds(&self) -> Bounds {
        Bounds::of_support(|d| self.support(d))
    }

    fn support(&self, d: DVec3) -> f64 {
        let cross = [(1, 2), (2, 0), (0, 1)].map(|(j, k)| d[j] * self.normal[k] == d[k] * self.normal[j]);
        if cross != [true; 3] {
            return f64::INFINITY;
        }
        let size = (d.abs() * self.point.abs()).element_sum();
        d.dot(self.point) + if (d.abs().element_sum() - d.abs().max_element()) > 0.0 { 4.0 * UNIT * size } else { 0.0 }
    }

    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        self.meet_carried(&Carried::Ray(ray), met)
    }

    fn meet_carried(&self, ray: &Carried<'_>, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        tell(self, ray, met)
    }

    /// The ray's point, projected onto the plane along the normal.
    ///
    /// The distance to the plane is a dot product of four rounded differences, in error by 6 UNIT of their magnitudes.
    /// As much again covers the normal's error.
    fn point(&self, ray: &Ray, t: f64, uv: [f64; 2]) -> Point {
        let Frame { tangent, bitangent, normal } = self.frame();
        let away = Carried::Ray(ray).line().from(self.point).at(t);
        let away = away - normal * normal.dot(away);
        let position = self.point + away;
        // The magnitudes are all 0 for a plane through the origin, but a spawned ray still has to leave it.
        let error = (UNIT * (position.abs().max_element() + 12.0 * away.abs().element_sum())).max(LEAST);
        Point { position, error, normal, uv, dp: [tangent, bitangent], dn: [DVec3::ZERO; 2] }
    }

    fn area(&self) -> f64 {
        f64::INFINITY
    }

    fn area_under(&self, _: &Affine) -> f64 {
        f64::INFINITY
    }

    fn sample(&self, _: [f64; 2]) -> Option<Drawn> {
        None
    }

    fn sample_from(&self, _: DVec3, _: [f64; 2]) -> Option<Drawn> {
        None
    }

    fn pdf_from(&self, _: DVec3, _: DVec3) -> f64 {
        0.0
    }
}
