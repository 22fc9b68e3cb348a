//! MIS partials of light paths.

use super::adjoint::{AdjointInteraction, Arrived, Onward};
use super::light_walk::Flying;
use super::mis_weights::Partial;
use crate::is_matt;
use raywright_scene::{EmissionDensity, EmissionSample, Emitters};

/// MIS partials of each path of a batch.
pub(crate) struct Partials<'a> {
    emitters: &'a Emitters<'a>,
    ends: Vec<LightEnd>,
    /// Merging disk of each path, if vertices are merged ([`Partial::merging`]).
    disks: Vec<f64>,
}

/// MIS partials of one path.
#[derive(Clone, Copy)]
pub(crate) struct LightEnd {
    partial: Partial,
    /// Emission density, at the first surface only: the density of light sampling there depends on the viewer.
    departure: Option<EmissionDensity>,
}

impl LightEnd {
    /// Return the partials at a vertex after the first surface.
    pub fn partial(&self) -> Partial {
        self.partial
    }

    /// Return the partials at the vertex as seen along `met`.
    fn met(&self, emitters: &Emitters, arrived: &Arrived, met: &AdjointInteraction) -> Partial {
        let Some(departure) = &self.departure else { return self.partial };
        let receiver = met.light_context();
        self.partial.asked(emitters.asked_from(&receiver, departure, arrived.ray.direction, arrived.hit.t))
    }

    /// Return [`Partial::others`] as seen along `met`, for a camera path that arrives with a density per area.
    pub fn others(&self, emitters: &Emitters, arrived: &Arrived, met: &AdjointInteraction, comes: f64) -> f64 {
        self.met(emitters, arrived, met).others(comes, met.evaluate(arrived.back()).1)
    }
}

impl<'a> Partials<'a> {
    pub fn new(emitters: &'a Emitters<'a>) -> Self {
        Self { emitters, ends: Vec::new(), disks: Vec::new() }
    }

    /// Return the distribution of emission.
    pub fn emitters(&self) -> &'a Emitters<'a> {
        self.emitters
    }

    /// Start a path.
    pub fn set_out(&mut self, path: &Flying, light: &EmissionSample) {
        let departure = self.emitters.of_sample(light);
        let end = LightEnd { partial: Partial::of_light(&departure), departure: Some(departure) };
        // Paths start in order, but some do not start.
        self.ends.resize(path.number as usize, end);
        self.ends.push(end);
    }

    /// Update the partials of a path that arrives at a surface.
    pub fn arrive(&mut self, path: &Flying, arrived: &Arrived) {
        let end = &mut self.ends[path.number as usize];
        let cosine = arrived.cosine(arrived.back());
        end.partial = match end.departure {
            Some(_) => end.partial.arrived_first(cosine),
            None if is_matt(arrived.here.bsdf()) => {
                let disk = self.disks.get(path.number as usize).copied().unwrap_or(0.0);
                end.partial.arrived(arrived.hit.t, cosine).merging(disk)
            }
            None => end.partial.arrived(arrived.hit.t, cosine),
        };
    }

    /// Return the partials of a path.
    pub fn end(&self, path: &Flying) -> &LightEnd {
        &self.ends[path.number as usize]
    }

    /// Update the partials of a path that leaves a surface.
    pub fn go_on(&mut self, path: &Flying, arrived: &Arrived, next: &Onward) {
        let end = &mut self.ends[path.number as usize];
        let cosine = arrived.cosine(next.direction);
        end.partial = if next.is_single {
            end.partial.scattered_singly(cosine)
        } else {
            let met = arrived.met_from(next.direction, 1.0, 0.0);
            let reverse = met.evaluate(arrived.back()).1;
            end.met(self.emitters, arrived, &met).scattered(cosine, next.pdf, reverse)
        };
        end.departure = None;
    }

    /// Clear, and set the merging disks of the next paths, if vertices are merged.
    pub fn begin(&mut self, disks: impl Iterator<Item = f64>) {
        self.ends.clear();
        self.disks.clear();
        self.disks.extend(disks);
    }
}
