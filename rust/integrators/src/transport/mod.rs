//! What path tracing and its ancestors share: a batch of paths on their way, one bounce at a time.

mod aiming;
mod ambient;
mod arrivals;
mod arrive;
mod block;
mod carried;
mod continuation;
mod direct_light;
mod emission;
mod first_seen;
mod guided;
mod known;
mod matt;
mod meet;
mod path_state;
mod shade;
mod splitting;
mod waves;
mod widths;
mod worker;

use super::wavefront::Wavefront;
use super::{Guide, Job, Session, Worker};
pub(super) use direct_light::share;
pub use first_seen::FirstSeen;
pub(super) use known::{Gather, MattLight, Visit};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::Scene;
use std::sync::Arc;
use worker::TransportWorker;

/// Along which of the directions that surfaces scatter into paths are followed. What is not followed is left to the
/// light that is asked directly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Follow {
    /// All.
    All,
    /// Those drawn with a density, in solid angle, above this.
    MinDensity(f64),
    /// Single directions only, and of these every one: paths are split.
    DeltaLobes,
    /// None.
    Nothing,
}

/// How light is transported.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings {
    /// The greatest number of bounces.
    pub max_depth: Option<u32>,
    /// Roulette is played from this number of bounces on.
    pub roulette_depth: u32,
    /// How often light is asked at the first surface.
    pub light_samples: u32,
    /// Into how many a path is split at the first surface.
    pub splits: u32,
    /// Which directions are followed.
    pub follow: Follow,
    /// Whether what lies on the way to a light shadows it.
    pub shadows: bool,
    /// Radiance that arrives from everywhere in place of what is not followed, where it is scattered diffusely.
    pub ambient: Rgb,
    /// Paths end that contribute less than this, in any color.
    pub least: f64,
    /// Whether paths of a group share what they find, in scenes where they can ([`can_share`]).
    pub shares: bool,
    /// Whether paths are guided to where light comes from by way of mirrors and glass.
    pub guided: bool,
    /// What becomes of paths at matt surfaces whose light is known; where that is so, [`Settings::begin_with`] is told
    /// of it. `None` where they go on.
    pub gather: Option<Gather>,
}

impl Settings {
    /// Those of a path tracer.
    pub fn path(max_depth: Option<u32>, roulette_depth: u32) -> Self {
        Self {
            max_depth,
            roulette_depth,
            light_samples: 1,
            splits: 1,
            follow: Follow::All,
            shadows: true,
            ambient: Rgb::ZERO,
            least: 0.0,
            shares: false,
            guided: false,
            gather: None,
        }
    }

    /// Whether they are those of a path tracer.
    fn are_plain(&self) -> bool {
        self.follow == Follow::All && self.shadows && self.are_of_stages()
    }

    /// Whether stages know them, but for what is followed and shadowed.
    fn are_of_stages(&self) -> bool {
        self.light_samples == 1
            && self.splits == 1
            && self.ambient.is_black()
            && self.least == 0.0
            && self.gather.is_none()
    }

    /// Begins with stages over columns where they have what the scene and these settings need, and otherwise with the
    /// variant that has it.
    pub fn begin<'a>(self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let guide = if self.guided { Guide::of(job.scene, cancel) } else { None };
        let is_of_stages = self.are_of_stages() && Wavefront::takes(&job);
        match (self.follow, self.max_depth) {
            (Follow::All, depth) if is_of_stages && self.shadows => {
                Box::new(Wavefront::new(job, depth, self.roulette_depth, self.shares, guide))
            }
            (Follow::Nothing, Some(1)) if is_of_stages => Box::new(Wavefront::of_drawn_light(job, self.shadows)),
            _ => Box::new(Transport { settings: self, job, guide, known: None }),
        }
    }

    /// As [`Settings::begin`], by the loop that knows everything.
    pub fn begin_in_general<'a>(self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let guide = if self.guided { Guide::of(job.scene, cancel) } else { None };
        Box::new(Transport { settings: self, job, guide, known: None })
    }

    /// As [`Settings::begin`], where light at matt surfaces is known.
    pub fn begin_with<'a>(self, job: Job<'a>, known: Arc<dyn MattLight + 'a>) -> Box<dyn Session + 'a> {
        Box::new(Transport { settings: self, job, guide: None, known: Some(known) })
    }
}

/// What workers on a picture share.
struct Transport<'a> {
    settings: Settings,
    job: Job<'a>,
    /// Where light comes from by way of what is sharp, if paths are guided and there is any.
    guide: Option<Arc<Guide>>,
    /// What is known of the light at matt surfaces.
    known: Option<Arc<dyn MattLight + 'a>>,
}

impl Session for Transport<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(TransportWorker::new(self.settings, &self.job, self.guide.as_deref(), self.known.as_deref()))
    }
}

/// Whether paths can share in a scene: two points see each other or do not, at any time, and what is found at a point
/// does not depend on who looks.
///
/// Masks and nested media make sight more than a yes or no; where something moves, the samples of a group see the scene
/// at times of their own; and a filtered texture shows to each what is of its own width.
pub(super) fn can_share(scene: &Scene) -> bool {
    let needs = scene.plan().needs();
    let is_open = !(needs.masks || needs.nested || needs.media || needs.points.width || needs.waves);
    is_open && !needs.motion && !scene.lights().is_dark()
}
