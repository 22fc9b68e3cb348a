//! Ray casting.

use super::begin_paths::begin;
use super::path_settings::{Follow, PathSettings};
use super::{Integrator, Job, Session};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;

/// Ray casting with shadows (Appel, "Some Techniques for Shading Machine Renderings of Solids", 1968): emission, direct
/// light and ambient light. No further rays are traced, so mirrors and glass are black.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCast {
    /// Uniform incident radiance, unshadowed. Surfaces reflect their ambient share of it
    /// ([`Material::ambient`](raywright_scene::Material::ambient)).
    pub ambient: Rgb,
    /// Trace shadow rays to the lights.
    pub shadows: bool,
    /// Light samples per surface, stratified over the lights; at least 1.
    pub light_samples: u32,
}

impl Default for RayCast {
    fn default() -> Self {
        Self { ambient: Rgb::ZERO, shadows: true, light_samples: 1 }
    }
}

impl Integrator for RayCast {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let settings = PathSettings {
            follow: Follow::Nothing,
            shadows: self.shadows,
            ambient: self.ambient,
            light_samples: self.light_samples.max(1),
            ..PathSettings::dimmed(1)
        };
        begin(settings, job, cancel)
    }

    fn takes_waves(&self) -> bool {
        true
    }
}
