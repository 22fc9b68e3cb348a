//! Shading of a face at a film position.

use super::beam::Beam;
use crate::Job;
use raywright_base::math::{DVec2, DVec3, Hit, Ray};
use raywright_optics::{BsdfSample, Rgb};
use raywright_scene::{Interaction, SurfaceInteraction};

/// The intersection of a film position's ray with a face.
pub(super) struct FilmHit {
    ray: Ray,
    hit: Hit,
    width: f64,
    pub here: SurfaceInteraction,
}

impl FilmHit {
    /// Intersect a beam's ray with a face of given nearness.
    pub fn new(job: &Job, beam: &Beam, primitive: u32, nearness: DVec3, at: DVec2) -> Self {
        let geometry = job.scene.geometry();
        let (ray, t) = beam.ray(at, nearness);
        let hit = Hit { t, uv: geometry.weights(primitive, ray.at(t)), primitive, inner: 0 };
        let width = if job.scene.plan().needs().points.width { job.footprint.at(t).width } else { 0.0 };
        let surface = geometry.surface(&ray, &hit);
        Self { ray, hit, width, here: SurfaceInteraction::new(job.scene, &ray, &hit, surface, width, 1.0) }
    }

    /// Return the reflected radiance of the lights whose bits are set, and of uniform light.
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

    /// Visit each delta direction.
    pub fn single_directions(&self, mut each: impl FnMut(BsdfSample)) {
        self.here.bsdf().delta_lobes(self.here.wo(), |single| {
            if let Some(single) = self.here.to_world(single) {
                each(single);
            }
        });
    }

    /// Return the specular reflectance or the straight transmittance.
    pub fn share(&self, is_through: bool) -> Rgb {
        let mut share = Rgb::ZERO;
        self.single_directions(|single| {
            share += if single.is_through == is_through { single.weight } else { Rgb::ZERO }
        });
        share
    }
}
