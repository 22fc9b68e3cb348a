//! How to render.

use super::filter::{self, Filter};
use super::{Film, Until};
use raywright_base::sampling::SamplerKind;
use raywright_integrators::Job;
use raywright_scene::{Camera, Scene};
use std::sync::Arc;

/// How to render.
#[derive(Clone, Debug)]
pub struct Settings {
    /// When to end. With nothing set, the render goes on until its [`Progress`](super::Progress) ends it.
    pub until: Until,
    /// Which of all possible pictures.
    pub seed: u64,
    /// How many threads work; `None` for as many as there are cores.
    pub threads: Option<usize>,
    /// Where the random numbers come from.
    pub sampler: SamplerKind,
    /// Whether more samples go where more of the error is; else all pixels have the same number.
    pub adaptive: bool,
    /// Whether four parts of the samples are kept apart, by which pictures are denoised.
    pub apart: bool,
    /// The radiance to which brighter samples are dimmed, which biases the picture; `None` takes all as they are.
    pub clamp: Option<f64>,
    /// What part of the film a pixel is the mean of.
    pub filter: Arc<dyn Filter>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            until: Until::default(),
            seed: 0,
            threads: None,
            sampler: SamplerKind::default(),
            adaptive: false,
            apart: false,
            clamp: None,
            filter: Arc::new(filter::Box::default()),
        }
    }
}

impl Settings {
    /// What an integrator is told of a picture of a scene by a camera.
    pub(super) fn job<'a>(&self, scene: &'a Scene, camera: &'a dyn Camera) -> Job<'a> {
        Job::new(scene, camera, self.seed, self.sampler.batch())
    }

    /// An empty film for the pictures of a camera, in patches as the integrator has them
    /// ([`Integrator::patch`](raywright_integrators::Integrator::patch)).
    ///
    /// Tiles have 16 pixels a side, or less where that would leave some of so many threads without work. Where pixels
    /// work together, nothing goes over the borders of tiles: so these depend on the picture alone, and hold some
    /// patches a side, for the borders would be seen.
    pub fn film(&self, camera: &dyn Camera, threads: usize, patch: u32) -> Film {
        /// Patches a side that a tile has at least, and tiles of a picture, where there may be as many.
        const PATCHES: u32 = 4;
        const TILES: usize = 64;
        let (width, height) = (camera.width(), camera.height());
        let tiles = |side: u32| width.div_ceil(side) as usize * height.div_ceil(side) as usize;
        let side = if patch > 1 {
            let fits = |side: u32| side > PATCHES * patch && tiles(side) >= TILES;
            [32, 16].into_iter().find(|&side| fits(side)).unwrap_or(PATCHES * patch)
        } else {
            [16, 8, 4].into_iter().find(|&side| tiles(side) >= 8 * threads).unwrap_or(2)
        };
        let (batch, halves) = (self.sampler.batch(), self.adaptive);
        Film::new(width, height, side, batch, halves, self.clamp).in_patches(patch).kept_apart(self.apart)
    }
}
