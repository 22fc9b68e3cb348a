//! Camera paths.

use crate::light_paths::Partial;
use crate::media::medium_traversal::{LeftDepth, MediumTraversal, RaySegmentState};
use raywright_base::math::{DVec3, RayQueue};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use raywright_scene::{Footprint, LightSampleContext};

/// The state of a camera path.
#[derive(Clone, Copy)]
pub(super) struct EyePath {
    /// Index of its sample.
    pub sample: u32,
    pub going: RaySegmentState,
    pub left: LeftDepth,
    /// Ratio of radiance here to radiance at the start of the path due to the index of refraction alone.
    pub scale: f64,
    /// Number of scattering events.
    pub bounce: u32,
    /// Footprint at the ray's origin.
    pub footprint: Footprint,
    /// True if a surface of the path has a reflectance above 1 in a channel
    /// ([`raywright_optics::Bsdf::repeat_correction`]).
    pub has_gamut_excess: bool,
    pub partial: Partial,
    /// Merging disk as in [`Partial::merging`]; 0 without merging.
    pub disk: f64,
    /// Normal for light sampling at the last scattering event.
    pub normal: DVec3,
    /// Wavelengths, `None` for RGB; and true if only the first is left.
    pub waves: Option<Waves>,
    pub single: bool,
}

impl EyePath {
    pub fn throughput(&self) -> Rgb {
        self.going.weights.throughput()
    }

    /// Return the context of light sampling at the ray's origin, for MIS with lights that the ray hits.
    pub fn receiver(&self) -> LightSampleContext {
        LightSampleContext { position: self.going.ray.origin, normal: self.normal, waves: self.waves }
    }

    /// Return the wavelengths for traversing media; one alone if the light carries only one.
    pub fn waves_with(&self, single: bool) -> Option<Waves> {
        if single || self.single { self.waves.map(|waves| waves.alone()) } else { self.waves }
    }

    /// Terminate all wavelengths but the first, which then stands for all.
    pub fn end_all_but_first(&mut self) {
        if !self.single {
            self.going.weights.end_all_but_first();
            self.single = true;
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
    pub fn push(&mut self, course: &MediumTraversal<'_>, path: &EyePath) {
        self.rays.push(&course.next_ray(&path.going, &path.left, false));
        self.paths.push(*path);
    }
}
