//! Path tracing.

use super::begin_paths::begin;
use super::media::path_reuse;
use super::path_settings::PathSettings;
use super::path_sharing;
use super::{Guiding, Integrator, Job, Session};
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
    /// Guiding of paths at matte surfaces.
    pub guiding: Guiding,
}

impl Default for Path {
    fn default() -> Self {
        Self { max_depth: None, roulette_depth: 4, reuse: 1, guiding: Guiding::None }
    }
}

impl Path {
    /// Return how paths are guided in a scene, as far as known without photons and training. Photons require specular
    /// surfaces, which scenes of the plain variant do not have.
    pub fn guiding_in(&self, scene: &Scene) -> Guiding {
        let needs = scene.plan().needs();
        let may_be = self.max_depth.is_none_or(|depth| depth > 1);
        match self.guiding {
            Guiding::Photons if !needs.scattering => Guiding::None,
            guiding if may_be => guiding,
            _ => Guiding::None,
        }
    }
}

impl Integrator for Path {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let (shares, guiding) = (self.patch(job.scene) > 1, self.guiding_in(job.scene));
        let settings = PathSettings { shares, guiding, ..PathSettings::path(self.max_depth, self.roulette_depth) };
        begin(settings, job, cancel)
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
        if goes_on && (path_sharing::can_share(scene) || path_reuse::can_share(scene)) { self.reuse.max(1) } else { 1 }
    }
}
