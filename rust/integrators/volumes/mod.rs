//! Path tracing through smoke, haze and whatever else fills space: one path at a time.
//!
//! Paths carry densities for three wavelengths, of which one decides how far they get; all count by the mean of what
//! each of the three would have done (Wilkie et al., "Hero Wavelength Spectral Sampling", 2014; Miller, Georgiev and
//! Jarosz, "A Null-Scattering Path Integral Formulation of Light Transport", 2019).

mod direct_light;
mod equiangular;
mod fading;
mod filled;
mod flight;
mod numbers;
mod path_state;
mod scattering;
mod surfaces;
mod walker;
mod weights;

use super::{Job, Session, Worker};
use crate::math::DVec3;
use crate::optics::Rgb;
use crate::scene::Scene;
use crate::scene::lights::{Light, Place};
use walker::Walker;

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
    /// Which directions are followed.
    pub onwards: Onwards,
    /// Radiance that arrives from everywhere in place of what is not followed, where it is scattered diffusely.
    pub ambient: Rgb,
    /// Paths end that contribute less than this, in any colour.
    pub least: f64,
}

impl Volumes {
    /// Those of a path tracer.
    pub fn path(max_depth: Option<u32>, roulette_depth: u32) -> Self {
        let (onwards, ambient) = (Onwards::All, Rgb::ZERO);
        Self { max_depth, roulette_depth, scatters: true, onwards, ambient, least: 0.0 }
    }

    /// Those of what follows light among surfaces alone, to so many of them, and is dimmed between.
    pub fn dimmed(max_depth: u32) -> Self {
        Self { scatters: false, ..Self::path(Some(max_depth), u32::MAX) }
    }

    /// Begins to work on a picture.
    pub fn begin<'a>(self, job: Job<'a>) -> Box<dyn Session + 'a> {
        let point = |light: &'a dyn Light| match light.place() {
            Some(Place::Point(place)) => Some((place, light)),
            _ => None,
        };
        let points = job.scene.lights().others().filter_map(point).collect();
        Box::new(Among { settings: self, scene: job.scene, points })
    }
}

/// What workers on a picture share.
struct Among<'a> {
    settings: Volumes,
    scene: &'a Scene,
    /// Lights that are points.
    points: Vec<(DVec3, &'a dyn Light)>,
}

impl Session for Among<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(Walker::new(self.settings, self.scene, &self.points))
    }
}
