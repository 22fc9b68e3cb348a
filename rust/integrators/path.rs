//! Path tracing.

use super::{CameraSample, Integrator, Worker};
use crate::math::{Hit, Ray};
use crate::optics::Rgb;
use crate::sampling::{CAMERA_DIMENSIONS, Sampler};
use crate::scene::{Interaction, Scene};
use crate::workers::Cancel;

/// Unidirectional path tracing (Kajiya, "The Rendering Equation", 1986): at each bounce one light is asked directly,
/// which is combined with running into lights by chance through multiple importance sampling (Veach and Guibas,
/// "Optimally Combining Sampling Techniques", 1995), and Russian roulette ends paths (Arvo and Kirk, 1990).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path {
    /// The greatest number of bounces off surfaces; 0 shows only what shines itself. `None` is all of them.
    pub max_depth: Option<u32>,
    /// Roulette is played from this number of bounces on.
    pub roulette_depth: u32,
}

impl Default for Path {
    fn default() -> Self {
        Self { max_depth: None, roulette_depth: 3 }
    }
}

impl Path {
    /// Bounces after which roulette is played whatever was asked, so that every path ends.
    const ROULETTE_AT_LATEST: u32 = 4096;

    /// The greatest probability to survive a round. A path in a closed box of albedo 1 thus ends after some four
    /// thousand bounces, and up to albedo 0.9998 it is never asked to survive less often than its throughput says.
    const SURVIVAL: f64 = 1.0 - 1.0 / 4096.0;

    /// The probability that a path of this throughput survives.
    ///
    /// Dividing by it must not let the throughput grow from round to round: after k rounds of reflectance ρ and
    /// survival q the second moment is (ρ²/q)ᵏ, whose sum over k is finite only for q > ρ². Any fixed bound like the
    /// usual 0.95 breaks that in bright surroundings, and with it the error bar. The throughput itself as q gives ρ²/q = ρ.
    #[inline]
    fn survival(throughput: Rgb) -> f64 {
        throughput.max_element().min(Self::SURVIVAL)
    }
}

impl Integrator for Path {
    fn worker<'a>(&'a self, scene: &'a Scene) -> Box<dyn Worker + 'a> {
        Box::new(PathWorker {
            path: self,
            scene,
            rays: Vec::new(),
            alive: Vec::new(),
            hits: Vec::new(),
            shadow_rays: Vec::new(),
            unshadowed: Vec::new(),
            occluded: Vec::new(),
        })
    }
}

/// A path on its way.
#[derive(Clone, Copy)]
struct Alive {
    throughput: Rgb,
    /// Density with which the last surface drew this direction; infinite for a camera's ray.
    pdf: f64,
    /// Density with which the lights would have drawn it, should it leave the scene.
    environment_pdf: f64,
    /// Whose sample it is.
    sample: u32,
}

struct PathWorker<'a> {
    path: &'a Path,
    scene: &'a Scene,
    /// The paths that go on, and the ray that each is about to follow.
    rays: Vec<Ray>,
    alive: Vec<Alive>,
    hits: Vec<Hit>,
    /// What would arrive at a sample if nothing lies on the way.
    shadow_rays: Vec<Ray>,
    unshadowed: Vec<(u32, Rgb)>,
    occluded: Vec<bool>,
}

/// The dimensions of a bounce. The choice among several kinds of scattering comes last, as most surfaces have one.
#[derive(Clone, Copy)]
struct Dimensions(u32);

impl Dimensions {
    const EACH: u32 = 6;

    fn of_bounce(bounce: u32) -> Self {
        // Wrapping after 700 million bounces harms nobody.
        Self(CAMERA_DIMENSIONS.wrapping_add(bounce.wrapping_mul(Self::EACH)))
    }
    fn light_choice(self) -> u32 {
        self.0
    }
    fn light_point(self) -> u32 {
        self.0 + 1
    }
    fn direction(self) -> u32 {
        self.0 + 2
    }
    fn roulette(self) -> u32 {
        self.0 + 3
    }
    fn scattering_choice(self) -> u32 {
        self.0 + 4
    }
}

impl Worker for PathWorker<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        assert_eq!(samples.len(), radiance.len());
        radiance.fill(Rgb::ZERO);
        self.rays.clear();
        self.rays.extend(samples.iter().map(|s| s.ray));
        self.alive.clear();
        self.alive.extend((0..samples.len() as u32).map(|sample| Alive {
            throughput: Rgb::ONE,
            pdf: f64::INFINITY,
            environment_pdf: 0.0,
            sample,
        }));
        let mut bounce = 0;
        while !self.rays.is_empty() && !cancel.is_raised() {
            self.hits.resize(self.rays.len(), Hit::MISS);
            self.scene.intersect(&self.rays, &mut self.hits);
            self.shade(bounce, samples, radiance);
            self.gather(radiance);
            bounce += 1;
        }
    }
}

impl PathWorker<'_> {
    /// Adds what paths have run into, sends shadow rays, and takes the paths that go on to the front of the queue.
    fn shade(&mut self, bounce: u32, samples: &mut [CameraSample], radiance: &mut [Rgb]) {
        self.shadow_rays.clear();
        self.unshadowed.clear();
        let last = self.path.max_depth.is_some_and(|depth| bounce >= depth);
        let mut kept = 0;
        for i in 0..self.rays.len() {
            let (ray, path, hit) = (self.rays[i], self.alive[i], self.hits[i]);
            let arriving = &mut radiance[path.sample as usize];
            if !hit.is_hit() {
                let weight = power_heuristic(path.pdf, path.environment_pdf);
                *arriving += path.throughput * self.scene.lights().environment(ray.direction) * weight;
                continue;
            }
            let surface = self.scene.geometry().surface(&hit);
            let emission = self.scene.lights().emission(surface.shape);
            let cosine = -ray.direction.dot(surface.normal);
            if emission != Rgb::ZERO && cosine > 0.0 {
                let light_pdf =
                    self.scene.lights().surface_pdf(self.scene.geometry(), surface.shape, hit.primitive, hit.t, cosine);
                *arriving += path.throughput * emission * power_heuristic(path.pdf, light_pdf);
            }
            if last {
                continue;
            }
            let here = Interaction::new(self.scene, &ray, surface);
            let sampler = &mut samples[path.sample as usize].sampler;
            self.ask_a_light(&here, &path, Dimensions::of_bounce(bounce), sampler);
            if let Some((ray, path)) = self.scatter(&here, path, bounce, sampler) {
                self.rays[kept] = ray;
                self.alive[kept] = path;
                kept += 1;
            }
        }
        self.rays.truncate(kept);
        self.alive.truncate(kept);
    }

    /// Next-event estimation: draws light and queues the shadow ray.
    #[inline]
    fn ask_a_light(&mut self, here: &Interaction, path: &Alive, dimensions: Dimensions, sampler: &mut Sampler) {
        if self.scene.lights().is_dark() {
            return;
        }
        let Some(light) = self.scene.lights().sample(
            self.scene.geometry(),
            here.position(),
            here.shading_normal(),
            sampler.one(dimensions.light_choice()),
            sampler.two(dimensions.light_point()),
        ) else {
            return;
        };
        let (scattered, pdf) = here.evaluate(light.direction);
        let arriving = path.throughput * scattered * light.weight * power_heuristic(light.pdf, pdf);
        if arriving != Rgb::ZERO {
            let from = here.departure();
            self.shadow_rays.push(match &light.source {
                Some(source) => from.segment(source),
                None => from.ray(light.direction),
            });
            self.unshadowed.push((path.sample, arriving));
        }
    }

    /// Draws where the path goes on to, if it does.
    #[inline]
    fn scatter(&self, here: &Interaction, mut path: Alive, bounce: u32, sampler: &mut Sampler) -> Option<(Ray, Alive)> {
        let dimensions = Dimensions::of_bounce(bounce);
        let u = sampler.two(dimensions.direction());
        let next = here.sample(|| sampler.one(dimensions.scattering_choice()), u)?;
        path.throughput *= next.weight;
        path.pdf = next.pdf;
        path.environment_pdf = self.scene.lights().environment_pdf(here.shading_normal(), next.direction);
        if bounce + 1 >= self.path.roulette_depth.min(Path::ROULETTE_AT_LATEST) {
            let survival = Path::survival(path.throughput);
            if sampler.one(dimensions.roulette()) >= survival {
                return None;
            }
            path.throughput /= survival;
        }
        Some((here.departure().ray(next.direction), path))
    }

    /// Adds the light of shadow rays that meet nothing.
    fn gather(&mut self, radiance: &mut [Rgb]) {
        self.occluded.resize(self.shadow_rays.len(), false);
        self.scene.occluded(&self.shadow_rays, &mut self.occluded);
        for (&(sample, arriving), &occluded) in self.unshadowed.iter().zip(&self.occluded) {
            if !occluded {
                radiance[sample as usize] += arriving;
            }
        }
    }
}

/// The weight of a draw of one technique, of density `pdf`, beside another of density `other`
/// (Veach and Guibas, 1995, with the exponent 2). Written by the ratio, squares cannot overflow, and an infinite
/// density gets the weight 1.
#[inline]
fn power_heuristic(pdf: f64, other: f64) -> f64 {
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
}
