//! Light transport as stages over columns of paths, after pbrt-v4's wavefront (Pharr, Jakob and Humphreys, "Physically
//! Based Rendering", 4th ed., 2023, chapter 15): all paths of a batch take each step together.
//!
//! A stage reads columns and writes columns. No stage knows the next; [`worker`] lists them.

mod adjoint_stages;
mod branch_stages;
mod branches;
mod bsdf_block;
mod bsdf_stages;
mod camera_stages;
mod direct_light;
mod emission;
mod flights;
mod groups;
mod guided;
mod light_in_f64;
mod mask_stages;
mod masks;
mod matte;
mod matte_stages;
mod media;
mod media_sharing;
mod media_sharing_stages;
mod media_stages;
mod medium_stacks;
mod path_block;
mod phase_stages;
mod queues;
mod shading_frames;
mod subpath_stages;
mod subpaths;
mod transmittance_stages;
mod waves;
mod waves_stages;
mod ways;
mod worker;

pub(super) use subpath_stages::{Limits, SubpathEmission, SubpathWavefront, Times};
pub(super) use subpaths::{Arrival, Connection, Subpath, SubpathSink, VertexContext};

use super::known_light::KnownLight;
use super::path_settings::PathSettings;
use super::{Guide, Job, Session, Worker};
use raywright_scene::Scene;
use std::sync::Arc;
use worker::WavefrontWorker;

/// Path tracing by stages.
pub(super) struct Wavefront<'a> {
    job: Job<'a>,
    settings: PathSettings,
    /// Guide to light through specular surfaces, if paths are guided and there is any.
    guide: Option<Arc<Guide>>,
    /// Known light at matte surfaces and in media, if any.
    known: Option<Arc<dyn KnownLight + 'a>>,
    /// True if light is drawn in f64.
    takes_f64: bool,
}

/// Radiances that f32 holds, with the squares of numbers that follow from them.
const RADIANCES: std::ops::Range<f64> = 1e-15..1e15;

/// Sizes of scenes whose products of three lengths f32 holds, even for a lamp a thousandth as large.
const SIZES: std::ops::Range<f64> = 1e-9..1e12;

impl<'a> Wavefront<'a> {
    /// Paths of a picture, which may be guided, and end where light is known.
    pub fn new(
        job: Job<'a>,
        settings: PathSettings,
        guide: Option<Arc<Guide>>,
        known: Option<Arc<dyn KnownLight + 'a>>,
    ) -> Self {
        let takes_f64 = !f32_holds(job.scene);
        let shares = settings.shares && !takes_f64;
        Self { job, settings: PathSettings { shares, ..settings }, guide, known, takes_f64 }
    }

    /// The same, with light that is drawn in f64.
    #[cfg(test)]
    pub fn with_light_in_f64(self) -> Self {
        Self { takes_f64: true, ..self }
    }
}

/// Return whether f32 holds the radiances of a scene, and products of its lengths. Elsewhere light is drawn in f64, and
/// paths are neither guided nor share.
pub(super) fn f32_holds(scene: &Scene) -> bool {
    let size = scene.region().radius;
    // Infinite planes tell no size.
    let is_usual = size == 0.0 || !size.is_finite() || SIZES.contains(&size);
    is_usual && scene.lights().radiances().all(|radiance| radiance == 0.0 || RADIANCES.contains(&radiance))
}

impl Session for Wavefront<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        let (guide, known) = (self.guide.as_deref(), self.known.as_deref());
        Box::new(WavefrontWorker::new(&self.job, self.settings, (guide, known), self.takes_f64))
    }
}
