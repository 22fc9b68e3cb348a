//! Paths that are walked from lights and from the camera, and meet.

mod connections;
mod eye;
mod light_vertices;
#[cfg(test)]
mod tests;
mod worker;

use super::light_paths::{LightPaths, Limits, Partials, Weighing};
use super::{Integrator, Job, LightWorker, Session, Worker};
use crate::scene::{Emitters, Scene};
use crate::workers::Cancel;
use worker::BidirectionalWorker;

/// Bidirectional path tracing (Lafortune and Willems, "Bi-Directional Path Tracing", 1993; Veach and Guibas,
/// "Bidirectional Estimators for Light Transport", 1994): for each sample of each pixel a path is walked from the
/// camera and one from a light, and each surface of the one is connected to each of the other, to the light and to the
/// camera. A path that is found in several of these ways counts in each by the balance heuristic.
///
/// What path tracing finds well, and what light tracing does, is found as well by both together, and light that is hard
/// to reach from either end, such as behind a door ajar, by their connections. Only what is seen by way of something
/// sharp, lit by way of something sharp from a small light, is found no better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bidirectional {
    /// The greatest number of bounces off surfaces; 0 shows only what shines itself. `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Roulette is played from this number of bounces on, along either walk.
    pub roulette_depth: u32,
    /// If one way alone is to be shown, at its full weight: its number of vertices from the light on, and of those from
    /// the camera on, itself the first.
    pub alone: Option<[u32; 2]>,
}

impl Default for Bidirectional {
    fn default() -> Self {
        Self { max_depth: None, roulette_depth: 4, alone: None }
    }
}

impl Integrator for Bidirectional {
    fn begin<'a>(&'a self, job: Job<'a>, _: &Cancel) -> Box<dyn Session + 'a> {
        let limits = Limits { max_depth: self.max_depth, roulette_depth: self.roulette_depth };
        Box::new(Bidirection { limits, job, emitters: job.scene.emitters(), alone: self.alone })
    }

    fn objection(&self, scene: &Scene, adaptive: bool) -> Option<String> {
        super::LightTraced::default().objection(scene, adaptive)
    }
}

/// What workers on a picture share.
struct Bidirection<'a> {
    limits: Limits,
    job: Job<'a>,
    /// None where nothing shines.
    emitters: Option<Emitters<'a>>,
    alone: Option<[u32; 2]>,
}

impl Session for Bidirection<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(BidirectionalWorker::new(self.job, self.emitters.as_ref(), self.limits, self.alone))
    }

    fn light_worker(&self) -> Option<Box<dyn LightWorker + '_>> {
        let emitters = self.emitters.as_ref().filter(|_| self.limits.max_depth != Some(0))?;
        let paths = f64::from(self.job.camera.width()) * f64::from(self.job.camera.height());
        let weighing = Weighing { partials: Partials::new(emitters), paths, alone: self.alone };
        Some(Box::new(LightPaths::new(self.job, emitters, self.limits, Some(weighing))))
    }
}
