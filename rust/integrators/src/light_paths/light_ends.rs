//! MIS partials of light paths.

use super::mis_weights::Partial;
use crate::path_vertices::{ConnectedVertex, Onward, Vertex};
use raywright_scene::{EmissionDensity, EmissionSample, Emitters};

/// MIS partials of each path of a batch.
pub(crate) struct LightEnds<'a> {
    emitters: &'a Emitters<'a>,
    ends: Vec<LightEnd>,
    /// Merging disk of each path, if vertices are merged ([`Partial::merging`]).
    disks: Vec<f64>,
}

/// MIS partials of one path at a vertex.
#[derive(Clone, Copy)]
pub(crate) struct LightEnd {
    partial: Partial,
    /// Emission density, at the first vertex only: the density of light sampling there depends on the viewer.
    departure: Option<EmissionDensity>,
}

impl LightEnd {
    /// Return the partials at a vertex after the first.
    pub fn partial(&self) -> Partial {
        self.partial
    }

    /// Return the partials at the vertex as seen along `met`.
    fn met(&self, emitters: &Emitters, at: &Vertex, met: &ConnectedVertex) -> Partial {
        let Some(departure) = &self.departure else { return self.partial };
        self.partial.asked(emitters.asked_from(&met.receiver, departure, at.ray.direction, at.t))
    }

    /// Return [`Partial::others`] as seen along `met`, for a camera path that arrives with a density.
    pub fn others(&self, emitters: &Emitters, at: &Vertex, met: &ConnectedVertex, comes: f64) -> f64 {
        self.met(emitters, at, met).others(comes, met.back)
    }
}

impl<'a> LightEnds<'a> {
    pub fn new(emitters: &'a Emitters<'a>) -> Self {
        Self { emitters, ends: Vec::new(), disks: Vec::new() }
    }

    /// Return the distribution of emission.
    pub fn emitters(&self) -> &'a Emitters<'a> {
        self.emitters
    }

    /// Clear, and set the merging disks of the next paths, if vertices are merged.
    pub fn begin(&mut self, disks: impl Iterator<Item = f64>) {
        self.ends.clear();
        self.disks.clear();
        self.disks.extend(disks);
    }

    /// Start a path. Paths start in the order of their numbers, but some do not start.
    pub fn set_out(&mut self, path: u32, light: &EmissionSample) {
        let departure = self.emitters.of_sample(light);
        let end = LightEnd { partial: Partial::of_light(&departure), departure: Some(departure) };
        self.ends.resize(path as usize, end);
        self.ends.push(end);
    }

    /// Update the partials of a path that arrives at a vertex.
    pub fn arrive(&mut self, path: u32, at: &Vertex) {
        let end = &mut self.ends[path as usize];
        let cosine = at.cosine(at.back());
        end.partial = match end.departure {
            Some(_) => end.partial.arrived_first(cosine),
            None if !self.disks.is_empty() && at.matte().is_some() => {
                end.partial.arrived(at.t, cosine).merging(self.disks[path as usize])
            }
            None => end.partial.arrived(at.t, cosine),
        };
    }

    /// Return the partials of a path.
    pub fn end(&self, path: u32) -> &LightEnd {
        &self.ends[path as usize]
    }

    /// Update the partials of a path that leaves a vertex.
    pub fn go_on(&mut self, path: u32, at: &Vertex, next: &Onward) {
        let end = &mut self.ends[path as usize];
        let cosine = at.cosine(next.direction);
        end.partial = if next.is_single {
            end.partial.scattered_singly(cosine)
        } else {
            let met = at.met_from(next.direction, 1.0);
            end.met(self.emitters, at, &met).scattered(cosine, next.pdf, met.back)
        };
        end.departure = None;
    }
}
