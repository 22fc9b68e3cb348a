//! Reflected and refracted beams.
//!
//! Reflection and straight transmission map a beam to a beam exactly. Refraction does not: the refracted rays have no
//! common point. Heckbert and Hanrahan linearize it, with tangents in place of Snell's sines. This gives a common point
//! on the same normal of the face, at a distance scaled by a constant factor: their pseudo-focus. Straight edges stay
//! straight. Here the factor is exact for the central ray of a part, and parts are split until the error of all rays is
//! within the tolerance.

use super::beam::{Beam, ON_LINE, Origin, VisibleFace};
use super::face_shading::FilmHit;
use crate::Job;
use raywright_base::math::convex::{Convex, HalfPlane, centroid, cut};
use raywright_base::math::{DVec2, DVec3};
use raywright_base::workers::Cancel;

/// Minimum side of a part, in pixels. At the onset of total internal reflection no part is small enough.
const LEAST_SIDE: f64 = 1.0 / 16.0;

/// The refracted ray at a film position.
#[derive(Clone, Copy)]
struct Behind {
    direction: DVec3,
    /// Factor from the apex's distance in front of the face to that behind it.
    stretch: f64,
}

/// A face in a beam, with the parameters of the next beams.
pub(super) struct Onward<'a> {
    pub job: &'a Job<'a>,
    pub beam: &'a Beam,
    /// Index of the beam.
    pub number: usize,
    pub seen: &'a VisibleFace,
    /// Maximum error of refracted rays, in pixels, as seen from afar.
    pub tolerance: f64,
}

impl Onward<'_> {
    /// Return the beams that continue from a part of the face.
    pub fn beams(&self, part: &Convex, cancel: &Cancel) -> Vec<Beam> {
        let mut next = Vec::new();
        let mut reflects = false;
        self.met(centroid(part)).single_directions(|single| {
            reflects |= !single.is_through && !single.weight.is_black();
        });
        if reflects {
            next.push(self.beam(part.clone(), None));
        }
        let mut waiting = vec![part.clone()];
        while let Some(part) = waiting.pop() {
            if cancel.is_raised() {
                break;
            }
            let middle = self.behind(centroid(&part));
            if let Some(halves) = self.halves(&part, middle) {
                waiting.extend(halves);
            } else if let Some(Behind { stretch, .. }) = middle {
                next.push(self.beam(part, Some(stretch)));
            }
        }
        next
    }

    fn met(&self, at: DVec2) -> FilmHit {
        FilmHit::new(self.job, self.beam, self.seen.primitive, self.seen.nearness, at)
    }

    /// Return the reflected beam or, with a stretch, the transmitted one.
    fn beam(&self, part: Convex, through: Option<f64>) -> Beam {
        let &VisibleFace { primitive, nearness, .. } = self.seen;
        let origin = Origin { beam: self.number, primitive, nearness, through };
        self.beam.goes_on(part, self.job.scene.geometry(), origin)
    }

    /// Return the refracted ray at a film position, if there is one.
    fn behind(&self, at: DVec2) -> Option<Behind> {
        let before = self.beam.direction(at).normalize();
        let normal = self.job.scene.geometry().normal(self.seen.primitive);
        let mut behind = None;
        self.met(at).single_directions(|single| {
            if single.is_through && !single.weight.is_black() {
                // The ratio of the tangents is that of the sines, which is the index, divided by that of the cosines.
                let bent = single.eta * (single.wi.dot(normal) / before.dot(normal)).abs();
                let stretch = if single.eta == 1.0 { 1.0 } else { bent };
                behind = (stretch > 0.0 && stretch.is_finite()).then_some(Behind { direction: single.wi, stretch });
            }
        });
        behind
    }

    /// Split a part with excessive errors into halves; `None` if no error is excessive or the part is too small.
    fn halves(&self, part: &Convex, middle: Option<Behind>) -> Option<impl Iterator<Item = Convex> + use<>> {
        let low = part.iter().copied().reduce(DVec2::min)?;
        let size = part.iter().copied().reduce(DVec2::max)? - low;
        if size.max_element() < LEAST_SIDE || part.iter().all(|&corner| self.suits(corner, middle)) {
            return None;
        }
        let middle = low + 0.5 * size;
        let line = if size.x > size.y { DVec3::new(1.0, 0.0, -middle.x) } else { DVec3::new(0.0, 1.0, -middle.y) };
        Some(cut(part, &HalfPlane { line, slack: ON_LINE }).into_iter().filter(|half| half.len() > 2))
    }

    /// Return whether the ray at a film position agrees with the beam that is exact at the center.
    fn suits(&self, at: DVec2, middle: Option<Behind>) -> bool {
        match (middle, self.behind(at)) {
            (Some(middle), Some(here)) => {
                let beam = self.beam(Convex::new(), Some(middle.stretch));
                beam.place(here.direction).is_some_and(|place| place.distance(at) <= self.tolerance)
            }
            (None, None) => true,
            _ => self.tolerance == f64::INFINITY,
        }
    }
}
