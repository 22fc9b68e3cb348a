//! What light a place on the film shows of a face.

use super::beam::Beam;
use crate::Job;
use raywright_base::math::{DVec2, DVec3, Hit, Ray};
use raywright_optics::{BsdfSample, Rgb};
use raywright_scene::{Encounter, SurfaceInteraction};

/// Where the ray through a place on the film meets a face.
pub(super) struct Met {
    ray: Ray,
    hit: Hit,
    width: f64,
    pub here: SurfaceInteraction,
}

impl Met {
    /// Looks up what a beam's ray meets on a face of this nearness.
    pub fn new(job: &Job, beam: &Beam, primitive: u32, nearness: DVec3, at: DVec2) -> Self {
        let geometry = job.scene.geometry();
        let (ray, t) = beam.ray(at, nearness);
        let hit = Hit { t, uv: geometry.weights(primitive, ray.at(t)), primitive, inner: 0 };
        let width = if job.scene.plan().needs().points.width { job.footprint.at(t).width } else { 0.0 };
        let surface = geometry.surface(&ray, &hit);
        Self { ray, hit, width, here: SurfaceInteraction::new(job.scene, &ray, &hit, surface, width, 1.0) }
    }

    /// What is sent back of the light of those of the scene's lights whose bits are set, and of an even light.
    pub fn light(&self, job: &Job, lit: u64, ambient: Rgb) -> Rgb {
        let mut light = Rgb::ZERO;
        if !ambient.is_black() {
            light += self.here.ambient(job.scene, &self.ray, &self.hit, self.width, 1.0) * ambient;
        }
        let receiver = self.here.light_context();
        for (number, lamp) in job.scene.lights().others().enumerate() {
            if lit >> number & 1 == 1
                && let Some(drawn) = lamp.sample(&receiver, [0.5; 2])
            {
                light += self.here.evaluate(drawn.direction).0 * drawn.weight;
            }
        }
        light
    }

    /// Calls with each single direction that light is scattered into.
    pub fn single_directions(&self, mut each: impl FnMut(BsdfSample)) {
        self.here.bsdf().delta_lobes(self.here.wo(), |single| {
            if let Some(single) = self.here.to_world(single) {
                each(single);
            }
        });
    }

    /// What of light is thrown back as by a mirror, or goes straight through.
    pub fn share(&self, is_through: bool) -> Rgb {
        let mut share = Rgb::ZERO;
        self.single_directions(|single| {
            share += if single.is_through == is_through { single.weight } else { Rgb::ZERO }
        });
        share
    }
}
