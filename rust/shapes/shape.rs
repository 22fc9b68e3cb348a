//! What every shape that is no triangle can be asked.

use super::Candidate;
use crate::math::{DVec3, Ray};
use std::fmt::Debug;

/// The closed box from one corner to another, in f64. Infinite along an axis where what it holds is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The least corner.
    pub min: DVec3,
    /// The greatest corner.
    pub max: DVec3,
}

impl Bounds {
    /// Whether it ends on every side.
    pub fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }
}

/// A point of a shape, and how the surface lies there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where it is, to within `error` in each coordinate.
    pub position: DVec3,
    /// Bound on the error of each coordinate of `position`.
    pub error: f64,
    /// The unit normal, to the outside of what is closed.
    pub normal: DVec3,
    /// Coordinates on the shape, each from 0 to 1.
    pub uv: [f64; 2],
    /// How the position changes with either coordinate.
    pub dp: [DVec3; 2],
    /// How the unit normal changes with either coordinate.
    pub dn: [DVec3; 2],
}

/// A point drawn from a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// The point.
    pub point: Point,
    /// Its density: by area, or by solid angle as seen from where it was drawn for.
    pub pdf: f64,
}

/// What can be hit and is no triangle. Everything is in the shape's own space.
pub trait Shape: Debug + Send + Sync {
    /// The least box around it, rounded outwards.
    fn bounds(&self) -> Bounds;

    /// Calls `met` with every point where the line meets the shape and `t_min ≤ t ≤ t_max`, both ends included, by increasing `t`,
    /// until it says true; then that is said.
    ///
    /// The direction need not be unit, and `t` counts in its lengths. Whether there is a hit is decided for the numbers as they
    /// are given. A closed shape is crossed evenly: a line that touches it is told once, as [`super::Contact::Touching`].
    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool;

    /// The point of a candidate that [`Shape::meet`] told of this ray, moved onto the surface as nearly as f64 can.
    fn point(&self, ray: &Ray, t: f64, uv: [f64; 2]) -> Point;

    /// Its area; infinite where it has no end.
    fn area(&self) -> f64;

    /// A point drawn evenly by area, from two numbers in [0, 1). None of a shape without end, or of no area.
    fn sample(&self, u: [f64; 2]) -> Option<Drawn>;

    /// A point drawn by solid angle as seen from a place, or as nearly so as the shape allows; its `pdf` is by solid angle. The point is
    /// one that is met first from there, or may be hidden by the shape itself where the density says so too. None where nothing is seen.
    fn sample_from(&self, place: DVec3, u: [f64; 2]) -> Option<Drawn> {
        let drawn = self.sample(u)?;
        let way = drawn.point.position - place;
        let cosine = drawn.point.normal.dot(way).abs() / way.length();
        let pdf = drawn.pdf * way.length_squared() / cosine;
        (pdf.is_finite() && pdf > 0.0).then_some(Drawn { pdf, ..drawn })
    }

    /// The density by solid angle with which [`Shape::sample_from`] draws towards a direction from a place: the sum over all points
    /// that lie there. 0 where it draws none.
    fn pdf_from(&self, place: DVec3, direction: DVec3) -> f64 {
        let area = self.area();
        let ray = Ray::new(place, direction);
        let mut pdf = 0.0;
        self.meet(&ray, &mut |met| {
            let point = self.point(&ray, met.t, met.uv);
            let cosine = point.normal.dot(direction).abs() / direction.length();
            let distance = met.t * direction.length();
            if met.t > 0.0 && cosine > 0.0 {
                pdf += distance * distance / (cosine * area);
            }
            false
        });
        if area.is_finite() { pdf } else { 0.0 }
    }
}
