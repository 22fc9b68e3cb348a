//! Path guiding toward light through mirrors and glass.

mod cells;
mod lobe;
mod local_guide;
mod photon;
mod photon_tracing;
#[cfg(test)]
mod tests;

pub use local_guide::LocalGuide;

use cells::Cells;
use photon::Photon;
use raywright_base::math::DVec3;
use raywright_base::workers::Cancel;
use raywright_optics::Bsdf;
use raywright_scene::Scene;
use std::sync::Arc;

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
/// It depends on the scene alone, neither on the camera nor on the number of threads.
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
            Some(Self::new(photons, usual).map(Arc::new))
        };
        scene.kept(sent).and_then(|guide| (*guide).clone())
    }

    /// Make the guide from photons and the mean direct irradiance at them; `None` without photons.
    fn new(photons: Vec<Photon>, usual: f64) -> Option<Self> {
        (!photons.is_empty()).then(|| Self { cells: Cells::new(photons, usual) })
    }

    /// Return the distribution of directions at a place; `None` far from any photon.
    #[inline]
    pub fn at(&self, place: DVec3) -> Option<LocalGuide<'_>> {
        self.cells.find(place).map(|cell| LocalGuide::new(cell, place))
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
