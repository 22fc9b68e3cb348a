//! Whitted ray tracing, without recursion.

use super::begin_paths::begin;
use super::path_settings::{Follow, PathSettings};
use super::{Integrator, Job, Session};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;

/// Whitted ray tracing ("An Improved Illumination Model for Shaded Display", 1980): direct and ambient light at each
/// surface. Both the reflected and the refracted ray of smooth surfaces are traced to a maximum depth, or while their
/// contribution suffices (Hall and Greenberg, "A Testbed for Realistic Image Synthesis", 1983). Other scattered light
/// is not followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whitted {
    /// Maximum number of surfaces on a path of light, counted from the light.
    pub max_depth: u32,
    /// Minimum contribution of a ray to its pixel in any color; others are not traced. 0 traces all.
    pub contribution: f64,
    /// Uniform incident radiance that replaces light not followed. Surfaces reflect their ambient share of it
    /// ([`Material::ambient`](raywright_scene::Material::ambient)).
    pub ambient: Rgb,
    /// Light samples of the first surface, stratified over the lights; at least 1.
    pub light_samples: u32,
}

impl Default for Whitted {
    fn default() -> Self {
        Self { max_depth: 8, contribution: 1.0 / 512.0, ambient: Rgb::ZERO, light_samples: 1 }
    }
}

impl Integrator for Whitted {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let settings = PathSettings {
            follow: Follow::DeltaLobes,
            ambient: self.ambient,
            light_samples: self.light_samples.max(1),
            least: self.contribution,
            ..PathSettings::dimmed(self.max_depth)
        };
        begin(settings, job, cancel)
    }

    fn takes_media(&self) -> bool {
        true
    }

    fn takes_waves(&self) -> bool {
        true
    }
}
