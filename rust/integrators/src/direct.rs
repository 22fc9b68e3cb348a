//! Direct light.

use super::begin_paths::begin;
use super::path_settings::PathSettings;
use super::{Integrator, Job, Session};
use raywright_base::workers::Cancel;

/// Emission and direct light: one bounce. Light and BSDF sampling are combined by multiple importance sampling (Veach
/// and Guibas, "Optimally Combining Sampling Techniques", 1995).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direct {
    /// Light samples per surface, stratified over the lights; at least 1.
    pub light_samples: u32,
    /// BSDF samples per surface; at least 1.
    pub surface_samples: u32,
}

impl Default for Direct {
    fn default() -> Self {
        Self { light_samples: 1, surface_samples: 1 }
    }
}

impl Integrator for Direct {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let (light_samples, splits) = (self.light_samples.max(1), self.surface_samples.max(1));
        begin(PathSettings { light_samples, splits, ..PathSettings::dimmed(1) }, job, cancel)
    }

    fn takes_media(&self) -> bool {
        true
    }

    fn takes_waves(&self) -> bool {
        true
    }
}
