//! Light transport as stages over columns of paths, after pbrt-v4's wavefront (Pharr, Jakob and Humphreys, "Physically
//! Based Rendering", 4th ed., 2023, chapter 15): all paths of a batch take each step together.
//!
//! A stage reads columns and writes columns. No stage knows the next; [`worker`] lists them.

mod adjoint_stages;
mod branch_stages;
mod branches;
mod bsdf_block;
mod bsdf_stages;
mod direct_light;
mod emission;
mod flights;
mod groups;
mod guided;
mod mask_stages;
mod masks;
mod matte;
mod matte_stages;
mod media;
mod media_sharing;
mod media_sharing_stages;
mod media_stages;
mod medium_stacks;
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
use super::{Guide, Job, Session, Worker, narrow_views};
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
}

/// Radiances that f32 holds, with the squares of numbers that follow from them.
const RADIANCES: std::ops::Range<f64> = 1e-15..1e15;

/// Sizes of scenes in which f32 holds the products of three lengths, also where a lamp is a thousandth of the scene.
const SIZES: std::ops::Range<f64> = 1e-9..1e12;

impl<'a> Wavefront<'a> {
    /// Paths of a picture, which may be guided, and end where light is known.
    pub fn new(
        job: Job<'a>,
        settings: PathSettings,
        guide: Option<Arc<Guide>>,
        known: Option<Arc<dyn KnownLight + 'a>>,
    ) -> Self {
        Self { job, settings, guide, known }
    }

    /// Return whether f32 holds the radiances and lengths of a scene, and tells the pixels of its picture apart.
    pub fn takes(job: &Job<'_>) -> bool {
        let mut radiances = job.scene.lights().radiances();
        let size = job.scene.region().radius;
        // Infinite planes tell no size.
        let is_usual = size == 0.0 || !size.is_finite() || SIZES.contains(&size);
        is_usual
            && narrow_views::are_wide_enough(job)
            && radiances.all(|radiance| radiance == 0.0 || RADIANCES.contains(&radiance))
    }
}

impl Session for Wavefront<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(WavefrontWorker::new(&self.job, self.settings, self.guide.as_deref(), self.known.as_deref()))
    }
}
