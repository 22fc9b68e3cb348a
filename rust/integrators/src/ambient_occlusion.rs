//! Ambient occlusion.

use super::{CameraSample, Integrator, Job, Session, Worker};
use raywright_base::math::{Frame, Hit, Ray};
use raywright_base::sampling::{CAMERA_DIMENSIONS, warp};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{RayOrigin, Scene};

/// Ambient occlusion (Zhukov, Iones and Kronin, "An Ambient Light Illumination Model", 1998; Landis, "Production-Ready
/// Global Illumination", 2002): the share of directions without a nearby hit. The background is white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AmbientOcclusion {
    /// Maximum distance of occluders; infinite counts all.
    pub radius: f64,
    /// Weight directions by their cosine, as uniform light does, or equally.
    pub cosine: bool,
    /// Directions per camera ray; at least 1.
    pub samples: u32,
}

impl Default for AmbientOcclusion {
    fn default() -> Self {
        Self { radius: f64::INFINITY, cosine: true, samples: 1 }
    }
}

impl Integrator for AmbientOcclusion {
    fn begin<'a>(&'a self, job: Job<'a>, _cancel: &Cancel) -> Box<dyn Session + 'a> {
        Box::new(Openness { settings: *self, scene: job.scene })
    }

    fn takes_waves(&self) -> bool {
        true
    }
}

/// Shared data of a session.
struct Openness<'a> {
    settings: AmbientOcclusion,
    scene: &'a Scene,
}

impl Session for Openness<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(Asking {
            settings: self.settings,
            scene: self.scene,
            hits: Vec::new(),
            rays: Vec::new(),
            of: Vec::new(),
            occluded: Vec::new(),
        })
    }
}

struct Asking<'a> {
    settings: AmbientOcclusion,
    scene: &'a Scene,
    hits: Vec<Hit>,
    rays: Vec<Ray>,
    /// Index of each ray's sample.
    of: Vec<u32>,
    occluded: Vec<bool>,
}

impl Worker for Asking<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        let count = self.settings.samples.max(1);
        let part = (4096 / count as usize).max(16);
        for (samples, radiance) in samples.chunks_mut(part).zip(radiance.chunks_mut(part)) {
            if cancel.is_raised() {
                return;
            }
            let rays: Vec<Ray> = samples.iter().map(|s| s.ray).collect();
            self.hits.clear();
            self.hits.resize(rays.len(), Hit::MISS);
            self.scene.intersect(&rays, &mut self.hits);
            self.rays.clear();
            self.of.clear();
            for (i, (sample, ray)) in samples.iter_mut().zip(&rays).enumerate() {
                radiance[i] = if self.hits[i].is_hit() { Rgb::ZERO } else { Rgb::ONE };
                if !self.hits[i].is_hit() {
                    continue;
                }
                let surface = self.scene.geometry().surface(ray, &self.hits[i]);
                let side = -1f64.copysign(ray.direction.dot(surface.normal));
                let frame = Frame::new(surface.normal * side);
                for number in 0..count {
                    let u = sample.sampler.two(CAMERA_DIMENSIONS + number);
                    let local = if self.settings.cosine {
                        warp::cosine_hemisphere(u)
                    } else {
                        let up = warp::uniform_sphere(u);
                        up.with_z(up.z.abs())
                    };
                    let ray = RayOrigin::new(&surface).ray(frame.to_world(local));
                    let misses = [self.hits[i].primitive, Ray::NO_TRIANGLE];
                    self.rays.push(Ray { time: sample.ray.time, t_max: self.settings.radius, misses, ..ray });
                    self.of.push(i as u32);
                }
            }
            self.occluded.resize(self.rays.len(), false);
            self.scene.occluded(&self.rays, &mut self.occluded);
            for (&i, &occluded) in self.of.iter().zip(&self.occluded) {
                if !occluded {
                    radiance[i as usize] += 1.0 / f64::from(count);
                }
            }
        }
    }
}
