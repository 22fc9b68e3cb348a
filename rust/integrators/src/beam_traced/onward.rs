//! Beams that go on from a part of a face.
//!
//! A mirror or a pane turns a beam into one that is exact. Refraction does not: the rays behind a face of glass have no
//! point in common. Heckbert and Hanrahan take it for linear, with tangents in the place of Snell's sines, which gives
//! them one, on the same normal of the face and some times as far from it: their pseudo-focus. Straight edges stay
//! straight so. Here that factor is exact for the ray in the middle of a part, and parts are cut until the others are
//! off by no more than is allowed.

use super::beam::{Beam, ON_LINE, Origin, Seen};
use super::shading::Met;
use crate::Job;
use raywright_base::math::convex::{Convex, HalfPlane, centroid, cut};
use raywright_base::math::{DVec2, DVec3};
use raywright_base::workers::Cancel;

/// Parts of fewer pixels, both ways, are not cut: where total reflection begins, no part is small enough.
const LEAST_SIDE: f64 = 1.0 / 16.0;

/// The ray through a place of the film behind a face.
#[derive(Clone, Copy)]
struct Behind {
    direction: DVec3,
    /// How many times as far from the face its beam comes from than that in front of it.
    stretch: f64,
}

/// A face in a beam, and how rays go on from there.
pub(super) struct Onward<'a> {
    pub job: &'a Job<'a>,
    pub beam: &'a Beam,
    /// Its number.
    pub number: usize,
    pub seen: &'a Seen,
    /// How many pixels a refracted ray may be off, seen from afar.
    pub tolerance: f64,
}

impl Onward<'_> {
    /// All beams that go on from a part of the face.
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

    fn met(&self, at: DVec2) -> Met {
        Met::new(self.job, self.beam, self.seen.primitive, self.seen.nearness, at)
    }

    /// The beam that a mirror throws back or, with a stretch, that goes on behind the face.
    fn beam(&self, part: Convex, through: Option<f64>) -> Beam {
        let &Seen { primitive, nearness, .. } = self.seen;
        let origin = Origin { beam: self.number, primitive, nearness, through };
        self.beam.goes_on(part, self.job.scene.geometry(), origin)
    }

    /// How the ray through a place goes on behind the face; `None` if it does not.
    fn behind(&self, at: DVec2) -> Option<Behind> {
        let before = self.beam.direction(at).normalize();
        let normal = self.job.scene.geometry().normal(self.seen.primitive);
        let mut behind = None;
        self.met(at).single_directions(|single| {
            if single.is_through && !single.weight.is_black() {
                // The ratio of the tangents is that of the sines, which is the index, by that of the cosines.
                let bent = single.eta * (single.wi.dot(normal) / before.dot(normal)).abs();
                let stretch = if single.eta == 1.0 { 1.0 } else { bent };
                behind = (stretch > 0.0 && stretch.is_finite()).then_some(Behind { direction: single.wi, stretch });
            }
        });
        behind
    }

    /// The two halves of a part of whose rays some are off by too much; `None` if none is, or it is too small.
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

    /// Whether the ray through a place goes on as in the beam that is exact in the middle.
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
