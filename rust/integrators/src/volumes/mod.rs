//! Paths through smoke, haze and whatever else fills space: from the camera (`walker`), many side by side (`asking`,
//! `together`), and one at a time from lights (`light_walk`, `to_camera`), and from both ends (`both_ends`).
//!
//! Paths carry densities for three wavelengths, of which one decides how far they get; all count by the mean of what
//! each of the three would have done (Wilkie et al., "Hero Wavelength Spectral Sampling", 2014; Miller, Georgiev and
//! Jarosz, "A Null-Scattering Path Integral Formulation of Light Transport", 2019).

mod asking;
mod both_ends;
mod course;
mod cubic;
mod direct_light;
mod equiangular;
mod fading;
mod filled;
mod flight;
mod gathering;
mod known;
mod light_end;
mod light_walk;
mod numbers;
mod optical_depth;
mod pairs;
mod path_state;
mod reuse;
mod scattering;
mod shared;
mod surfaces;
mod to_camera;
mod together;
mod vertex;
mod walker;
mod weights;

pub(super) use both_ends::BothEnds;
pub(super) use filled::Filled;
pub(super) use known::KnownLight;
pub(super) use light_walk::{Drifting, MediaLightWalk, MediaVisitor};
pub(super) use numbers::Numbers;
pub use optical_depth::optical_depths;
pub(super) use reuse::can_share;
pub(super) use scattering::Scattering;
pub(super) use surfaces::{Met, meet};
pub(super) use to_camera::{Counting, MediaLightPaths};
pub(super) use vertex::{Point, Vertex};

use super::transport::Gather;
use super::{Job, Session, Worker};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use raywright_scene::lights::{Light, Place as LightPlace};
use raywright_scene::{Footprint, Scene};
use std::sync::Arc;
use walker::Walkers;

/// Along which of the directions into which light is scattered paths go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Onwards {
    /// All.
    All,
    /// Single directions only, and of these every one: paths are split.
    DeltaLobes,
}

/// How light is transported among media.
#[derive(Clone, Copy, Debug)]
pub(super) struct Volumes {
    /// The greatest number of times that light is scattered, at surfaces or between them.
    pub max_depth: Option<u32>,
    /// Roulette is played from this number on.
    pub roulette_depth: u32,
    /// Whether what media scatter comes back to the path; if not, they only dim.
    pub scatters: bool,
    /// How often light is asked at the first surface, and into how many a path is split there.
    pub light_samples: u32,
    pub splits: u32,
    /// Which directions are followed.
    pub onwards: Onwards,
    /// Radiance that arrives from everywhere in place of what is not followed, where it is scattered diffusely.
    pub ambient: Rgb,
    /// Paths end that contribute less than this, in any colour.
    pub least: f64,
    /// What becomes of paths at matt surfaces whose light is known, as it is among media then; where that is so,
    /// [`Volumes::begin_with`] is told of it. `None` where they go on.
    pub gather: Option<Gather>,
    /// Whether paths of a group share what they find, in scenes where they can ([`can_share`]).
    pub shares: bool,
}

impl Volumes {
    /// Those of a path tracer.
    pub fn path(max_depth: Option<u32>, roulette_depth: u32) -> Self {
        Self {
            max_depth,
            roulette_depth,
            scatters: true,
            light_samples: 1,
            splits: 1,
            onwards: Onwards::All,
            ambient: Rgb::ZERO,
            least: 0.0,
            gather: None,
            shares: false,
        }
    }

    /// Those of what follows light among surfaces alone, to so many of them, and is dimmed between.
    pub fn dimmed(max_depth: u32) -> Self {
        Self { scatters: false, ..Self::path(Some(max_depth), u32::MAX) }
    }

    /// Begins to work on a picture.
    pub fn begin<'a>(self, job: Job<'a>) -> Box<dyn Session + 'a> {
        self.among(job, None)
    }

    /// As [`Volumes::begin`], where light is known where paths are scattered.
    pub fn begin_with<'a>(self, job: Job<'a>, known: Arc<dyn KnownLight + 'a>) -> Box<dyn Session + 'a> {
        self.among(job, Some(known))
    }

    fn among<'a>(self, job: Job<'a>, known: Option<Arc<dyn KnownLight + 'a>>) -> Box<dyn Session + 'a> {
        let point = |light: &'a dyn Light| match light.place() {
            Some(LightPlace::Point(place)) => Some((place, light)),
            _ => None,
        };
        let points = job.scene.lights().others().filter_map(point).collect();
        Box::new(Among { settings: self, scene: job.scene, footprint: job.footprint, points, known })
    }
}

/// What workers on a picture share.
struct Among<'a> {
    settings: Volumes,
    scene: &'a Scene,
    /// How wide cameras' rays are.
    footprint: Footprint,
    /// Lights that are points.
    points: Vec<(DVec3, &'a dyn Light)>,
    /// What is known of light where paths are scattered.
    known: Option<Arc<dyn KnownLight + 'a>>,
}

impl Session for Among<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(Walkers::new(self.settings, (self.scene, self.footprint), &self.points, self.known.as_deref()))
    }
}
