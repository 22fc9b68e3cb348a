//! Volumetric path tracing: camera paths (`walker`) in batches (`asking`, `together`), light paths (`light_walk`,
//! `to_camera`), and bidirectional paths (`both_ends`).
//!
//! Paths carry densities for three wavelengths. One of them, the hero, samples distances. All are weighted by the mean
//! of the three densities (Wilkie et al., "Hero Wavelength Spectral Sampling", 2014; Miller, Georgiev and Jarosz, "A
//! Null-Scattering Path Integral Formulation of Light Transport", 2019).

mod batch_executor;
mod camera_paths;
mod direct_light;
mod equiangular;
mod final_gather;
mod light_partials;
mod light_walk;
mod medium_traversal;
mod optical_depth;
mod path_state;
mod precomputed_light;
mod scattering;
mod to_camera;
mod vertex;
mod volumetric_bdpt;

pub(super) use crate::media::current_medium::Filled;
pub(super) use crate::media::hit_classification::{ClassifiedHit, meet};
pub(super) use crate::media::path_numbers::PathNumbers;
pub(super) use crate::media::path_reuse::can_share;
pub(super) use light_walk::{Drifting, MediaLightWalk, MediaVisitor};
pub use optical_depth::optical_depths;
pub(super) use precomputed_light::KnownLight;
pub(super) use scattering::Scattering;
pub(super) use to_camera::{Counting, MediaLightPaths};
pub(super) use vertex::{Point, Vertex};
pub(super) use volumetric_bdpt::BothEnds;

use super::media::equiangular::PointLights;
use super::transport::Gather;
use super::{Job, Session, Worker};
use camera_paths::Walkers;
use raywright_optics::Rgb;
use raywright_scene::{Footprint, Scene};
use std::sync::Arc;

/// The scattered directions that paths follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Onwards {
    /// All directions.
    All,
    /// Delta directions only, each of them: paths are split.
    DeltaLobes,
}

/// Parameters of volumetric path tracing.
#[derive(Clone, Copy, Debug)]
pub(super) struct VolumetricPath {
    /// Maximum number of scattering events, at surfaces or in media.
    pub max_depth: Option<u32>,
    /// Number of scattering events after which Russian roulette starts.
    pub roulette_depth: u32,
    /// False if media only absorb: scattered light is lost.
    pub scatters: bool,
    /// Number of light samples at the first surface, and of paths that continue from there.
    pub light_samples: u32,
    pub splits: u32,
    /// Directions that are followed.
    pub onwards: Onwards,
    /// Uniform radiance that replaces light not followed, where it is scattered diffusely.
    pub ambient: Rgb,
    /// Minimum contribution of a path in any color; others end.
    pub least: f64,
    /// Use of precomputed light at matte surfaces and in media, which [`VolumetricPath::begin_with`] receives. `None`
    /// continues paths there.
    pub gather: Option<Gather>,
}

impl VolumetricPath {
    /// Return the parameters of a path tracer.
    pub fn path(max_depth: Option<u32>, roulette_depth: u32) -> Self {
        Self {
            max_depth,
            roulette_depth,
            scatters: true,
            light_samples: 1,
            splits: 1,
            onwards: Onwards::All,
            ambient: Rgb::ZERO,
            least: 0.0,
            gather: None,
        }
    }

    /// Return the parameters for integrators that scatter at surfaces only, where media just attenuate.
    pub fn dimmed(max_depth: u32) -> Self {
        Self { scatters: false, ..Self::path(Some(max_depth), u32::MAX) }
    }

    /// Begin a session for a picture.
    pub fn begin<'a>(self, job: Job<'a>) -> Box<dyn Session + 'a> {
        self.among(job, None)
    }

    /// Begin a session with precomputed light at scattering events.
    pub fn begin_with<'a>(self, job: Job<'a>, known: Arc<dyn KnownLight + 'a>) -> Box<dyn Session + 'a> {
        self.among(job, Some(known))
    }

    fn among<'a>(self, job: Job<'a>, known: Option<Arc<dyn KnownLight + 'a>>) -> Box<dyn Session + 'a> {
        let points = PointLights::of(job.scene);
        Box::new(Among { settings: self, scene: job.scene, footprint: job.footprint, points, known })
    }
}

/// Data shared by the workers of a picture.
struct Among<'a> {
    settings: VolumetricPath,
    scene: &'a Scene,
    /// Footprint of camera rays.
    footprint: Footprint,
    /// Point lights.
    points: PointLights<'a>,
    /// Precomputed light at scattering events.
    known: Option<Arc<dyn KnownLight + 'a>>,
}

impl Session for Among<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(Walkers::new(self.settings, (self.scene, self.footprint), &self.points, self.known.as_deref()))
    }
}
