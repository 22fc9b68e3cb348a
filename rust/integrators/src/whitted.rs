//! Recursive ray tracing, as a loop.

use super::transport::{Follow, Settings};
use super::volumes::{Onwards, Volumes};
use super::{Integrator, Job, Session};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;

/// Whitted's ray tracing ("An Improved Illumination Model for Shaded Display", 1980): lights and ambient light at each
/// surface by its scattering, and both the reflected and the refracted ray of smooth ones, followed to a depth, or for
/// as long as they contribute (Hall and Greenberg, "A Testbed for Realistic Image Synthesis", 1983). What is scattered
/// otherwise is not followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whitted {
    /// The greatest number of surfaces that light comes by, from the light on.
    pub max_depth: u32,
    /// Rays are not followed that contribute less than this share to their pixel, in any colour; 0 follows all.
    pub contribution: f64,
    /// Radiance that arrives from everywhere in place of what is not followed. Surfaces reflect their ambient share of
    /// it ([`Material::ambient`](raywright_scene::Material::ambient)).
    pub ambient: Rgb,
    /// How many light samples the first surface takes, from equal shares of the lights; at least 1.
    pub light_samples: u32,
}

impl Default for Whitted {
    fn default() -> Self {
        Self { max_depth: 8, contribution: 1.0 / 512.0, ambient: Rgb::ZERO, light_samples: 1 }
    }
}

impl Integrator for Whitted {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        if job.scene.plan().needs().media {
            let (onwards, ambient, least) = (Onwards::DeltaLobes, self.ambient, self.contribution);
            let light_samples = self.light_samples.max(1);
            let settings = Volumes::dimmed(self.max_depth);
            return Volumes { onwards, ambient, least, light_samples, ..settings }.begin(job);
        }
        Settings {
            follow: Follow::DeltaLobes,
            ambient: self.ambient,
            light_samples: self.light_samples.max(1),
            least: self.contribution,
            ..Settings::path(Some(self.max_depth), u32::MAX)
        }
        .begin(job, cancel)
    }

    fn takes_media(&self) -> bool {
        true
    }

    fn takes_waves(&self) -> bool {
        true
    }
}
