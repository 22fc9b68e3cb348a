//! Light transport as stages over columns of paths, after pbrt-v4's wavefront (Pharr, Jakob and Humphreys, "Physically
//! Based Rendering", 4th ed., 2023, chapter 15): all paths of a batch take each step together.
//!
//! A stage reads columns and writes columns. No stage knows the next; [`worker`] lists them.

mod direct_light;
mod emission;
mod matte;
mod queues;
mod worker;

use super::{Job, Session, Worker};
use raywright_scene::{Scene, ShadingVariant};
use worker::WavefrontWorker;

/// Path tracing by stages.
pub(super) struct Wavefront<'a> {
    job: Job<'a>,
    max_depth: Option<u32>,
    roulette_depth: u32,
    shares: bool,
}

/// Radiances that f32 holds, with the squares of what follows from them.
const RADIANCES: std::ops::Range<f64> = 1e-15..1e15;

impl<'a> Wavefront<'a> {
    /// Path tracing of a picture to a depth, with Russian roulette from a depth on. Paths of a group may share.
    pub fn new(job: Job<'a>, max_depth: Option<u32>, roulette_depth: u32, shares: bool) -> Self {
        Self { job, max_depth, roulette_depth, shares }
    }

    /// Whether a scene has what stages know, and nothing else: triangles that reflect diffusely.
    pub fn takes(scene: &Scene) -> bool {
        let needs = scene.plan().needs();
        scene.plan().suits(ShadingVariant::Plain)
            && !(needs.shapes || needs.smooth || needs.motion)
            && scene.lights().radiances().all(|radiance| radiance == 0.0 || RADIANCES.contains(&radiance))
    }
}

impl Session for Wavefront<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(WavefrontWorker::new(&self.job, self.max_depth, self.roulette_depth, self.shares))
    }
}
