//! MIS partials of a light path in media.

use super::vertex::{ConnectedVertex, Vertex};
use crate::light_paths::{Onward, Partial};
use raywright_scene::{EmissionDensity, EmissionSample, Emitters};

/// MIS partials at a vertex.
#[derive(Clone, Copy)]
pub(super) struct LightEnd {
    partial: Partial,
    /// Emission density, at the first vertex only: the density of light sampling there depends on the viewer.
    departure: Option<EmissionDensity>,
}

impl LightEnd {
    /// Make the partials of a path that starts.
    pub fn of(emitters: &Emitters, light: &EmissionSample) -> Self {
        let departure = emitters.of_sample(light);
        Self { partial: Partial::of_light(&departure), departure: Some(departure) }
    }

    /// Update for arrival at a vertex, the first or a later one.
    pub fn arrive(&mut self, at: &Vertex) {
        let cosine = at.cosine(at.back());
        self.partial = match self.departure {
            Some(_) => self.partial.arrived_first(cosine),
            None => self.partial.arrived(at.t, cosine),
        };
    }

    /// Return the partials at the vertex as seen along `met`.
    fn met(&self, emitters: &Emitters, at: &Vertex, met: &ConnectedVertex) -> Partial {
        let Some(departure) = &self.departure else { return self.partial };
        self.partial.asked(emitters.asked_from(&met.receiver, departure, at.ray.direction, at.t))
    }

    /// Return [`Partial::others`] as seen along `met`, for a path that arrives with a density.
    pub fn others(&self, emitters: &Emitters, at: &Vertex, met: &ConnectedVertex, comes: f64) -> f64 {
        self.met(emitters, at, met).others(comes, met.back)
    }

    /// Update for a path that continues.
    pub fn go_on(&mut self, emitters: &Emitters, at: &Vertex, next: &Onward) {
        let cosine = at.cosine(next.direction);
        self.partial = if next.is_single {
            self.partial.scattered_singly(cosine)
        } else {
            let met = at.met_from(next.direction, 1.0);
            self.met(emitters, at, &met).scattered(cosine, next.pdf, met.back)
        };
        self.departure = None;
    }
}
