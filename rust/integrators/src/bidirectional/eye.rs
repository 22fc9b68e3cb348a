//! Paths from the camera.

use crate::light_paths::{Arrived, Partial};
use crate::nesting::MediumStack;
use crate::parting::Parting;
use raywright_base::math::{DVec3, Ray, RayQueue};
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, BsdfSample, Rgb};
use raywright_scene::{Encounter, Footprint, LightSampleContext, SurfaceInteraction};

/// A path on its way.
#[derive(Clone, Copy)]
pub(super) struct EyePath {
    /// Whose sample it is.
    pub sample: u32,
    pub throughput: Rgb,
    /// How much less radiance is here than where the path started, because of the index of refraction alone.
    pub scale: f64,
    /// Surfaces that it has been scattered at.
    pub bounce: u32,
    pub media: MediumStack,
    /// As [`crate::passing::Passing::meet`] has it.
    pub chance: f64,
    /// How wide the bundle of neighbouring rays is at the ray's origin.
    pub footprint: Footprint,
    /// Whether it has been at a surface that gives more than there is, in a channel ([`Bsdf::again`]).
    pub gilded: bool,
    pub partial: Partial,
    /// As [`Partial::merging`] has it, 0 where paths do not merge.
    pub disk: f64,
    /// The normal that lights were drawn by where it was scattered last.
    pub normal: DVec3,
    /// Its wavelengths; none for red, green and blue. And whether the first is all that it carries.
    pub waves: Option<Waves>,
    pub single: bool,
}

impl EyePath {
    /// What light that comes upon its ray would have been asked for from.
    pub fn receiver(&self, ray: &Ray) -> LightSampleContext {
        LightSampleContext { position: ray.origin, normal: self.normal, waves: self.waves }
    }

    /// Leaves the hero of its wavelengths alone, which stands for all from here on.
    pub fn end_all_but_hero(&mut self) {
        if !self.single {
            self.throughput = Waves::ended(self.throughput);
            self.single = true;
        }
    }

    /// It goes on along a direction drawn at a surface that parts wavelengths, if they have come together so far.
    pub fn part(&mut self, parting: Option<&Parting>, wo: DVec3, next: &BsdfSample) {
        match parting {
            Some(_) if next.is_through => self.end_all_but_hero(),
            Some(parting) if !self.single => self.throughput *= parting.mirrored(wo),
            _ => {}
        }
    }
}

/// Paths that go on, and the ray that each is about to follow.
#[derive(Default)]
pub(super) struct EyeQueue {
    pub rays: RayQueue,
    pub paths: Vec<EyePath>,
}

impl EyeQueue {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.paths.clear();
    }

    /// A path and its ray.
    pub fn push(&mut self, ray: &Ray, path: EyePath) {
        self.rays.push(ray);
        self.paths.push(path);
    }
}

/// Where a path from the camera has come to.
pub(super) struct EyeVertex<'a> {
    /// As rays without width meet it: densities that are compared are those.
    pub arrived: Arrived<'a>,
    /// As it is seen, if that differs.
    pub wide: Option<SurfaceInteraction>,
    /// What a ray that goes through is in.
    pub through: MediumStack,
    /// What parts wavelengths where a path goes on, if it has not parted them already.
    pub parting: Option<Parting>,
}

impl EyeVertex<'_> {
    /// As it is seen.
    pub fn here(&self) -> &SurfaceInteraction {
        self.wide.as_ref().unwrap_or(&self.arrived.here)
    }

    /// How much light from a direction it scatters along the path, and with which density a ray without width is
    /// scattered there.
    pub fn evaluate(&self, direction: DVec3) -> (Rgb, f64) {
        let (scattered, pdf) = self.here().evaluate(direction);
        (scattered, if self.wide.is_some() { self.arrived.here.evaluate(direction).1 } else { pdf })
    }

    /// Whether light from a direction cannot be scattered along the path, to be told at once.
    pub fn is_hidden_from(&self, direction: DVec3) -> bool {
        self.here().is_through(direction) && !self.here().bsdf().transmits()
    }

    /// The density with which light from a direction goes on along the path.
    pub fn onward_pdf(&self, direction: DVec3) -> f64 {
        self.arrived.met_from(direction, 1.0, 0.0).onward_pdf(self.arrived.back())
    }

    /// What a ray that leaves in a direction is in.
    pub fn media(&self, direction: DVec3, path: &EyePath) -> MediumStack {
        if self.here().is_through(direction) { self.through } else { path.media }
    }

    /// The ray that leaves as another has it.
    pub fn leaving(&self, ray: Ray, to: u32) -> Ray {
        Ray { time: self.arrived.ray.time, misses: [self.arrived.hit.primitive, to], ..ray }
    }
}
