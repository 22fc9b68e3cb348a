//! Path tracing.

use super::transport::{Settings, can_share};
use super::volumes::{self, Volumes};
use super::{Integrator, Job, Session};
use raywright_base::workers::Cancel;
use raywright_scene::{Scene, ShadingVariant};

/// Unidirectional path tracing (Kajiya, "The Rendering Equation", 1986): at each bounce one light is asked directly,
/// which is combined with running into lights by chance through multiple importance sampling (Veach and Guibas,
/// "Optimally Combining Sampling Techniques", 1995), and Russian roulette ends paths (Arvo and Kirk, 1990).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path {
    /// The greatest number of bounces off surfaces; 0 shows only what shines itself. `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Roulette is played from this number of bounces on.
    pub roulette_depth: u32,
    /// The side of the square patches of pixels whose paths share what they find from their second surface on, where
    /// both that and the first are diffuse, or where both are points of one even medium; 1 for none
    /// ([`Integrator::patch`]).
    pub reuse: u32,
    /// Whether matt surfaces draw directions also from where light comes by way of mirrors and glass
    /// ([`super::Guide`]).
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

    /// Whether it is guided in a scene, as far as can be told without photons. There must be something sharp, and light
    /// beyond it: scenes of the plain variant have nothing sharp. Among media no path is, nor one
    /// of wavelengths.
    pub fn is_guided(&self, scene: &Scene) -> bool {
        self.caustics
            && self.max_depth.is_none_or(|depth| depth > 1)
            && scene.plan().needs().scattering
            && !scene.plan().needs().media
            && !scene.plan().needs().waves
    }

    /// As [`Integrator::begin`], compiled as this variant, or as one that can do more. Every variant that suits a scene
    /// gives the same bits.
    pub fn begin_as<'a>(&self, job: Job<'a>, variant: ShadingVariant, cancel: &Cancel) -> Box<dyn Session + 'a> {
        self.settings(job.scene).begin_as(job, variant, cancel)
    }
}

impl Integrator for Path {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        if job.scene.plan().needs().media {
            let shares = self.patch(job.scene) > 1;
            return Volumes { shares, ..Volumes::path(self.max_depth, self.roulette_depth) }.begin(job);
        }
        self.settings(job.scene).begin(job, cancel)
    }

    fn takes_media(&self) -> bool {
        true
    }

    fn takes_waves(&self) -> bool {
        true
    }

    /// 1 where nothing can be shared, or no path goes on from its second surface.
    fn patch(&self, scene: &Scene) -> u32 {
        let goes_on = self.max_depth.is_none_or(|depth| depth > 1);
        if goes_on && (can_share(scene) || volumes::can_share(scene)) { self.reuse.max(1) } else { 1 }
    }
}
