//! Light tracing.

use super::light_paths::{LightPaths, Limits};
use super::transport::Settings;
use super::volumes::{Counting, MediaLightPaths, Volumes};
use super::{Integrator, Job, LightWorker, Session, Worker};
use raywright_base::workers::Cancel;
use raywright_scene::{Emitters, Scene};

/// Light tracing (Arvo, "Backward Ray Tracing", 1986; Dutré, Lafortune and Willems, "Monte Carlo Light Tracing with
/// Direct Computation of Pixel Intensities", 1993): paths start at lights, are scattered from surface to surface, and
/// at each of them are connected to the camera. What shines is seen by the camera's own rays.
///
/// It finds what path tracing hardly does, light that mirrors and glass throw upon matt surfaces. It never finds light
/// that the camera sees in a mirror or through glass, where no connection goes: such surfaces are black but for what
/// shines in them without being seen so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightTraced {
    /// The greatest number of times that light is scattered; 0 shows only what shines itself. `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Roulette is played from this number of bounces on.
    pub roulette_depth: u32,
}

impl Default for LightTraced {
    fn default() -> Self {
        Self { max_depth: None, roulette_depth: 4 }
    }
}

impl Integrator for LightTraced {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let seen = if job.scene.plan().needs().media {
            Volumes::dimmed(0).begin(job)
        } else {
            Settings::path(Some(0), u32::MAX).begin(job, cancel)
        };
        let limits = Limits { max_depth: self.max_depth, roulette_depth: self.roulette_depth };
        Box::new(LightTracing { limits, job, seen, emitters: job.scene.emitters() })
    }

    fn objection(&self, scene: &Scene, adaptive: bool) -> Option<String> {
        if adaptive {
            return Some("light comes to all pixels alike, so samples cannot be adaptive: use adaptive=False".into());
        }
        scene
            .not_drawn()
            .or_else(|| scene.glow())
            .map(|why| format!("{why}, where no path from a light can start: use Path"))
    }

    fn takes_media(&self) -> bool {
        true
    }

    fn takes_waves(&self) -> bool {
        true
    }
}

/// What workers on a picture share.
struct LightTracing<'a> {
    limits: Limits,
    job: Job<'a>,
    /// What the camera's own rays see.
    seen: Box<dyn Session + 'a>,
    /// None where nothing shines.
    emitters: Option<Emitters<'a>>,
}

impl Session for LightTracing<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        self.seen.worker()
    }

    fn light_worker(&self) -> Option<Box<dyn LightWorker + '_>> {
        let emitters = self.emitters.as_ref().filter(|_| self.limits.max_depth != Some(0))?;
        if self.job.scene.plan().needs().media {
            return Some(Box::new(MediaLightPaths::new(self.job, emitters, self.limits, Counting::Full)));
        }
        Some(Box::new(LightPaths::new(self.job, emitters, self.limits, None)))
    }
}
