//! Path tracing.

use super::transport::{Settings, can_share};
use super::volumes::{self, VolumetricPath};
use super::wavefront::Wavefront;
use super::{Integrator, Job, Session};
use raywright_base::workers::Cancel;
use raywright_scene::Scene;

/// Unidirectional path tracing (Kajiya, "The Rendering Equation", 1986). Each bounce samples one light, combined with
/// BSDF sampling by multiple importance sampling (Veach and Guibas, "Optimally Combining Sampling Techniques", 1995).
/// Russian roulette terminates paths (Arvo and Kirk, 1990).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path {
    /// Maximum number of surface bounces; 0 shows only emission. `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Number of bounces after which Russian roulette starts.
    pub roulette_depth: u32,
    /// Side of the square pixel blocks that reuse paths, from their second surface on. Both this and the first surface
    /// must be diffuse, or both vertices must be points of one homogeneous medium. 1 disables reuse
    /// ([`Integrator::patch`]).
    pub reuse: u32,
    /// Guide paths at matte surfaces toward light through mirrors and glass ([`super::Guide`]).
    pub caustics: bool,
}

impl Default for Path {
    fn default() -> Self {
        Self { max_depth: None, roulette_depth: 4, reuse: 1, caustics: false }
    }
}

impl Path {
    fn settings(&self, scene: &Scene) -> Settings {
        let (shares, guided) = (self.patch(scene) > 1, self.is_guided(scene));
        Settings { shares, guided, ..Settings::path(self.max_depth, self.roulette_depth) }
    }

    /// Return whether paths are guided in a scene, as far as known without photons. Guiding requires specular surfaces,
    /// which scenes of the plain variant do not have, and light beyond them. Paths in media and spectral paths are
    /// never guided.
    pub fn is_guided(&self, scene: &Scene) -> bool {
        self.caustics
            && self.max_depth.is_none_or(|depth| depth > 1)
            && scene.plan().needs().scattering
            && !scene.plan().needs().media
            && !scene.plan().needs().waves
    }

    /// Begin a session as [`Integrator::begin`] does, by the loop in f64 that knows everything, without sharing.
    pub fn begin_in_general<'a>(&self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        self.settings(job.scene).begin_in_general(job, cancel)
    }
}

impl Integrator for Path {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        if job.scene.plan().needs().media && !Wavefront::takes(&job) {
            return VolumetricPath::path(self.max_depth, self.roulette_depth).begin(job);
        }
        self.settings(job.scene).begin(job, cancel)
    }

    fn takes_media(&self) -> bool {
        true
    }

    fn takes_waves(&self) -> bool {
        true
    }

    /// 1 if paths cannot be reused, or none continues from its second surface.
    fn patch(&self, scene: &Scene) -> u32 {
        let goes_on = self.max_depth.is_none_or(|depth| depth > 1);
        if goes_on && (can_share(scene) || volumes::can_share(scene)) { self.reuse.max(1) } else { 1 }
    }
}
