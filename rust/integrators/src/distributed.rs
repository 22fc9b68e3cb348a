//! Distributed ray tracing.

use super::begin_paths::begin;
use super::path_settings::{Follow, PathSettings};
use super::{Integrator, Job, Session};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;

/// Distributed ray tracing (Cook, Porter and Carpenter, "Distributed Ray Tracing", 1984): rays are distributed over
/// lights, lobes, lens and shutter, for soft shadows, gloss, depth of field and motion blur. Diffuse interreflection is
/// replaced by ambient light.
///
/// A direction is followed if its density exceeds [`Distributed::GLOSS`] per solid angle, three times the maximum of a
/// matte surface. Other directions receive light from light sampling alone. Only the first surface splits its ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distributed {
    /// Maximum number of surfaces on a path of light, counted from the light.
    pub max_depth: u32,
    /// Number of rays that continue from the first surface, and of its light samples; at least 1.
    pub splits: u32,
    /// Uniform incident radiance that replaces light not followed. Surfaces reflect their ambient share of it
    /// ([`Material::ambient`](raywright_scene::Material::ambient)).
    pub ambient: Rgb,
}

impl Distributed {
    /// Minimum density, per solid angle, of directions that are followed.
    pub const GLOSS: f64 = 1.0;
}

impl Default for Distributed {
    fn default() -> Self {
        Self { max_depth: 8, splits: 4, ambient: Rgb::ZERO }
    }
}

impl Integrator for Distributed {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let splits = self.splits.max(1);
        let settings = PathSettings {
            follow: Follow::MinDensity(Self::GLOSS),
            ambient: self.ambient,
            light_samples: splits,
            splits,
            ..PathSettings::dimmed(self.max_depth)
        };
        begin(settings, job, cancel)
    }

    fn takes_waves(&self) -> bool {
        true
    }
}
