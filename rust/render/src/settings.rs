//! Render settings.

use super::filter::{self, Filter};
use super::{Film, Until};
use raywright_base::sampling::SamplerKind;
use raywright_integrators::Job;
use raywright_scene::{Camera, Scene};
use std::sync::Arc;

/// Render settings.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Stopping criteria. Without any, the render continues until its [`Progress`](super::Progress) ends it.
    pub until: Until,
    /// Random seed.
    pub seed: u64,
    /// Number of threads; `None` for the number of cores.
    pub threads: Option<usize>,
    /// Sampler.
    pub sampler: SamplerKind,
    /// True for adaptive sampling; otherwise all pixels have the same number of samples.
    pub adaptive: bool,
    /// True if four parts of the samples are kept apart for denoising.
    pub apart: bool,
    /// Radiance that brighter samples are scaled down to, which biases the picture; `None` for no clamping.
    pub clamp: Option<f64>,
    /// Reconstruction filter.
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
    /// The integrator's job for a scene and a camera.
    pub(super) fn job<'a>(&self, scene: &'a Scene, camera: &'a dyn Camera) -> Job<'a> {
        Job::new(scene, camera, self.seed, self.sampler.batch())
    }

    /// Creates an empty film for a camera, with the integrator's patch size
    /// ([`Integrator::patch`](raywright_integrators::Integrator::patch)).
    ///
    /// Tiles have 16 pixels per side, or less if some threads would have no work. If pixels share samples, patches do
    /// not cross tile borders, so tile sizes depend only on the picture. They then hold several patches per side,
    /// because the borders would be visible otherwise.
    pub fn film(&self, camera: &dyn Camera, threads: usize, patch: u32) -> Film {
        /// Minimum patches per side of a tile, and minimum number of tiles if the picture allows it.
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
