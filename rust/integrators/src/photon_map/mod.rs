//! Photon mapping: photon storage (`maps`, `photon`), lookup (`places`, `grid`, `kd_tree`), density estimation
//! (`estimate`, `kernel`), the same for media (`volume_photon`, `among`), the lookup radius (`radius`), the surface
//! share of a lookup disk (`cover`), the maps of one picture (`series`, `store`), and the integrator sessions
//! (`session`).

mod disk_coverage;
mod estimate;
mod hashed_grid;
mod kd_tree;
mod kernel;
mod map_cache;
mod map_series;
mod photon;
mod photon_lookup;
mod photon_tracing;
mod radius;
mod session;
mod volume_estimate;
mod volume_photon;

pub(super) use disk_coverage::cover;
pub(super) use hashed_grid::HashedGrid;
pub use kernel::Kernel;
pub(super) use map_cache::PhotonCount;
pub(super) use map_series::{MapSchedule, Sending, Series};
pub(super) use photon::StoredPhoton;
pub(super) use photon_tracing::flown;

use super::wavefront::Limits;
use super::{Integrator, Job, Session};
use raywright_base::workers::Cancel;
use raywright_scene::{Camera, Scene};
use session::{Mapped, Recipe};

/// Photon mapping (Jensen, "Global Illumination using Photon Maps", 1996; "Realistic Image Synthesis Using Photon
/// Mapping", 2001). Light paths store photons on matte surfaces, and radiance is estimated from their density.
///
/// Direct light is sampled. A caustic map stores photons that arrive through specular surfaces alone. A global map
/// stores all other indirect light. It is looked up by final gathering from the first matte surface, or at that surface
/// directly. Camera paths continue through specular surfaces to a matte one, so light is found that entered through
/// glass and is seen through glass. Each batch of samples has its own maps. So batches are independent, and their
/// variance includes the noise of the maps.
///
/// Media have a photon map of all light scattered in them. A camera path samples its scattering point and estimates
/// in-scattered radiance from the photons around it (Jensen and Christensen, "Efficient Simulation of Light Transport
/// in Scenes with Participating Media using Photon Maps", 1998).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonMap {
    /// Light paths per map; at least 1.
    pub photons: u32,
    /// Number of nearest photons of an estimate; `None` uses all photons within the radius.
    pub nearest: Option<u32>,
    /// Maximum lookup distance. `None` means unlimited with `nearest`, and a radius derived from the first map without.
    pub radius: Option<f64>,
    /// Use a separate caustic map.
    pub caustic: bool,
    /// Final gather rays from the first matte surface; 0 looks up the global map there.
    pub gather: u32,
    /// Maps per batch of samples, at most one per sample; at least 1.
    pub maps: u32,
    /// Kernel that weights photons by distance.
    pub kernel: Kernel,
    /// Maximum number of surface bounces. `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Number of bounces after which Russian roulette starts.
    pub roulette_depth: u32,
    /// Factor on each lookup radius, at most 1.
    pub scale: f64,
}

/// Progressive photon mapping (Hachisuka, Ogaki and Jensen 2008) in its stateless form (Knaus and Zwicker 2011). Each
/// sample of all pixels has its own map and radius. The radius shrinks from map to map, so both noise and bias converge
/// to zero. In media the volume of balls shrinks as the area of disks does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgressivePhotonMap {
    /// Light paths per map, at least 1; `None` derives a number from the picture.
    pub photons: Option<u32>,
    /// Lookup radius of the first map; `None` derives it from that map.
    pub radius: Option<f64>,
    /// Share of new photons that is kept, above 0 and at most 1: trades noise for bias. Radii are constant at 1.
    pub alpha: f64,
    /// Final gather rays from the first matte surface; 0 looks up the map there.
    pub gather: u32,
    /// Kernel that weights photons by distance.
    pub kernel: Kernel,
    /// Maximum number of surface bounces. `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Number of bounces after which Russian roulette starts.
    pub roulette_depth: u32,
    /// Factor on each lookup radius, at most 1.
    pub scale: f64,
    /// Number of maps whose mean squared radius all maps use; `None` for shrinking radii.
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

/// Return the number of light paths that takes about as long as one sample of all pixels. More paths reduce the radius
/// but not the noise. Fewer leave the camera paths as the only cost.
fn suited(camera: &dyn Camera) -> u32 {
    const OF_A_PIXEL: u32 = 4;
    (camera.width() * camera.height()).saturating_mul(OF_A_PIXEL).clamp(20_000, 500_000)
}

/// Return why neither integrator supports these settings, if so.
fn objection(scene: &Scene, adaptive: bool) -> Option<String> {
    if adaptive {
        return Some("all pixels share photon maps, so sampling cannot be adaptive: use adaptive=False".into());
    }
    scene.not_drawn().or_else(|| scene.glow()).map(|why| format!("{why}, and photons cannot start there: use Path"))
}

impl Integrator for PhotonMap {
    fn begin<'a>(&'a self, job: Job<'a>, cancel: &Cancel) -> Box<dyn Session + 'a> {
        let sending = Sending {
            paths: self.photons,
            limits: Limits { max_depth: self.max_depth, roulette_depth: self.roulette_depth },
            caustic: self.caustic,
            spread: MapSchedule::Batches { size: job.batch, maps: self.maps.clamp(1, job.batch) },
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
            // One map holds all light, with one radius. The caustic photons stay separate so that final gathering can
            // skip them.
            caustic: true,
            spread: MapSchedule::Progressive { alpha: self.alpha, mean_of: self.mean_of },
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
