//! Distributed ray tracing.

use super::transport::{Follow, Settings};
use super::{Integrator, Job, Session};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;

/// Distributed ray tracing (Cook, Porter and Carpenter, "Distributed Ray Tracing", 1984): rays are spread over lights,
/// lobes, lens and shutter, for soft shadows, gloss, depth of field and motion blur. Diffuse light between surfaces is
/// not followed: ambient light stands for it.
///
/// A direction is followed if the surface scatters into it with more than [`Distributed::GLOSS`] per solid angle, three
/// times the most that a matt surface has; what comes from the others is the lights' alone. The first surface splits
/// its ray, the others do not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distributed {
    /// The greatest number of surfaces that light comes by, from the light on.
    pub max_depth: u32,
    /// Into how many rays the first surface splits one, and how often it asks for light; at least 1.
    pub splits: u32,
    /// Radiance that arrives from everywhere in place of what is not followed. Surfaces reflect their ambient share of
    /// it ([`Material::ambient`](raywright_scene::Material::ambient)).
    pub ambient: Rgb,
}

impl Distributed {
    /// The density, per solid angle, above which directions are followed.
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
        Settings {
            follow: Follow::MinDensity(Self::GLOSS),
            ambient: self.ambient,
            light_samples: splits,
            splits,
            ..Settings::path(Some(self.max_depth), u32::MAX)
        }
        .begin(job, cancel)
    }

    fn takes_waves(&self) -> bool {
        true
    }
}
