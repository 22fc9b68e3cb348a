//! What a path of light among media knows of the other ways to find it.

use super::vertex::{Met, Vertex};
use crate::light_paths::{Onward, Partial};
use raywright_scene::{EmissionDensity, EmissionSample, Emitters};

/// What it knows where it has come to.
#[derive(Clone, Copy)]
pub(super) struct LightEnd {
    partial: Partial,
    /// How its light set out, where it has come to its first vertex: with which density that would ask for light
    /// depends on who looks.
    departure: Option<EmissionDensity>,
}

impl LightEnd {
    /// Of a path that has set out.
    pub fn of(emitters: &Emitters, light: &EmissionSample) -> Self {
        let departure = emitters.of_sample(light);
        Self { partial: Partial::of_light(&departure), departure: Some(departure) }
    }

    /// Of one that has come to a vertex, after others or as its first.
    pub fn arrive(&mut self, at: &Vertex) {
        let cosine = at.cosine(at.back());
        self.partial = match self.departure {
            Some(_) => self.partial.arrived_first(cosine),
            None => self.partial.arrived(at.t, cosine),
        };
    }

    /// Where somebody meets the vertex so.
    fn met(&self, emitters: &Emitters, at: &Vertex, met: &Met) -> Partial {
        let Some(departure) = &self.departure else { return self.partial };
        self.partial.asked(emitters.asked_from(&met.receiver, departure, at.ray.direction, at.t))
    }

    /// As [`Partial::others`], if somebody meets the vertex so who comes there with a density.
    pub fn others(&self, emitters: &Emitters, at: &Vertex, met: &Met, comes: f64) -> f64 {
        self.met(emitters, at, met).others(comes, met.back)
    }

    /// Of a path that goes on.
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
