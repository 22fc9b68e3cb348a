//! Light tracing.

use super::begin_paths::begin;
use super::light_paths::{Counting, LightPaths};
use super::path_settings::PathSettings;
use super::wavefront::Limits;
use super::{Integrator, Job, LightWorker, Session, Worker};
use raywright_base::workers::Cancel;
use raywright_scene::{Emitters, Scene};

/// Light tracing (Arvo, "Backward Ray Tracing", 1986; Dutré, Lafortune and Willems, "Monte Carlo Light Tracing with
/// Direct Computation of Pixel Intensities", 1993). Paths start at lights, and each surface vertex is connected to the
/// camera. Camera rays add visible emission.
///
/// It finds caustics on matte surfaces, which path tracing hardly does. It never finds light that the camera sees in
/// mirrors or through glass, where no connection is possible. Such surfaces are black except for their own emission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightTraced {
    /// Maximum number of scattering events; 0 shows only emission. `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Number of bounces after which Russian roulette starts.
    pub roulette_depth: u32,
}

impl Default for LightTraced {
    fn default() -> Self {
        Self { max_depth: None, roulette_depth: 4 }
    }
}

impl Integrator for LightTraced {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let seen = begin(PathSettings::dimmed(0), job, cancel);
        let limits = Limits { max_depth: self.max_depth, roulette_depth: self.roulette_depth };
        Box::new(LightTracing { limits, job, seen, emitters: job.scene.emitters() })
    }

    fn objection(&self, scene: &Scene, adaptive: bool) -> Option<String> {
        if adaptive {
            return Some("light paths reach all pixels, so sampling cannot be adaptive: use adaptive=False".into());
        }
        scene
            .not_drawn()
            .or_else(|| scene.glow())
            .map(|why| format!("{why}, and light paths cannot start there: use Path"))
    }

    fn takes_media(&self) -> bool {
        true
    }

    fn takes_waves(&self) -> bool {
        true
    }
}

/// Data shared by the workers of a picture.
struct LightTracing<'a> {
    limits: Limits,
    job: Job<'a>,
    /// Session of the camera's own rays.
    seen: Box<dyn Session + 'a>,
    /// `None` without lights.
    emitters: Option<Emitters<'a>>,
}

impl Session for LightTracing<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        self.seen.worker()
    }

    fn light_worker(&self) -> Option<Box<dyn LightWorker + '_>> {
        let emitters = self.emitters.as_ref().filter(|_| self.limits.max_depth != Some(0))?;
        Some(Box::new(LightPaths::new(self.job, emitters, self.limits, Counting::Full)))
    }
}
