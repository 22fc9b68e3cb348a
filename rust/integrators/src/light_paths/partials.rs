//! What paths of light know of the other ways to find them.

use super::adjoint::{Arrived, Met, Onward};
use super::walk::Flying;
use super::weights::Partial;
use crate::is_matt;
use raywright_scene::{EmissionDensity, EmissionSample, Emitters};

/// That of each path of a batch.
pub(crate) struct Partials<'a> {
    emitters: &'a Emitters<'a>,
    ends: Vec<LightEnd>,
    /// The disk of each path, where paths merge ([`Partial::merging`]).
    disks: Vec<f64>,
}

/// That of one path.
#[derive(Clone, Copy)]
pub(crate) struct LightEnd {
    partial: Partial,
    /// How its light set out, where it has come to its first surface: with which density that would ask for light
    /// depends on who looks.
    departure: Option<EmissionDensity>,
}

impl LightEnd {
    /// What it knows where it has come to by way of other surfaces.
    pub fn partial(&self) -> Partial {
        self.partial
    }

    /// What it knows where it has come to, if somebody meets the point so.
    fn met(&self, emitters: &Emitters, arrived: &Arrived, met: &Met) -> Partial {
        let Some(departure) = &self.departure else { return self.partial };
        let receiver = met.light_context();
        self.partial.asked(emitters.asked_from(&receiver, departure, arrived.ray.direction, arrived.hit.t))
    }

    /// As [`Partial::others`], if somebody meets the point so who comes there with a density, by area.
    pub fn others(&self, emitters: &Emitters, arrived: &Arrived, met: &Met, comes: f64) -> f64 {
        self.met(emitters, arrived, met).others(comes, met.evaluate(arrived.back()).1)
    }
}

impl<'a> Partials<'a> {
    pub fn new(emitters: &'a Emitters<'a>) -> Self {
        Self { emitters, ends: Vec::new(), disks: Vec::new() }
    }

    /// What light that sets out is drawn from.
    pub fn emitters(&self) -> &'a Emitters<'a> {
        self.emitters
    }

    /// Of a path that has set out.
    pub fn set_out(&mut self, path: &Flying, light: &EmissionSample) {
        let departure = self.emitters.of_sample(light);
        let end = LightEnd { partial: Partial::of_light(&departure), departure: Some(departure) };
        // Paths set out in order; some of them do not.
        self.ends.resize(path.number as usize, end);
        self.ends.push(end);
    }

    /// Of a path that has come to a surface.
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

    /// Of a path where it is.
    pub fn end(&self, path: &Flying) -> &LightEnd {
        &self.ends[path.number as usize]
    }

    /// Of a path that goes on from there.
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

    /// Of none: others are to set out, which merge by these disks, if they do.
    pub fn begin(&mut self, disks: impl Iterator<Item = f64>) {
        self.ends.clear();
        self.disks.clear();
        self.disks.extend(disks);
    }
}
