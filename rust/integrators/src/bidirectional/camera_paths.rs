//! Camera paths.

use crate::light_paths::{Arrived, Partial};
use crate::nesting::MediumStack;
use crate::terminate_wavelengths::Parting;
use raywright_base::math::{DVec3, Ray, RayQueue};
use raywright_optics::spectra::Waves;
use raywright_optics::{Bsdf, BsdfSample, Rgb};
use raywright_scene::{Footprint, Interaction, LightSampleContext, SurfaceInteraction};

/// The state of a camera path.
#[derive(Clone, Copy)]
pub(super) struct EyePath {
    /// Index of its sample.
    pub sample: u32,
    pub throughput: Rgb,
    /// Ratio of radiance here to radiance at the start of the path due to the index of refraction alone.
    pub scale: f64,
    /// Number of surface bounces.
    pub bounce: u32,
    pub media: MediumStack,
    /// Random number for masks, as in [`crate::skip_intersections::Passing::meet`].
    pub chance: f64,
    /// Width and spread of the ray at its origin.
    pub footprint: Footprint,
    /// True if a surface of the path has a reflectance above 1 in a channel ([`Bsdf::repeat_correction`]).
    pub has_gamut_excess: bool,
    pub partial: Partial,
    /// Merging disk as in [`Partial::merging`]; 0 without merging.
    pub disk: f64,
    /// Normal for light sampling at the last surface.
    pub normal: DVec3,
    /// Wavelengths, `None` for RGB; and true if only the hero is left.
    pub waves: Option<Waves>,
    pub single: bool,
}

impl EyePath {
    /// Return the context of light sampling at the ray's origin, for MIS with lights that the ray hits.
    pub fn receiver(&self, ray: &Ray) -> LightSampleContext {
        LightSampleContext { position: ray.origin, normal: self.normal, waves: self.waves }
    }

    /// Terminate all wavelengths but the hero, which then stands for all.
    pub fn end_all_but_hero(&mut self) {
        if !self.single {
            self.throughput = Waves::ended(self.throughput);
            self.single = true;
        }
    }

    /// Continue along a sampled direction. At a dispersive surface, refraction terminates the secondary
    /// wavelengths, and reflection reweights them.
    pub fn part(&mut self, parting: Option<&Parting>, wo: DVec3, next: &BsdfSample) {
        match parting {
            Some(_) if next.is_through => self.end_all_but_hero(),
            Some(parting) if !self.single => self.throughput *= parting.mirrored(wo),
            _ => {}
        }
    }
}

/// Active paths and their next rays.
#[derive(Default)]
pub(super) struct EyeQueue {
    pub rays: RayQueue,
    pub paths: Vec<EyePath>,
}

impl EyeQueue {
    /// Remove all paths.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.paths.clear();
    }

    /// Append a path and its ray.
    pub fn push(&mut self, ray: &Ray, path: EyePath) {
        self.rays.push(ray);
        self.paths.push(path);
    }
}

/// A vertex of a camera path.
pub(super) struct EyeVertex<'a> {
    /// The interaction of a ray without width, which MIS densities refer to.
    pub arrived: Arrived<'a>,
    /// The interaction of the ray with its width, if that differs.
    pub wide: Option<SurfaceInteraction>,
    /// Media of a transmitted ray.
    pub through: MediumStack,
    /// Wavelength dependence of scattering at this vertex, if the wavelengths are still together.
    pub parting: Option<Parting>,
}

impl EyeVertex<'_> {
    /// Return the interaction of the ray with its width.
    pub fn here(&self) -> &SurfaceInteraction {
        self.wide.as_ref().unwrap_or(&self.arrived.here)
    }

    /// Return the BSDF value for light from a direction, and the density of that direction for a ray without width.
    pub fn evaluate(&self, direction: DVec3) -> (Rgb, f64) {
        let (scattered, pdf) = self.here().evaluate(direction);
        (scattered, if self.wide.is_some() { self.arrived.here.evaluate(direction).1 } else { pdf })
    }

    /// Return true if light from a direction certainly contributes nothing: a cheap test.
    pub fn is_hidden_from(&self, direction: DVec3) -> bool {
        self.here().is_through(direction) && !self.here().bsdf().transmits()
    }

    /// Return the density with which a light path from a direction continues along the camera path.
    pub fn onward_pdf(&self, direction: DVec3) -> f64 {
        self.arrived.met_from(direction, 1.0, 0.0).onward_pdf(self.arrived.back())
    }

    /// Return the media of a ray that leaves in a direction.
    pub fn media(&self, direction: DVec3, path: &EyePath) -> MediumStack {
        if self.here().is_through(direction) { self.through } else { path.media }
    }

    /// Return the ray with this vertex's time, that skips this primitive and `to`.
    pub fn leaving(&self, ray: Ray, to: u32) -> Ray {
        Ray { time: self.arrived.ray.time, misses: [self.arrived.hit.primitive, to], ..ray }
    }
}
