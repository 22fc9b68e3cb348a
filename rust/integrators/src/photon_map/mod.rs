//! Photon maps: how photons are kept (`maps`, `photon`), found (`places`, `grid`, `kd_tree`) and weighed (`estimate`,
//! `kernel`), the same among media (`volume_photon`, `among`), how far light is gathered from (`radius`) and how much
//! of that is surface (`cover`), the maps of a picture (`series`, `store`), and the pictures that are made of them
//! (`session`).

mod among;
mod cover;
mod estimate;
mod grid;
mod kd_tree;
mod kernel;
mod maps;
mod photon;
mod places;
mod radius;
mod series;
mod session;
mod store;
mod volume_photon;

pub(super) use cover::cover;
pub(super) use grid::HashedGrid;
pub use kernel::Kernel;
pub(super) use maps::flown;
pub(super) use photon::StoredPhoton;
pub(super) use series::{Sending, Series, Spread};
pub(super) use store::Counted;

use super::light_paths::Limits;
use super::{Integrator, Job, Session};
use raywright_base::workers::Cancel;
use raywright_scene::{Camera, Scene};
use session::{Mapped, Recipe};

/// Photon mapping (Jensen, "Global Illumination using Photon Maps", 1996; "Realistic Image Synthesis Using Photon
/// Mapping", 2001): paths from lights leave photons on matt surfaces, and how densely they lie there is the light.
///
/// Lights are asked directly; what mirrors and glass throw together is told by a caustic map; all else by a global map,
/// at the matt surfaces that rays from the first one come to, or there at once. The camera's paths go through mirrors
/// and glass to what is matt, so light is found that came through glass and is seen through glass. Samples of a batch
/// are shared out among maps of its own, so that batches are independent and their spread tells the noise of maps too.
///
/// Media have a map of their own, of all light that comes to be scattered in them: a path from the camera draws where
/// it is scattered, and asks the photons about that place for what comes back along it (Jensen and Christensen,
/// "Efficient Simulation of Light Transport in Scenes with Participating Media using Photon Maps", 1998).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonMap {
    /// Paths from lights for each map; at least 1.
    pub photons: u32,
    /// How many photons a density is told by; `None` for all within the radius.
    pub nearest: Option<u32>,
    /// How far they may lie; `None` for as far as it takes, or, without a number, as far as suits the first map.
    pub radius: Option<f64>,
    /// Whether there is a caustic map.
    pub caustic: bool,
    /// Rays from the first matt surface; 0 looks the global map up there.
    pub gather: u32,
    /// Maps for each batch of samples, where it has as many; at least 1.
    pub maps: u32,
    /// How photons count by their distance.
    pub kernel: Kernel,
    /// The greatest number of bounces off surfaces. `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Roulette is played from this number of bounces on.
    pub roulette_depth: u32,
    /// How much of each radius counts, at most 1.
    pub scale: f64,
}

/// Progressive photon mapping (Hachisuka, Ogaki and Jensen 2008) with no statistics to keep (Knaus and Zwicker 2011):
/// each sample of all pixels has a map and a radius of its own, which shrinks from one to the next so that both noise
/// and bias go to zero. Among media the volume of balls shrinks as the area of disks does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgressivePhotonMap {
    /// Paths from lights for each map, at least 1; `None` for as many as suit the picture.
    pub photons: Option<u32>,
    /// How far photons may lie in the first map; `None` for as far as suits that.
    pub radius: Option<f64>,
    /// The share of new photons that is kept: how noise falls for bias, above 0 and at most 1, where radii stay.
    pub alpha: f64,
    /// Rays from the first matt surface; 0 looks the map up there.
    pub gather: u32,
    /// How photons count by their distance.
    pub kernel: Kernel,
    /// The greatest number of bounces off surfaces. `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Roulette is played from this number of bounces on.
    pub roulette_depth: u32,
    /// How much of each radius counts, at most 1.
    pub scale: f64,
    /// Of how many samples all have the mean of the squared radii; `None` where they shrink.
    pub mean_of: Option<u32>,
}

impl Default for PhotonMap {
    fn default() -> Self {
        Self {
            photons: 100_000,
            nearest: Some(64),
            radius: None,
            caustic: true,
            gather: 1,
            maps: 8,
            kernel: Kernel::Box,
            max_depth: None,
            roulette_depth: 4,
            scale: 1.0,
        }
    }
}

impl Default for ProgressivePhotonMap {
    fn default() -> Self {
        Self {
            photons: None,
            radius: None,
            alpha: 2.0 / 3.0,
            gather: 0,
            kernel: Kernel::Box,
            max_depth: None,
            roulette_depth: 4,
            scale: 1.0,
            mean_of: None,
        }
    }
}

/// Paths from lights that take about as long as a sample of all pixels does. More make the radius smaller, and not the
/// noise; fewer would leave the picture's own paths the only ones that cost.
fn suited(camera: &dyn Camera) -> u32 {
    const OF_A_PIXEL: u32 = 4;
    (camera.width() * camera.height()).saturating_mul(OF_A_PIXEL).clamp(20_000, 500_000)
}

/// What neither can do.
fn objection(scene: &Scene, adaptive: bool) -> Option<String> {
    if adaptive {
        return Some("maps are of samples of all pixels alike, so these cannot be adaptive: use adaptive=False".into());
    }
    scene.not_drawn().or_else(|| scene.glow()).map(|why| format!("{why}, where no photon can start: use Path"))
}

impl Integrator for PhotonMap {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let sending = Sending {
            paths: self.photons,
            limits: Limits { max_depth: self.max_depth, roulette_depth: self.roulette_depth },
            caustic: self.caustic,
            spread: Spread::Batches { size: job.batch, maps: self.maps.clamp(1, job.batch) },
        };
        let Self { nearest, gather, kernel, scale, .. } = *self;
        let recipe = Recipe { sending, nearest, gather, kernel, scale };
        Box::new(Mapped::new(job, recipe, self.radius, cancel))
    }

    fn objection(&self, scene: &Scene, adaptive: bool) -> Option<String> {
        objection(scene, adaptive)
    }

    fn takes_media(&self) -> bool {
        true
    }

    fn takes_waves(&self) -> bool {
        true
    }

    fn narrowed(&self, scale: f64, _samples: u32) -> Option<Box<dyn Integrator>> {
        Some(Box::new(Self { scale: self.scale * scale, ..*self }))
    }
}

impl Integrator for ProgressivePhotonMap {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let sending = Sending {
            paths: self.photons.unwrap_or_else(|| suited(job.camera)),
            limits: Limits { max_depth: self.max_depth, roulette_depth: self.roulette_depth },
            // All light is gathered from as far, in one map; apart, it is known what rays need not look for.
            caustic: true,
            spread: Spread::Progressive { alpha: self.alpha, mean_of: self.mean_of },
        };
        let Self { gather, kernel, scale, .. } = *self;
        let recipe = Recipe { sending, nearest: None, gather, kernel, scale };
        Box::new(Mapped::new(job, recipe, self.radius, cancel))
    }

    fn objection(&self, scene: &Scene, adaptive: bool) -> Option<String> {
        objection(scene, adaptive)
    }

    fn takes_media(&self) -> bool {
        true
    }

    fn takes_waves(&self) -> bool {
        true
    }

    fn narrowed(&self, scale: f64, samples: u32) -> Option<Box<dyn Integrator>> {
        Some(Box::new(Self { scale: self.scale * scale, mean_of: Some(samples), ..*self }))
    }
}
