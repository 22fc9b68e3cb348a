//! Path guiding toward light through mirrors and glass, and toward light that paths from the camera have found.

mod boundaries;
mod cells;
mod lobe;
mod local_guide;
mod photon;
mod photon_tracing;
mod portals;
#[cfg(test)]
mod tests;
mod training;

pub use local_guide::LocalGuide;

use cells::Cells;
use photon::Photon;
use raywright_base::math::DVec3;
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Bsdf;
use raywright_scene::{Camera, Scene};
use std::sync::{Arc, Mutex, PoisonError};
use training::Visit;

/// Guiding of paths at matte surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Guiding {
    /// None.
    #[default]
    None,
    /// By photons ([`Guide::of`]).
    Photons,
    /// By paths from the camera ([`Guide::learned`]).
    Learned,
}

impl Guiding {
    /// Return the guide; `None` without one, or after a cancellation.
    pub fn guide(self, scene: &Scene, camera: &dyn Camera, cancel: &Cancel) -> Option<Arc<Guide>> {
        match self {
            Self::None => None,
            Self::Photons => Guide::of(scene, cancel),
            Self::Learned => Guide::learned(scene, camera, cancel),
        }
    }
}

/// Path guiding toward the light that reaches a scene's surfaces through mirrors and glass, in the directions of
/// photons (Jensen, "Importance Driven Path Tracing using the Photon Map", 1995).
///
/// A path from a matte surface hits a lamp behind a glass ball only by chance. The smaller the lamp's image, the rarer
/// are the hits, and the higher their weights: the fireflies of path tracing. Light sampling cannot help, as no
/// straight segment reaches the lamp. So photons are sent from the lights to specular surfaces, and traced to matte
/// ones (`photon_tracing.rs`). Space is divided into cells of similar numbers of photons (`cells.rs`). Photons of a
/// cell with the same specular chain are fitted by a sphere that light comes from (`lobe.rs`). A path samples the cones
/// to these spheres or its BSDF, and is weighted by the density of the mixture (`local_guide.rs`). So missing or
/// inaccurate photons add noise but no bias, and no part of the guide has to be exact.
///
/// It depends on the scene alone, neither on the camera nor on the number of threads. [`Guide::learned`] makes another
/// from paths from the camera (`training.rs`), which also aims at small openings (`portals.rs`).
#[derive(Debug)]
pub struct Guide {
    cells: Cells,
}

impl Guide {
    /// Return the guide of a scene, which caches it. Photons are traced on the first call. Return `None` if no light
    /// arrives through specular surfaces, or after a cancellation.
    pub fn of(scene: &Scene, cancel: &Cancel) -> Option<Arc<Self>> {
        let sent = || {
            let photons = photon_tracing::photons(scene, cancel)?;
            let usual = photon_tracing::usual(scene, &photons);
            Some(Self::of_photons(photons, usual).map(Arc::new))
        };
        scene.kept(sent).and_then(|guide| (*guide).clone())
    }

    /// Make the guide from photons and the mean direct irradiance at them; `None` without photons.
    fn of_photons(photons: Vec<Photon>, usual: f64) -> Option<Self> {
        (!photons.is_empty()).then(|| Self { cells: Cells::of_photons(photons, usual) })
    }

    /// Make the guide from visits in a scene of some radius; `None` if none found indirect light.
    fn of_visits(visits: Vec<Visit>, radius: f64) -> Option<Self> {
        visits.iter().any(|visit| visit.photon.flux > 0.0).then(|| Self { cells: Cells::of_visits(visits, radius) })
    }

    /// Return the guide that learns from a camera's paths. The scene caches the latest. Return `None` if these find no
    /// indirect light, or after a cancellation.
    pub fn learned(scene: &Scene, camera: &dyn Camera, cancel: &Cancel) -> Option<Arc<Self>> {
        let view = View::of(camera);
        let kept = scene.kept(|| Some(Learned::default()))?;
        let lock = || kept.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, guide)) = lock().as_ref().filter(|(known, _)| *known == view) {
            return guide.clone();
        }
        // Trained outside the lock: a thread that waits for others may take up their tasks, and those may call this
        // function.
        let photons = if scene.plan().needs().scattering { Self::of(scene, cancel) } else { None };
        let guide = training::train(scene, camera, photons.as_deref(), cancel).map(Arc::new);
        if !cancel.is_raised() {
            *lock() = Some((view, guide.clone()));
        }
        guide
    }

    /// Return the distribution of directions at a place; `None` far from any photon.
    #[inline]
    pub fn at(&self, place: DVec3) -> Option<LocalGuide<'_>> {
        self.cells.find(place).map(|cell| LocalGuide::new(cell, place))
    }
}

/// The latest guide of [`Guide::learned`].
#[derive(Default)]
struct Learned(Mutex<Option<(View, Option<Arc<Guide>>)>>);

/// Some rays of a camera, which tell it from others.
#[derive(PartialEq)]
struct View(Vec<[u64; 7]>);

impl View {
    fn of(camera: &dyn Camera) -> Self {
        let size = [camera.width(), camera.height()].map(f64::from);
        let ray = |number| {
            let mut sampler = Sampler::new(0, number, 0);
            let ([x, y], lens, time) = (sampler.two(0), sampler.two(1), sampler.one(2));
            let ray = camera.ray([x * size[0], y * size[1]], lens, time).ray;
            let ([a, b, c], [d, e, f]) = (ray.origin.to_array(), ray.direction.to_array());
            [a, b, c, d, e, f, ray.time].map(f64::to_bits)
        };
        Self((0..16).map(ray).collect())
    }
}

/// Return whether a surface scatters so widely that guiding pays: not in delta directions alone, nor in a narrow lobe,
/// which is better sampled itself, nor to both sides.
#[inline]
pub fn is_matt<S: Bsdf>(bsdf: &S) -> bool {
    /// Maximum roughness of a specular surface.
    const SHARP: f64 = 0.2;
    let roughness = bsdf.roughness();
    !bsdf.is_delta() && !bsdf.transmits() && (roughness == 0.0 || roughness > SHARP)
}
