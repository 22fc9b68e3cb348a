//! Where light comes from by way of mirrors and glass.

mod cells;
mod flight;
mod lobe;
mod local;
mod photon;
#[cfg(test)]
mod tests;

pub use local::LocalGuide;

use cells::Cells;
use photon::Photon;
use raywright_base::math::DVec3;
use raywright_base::workers::Cancel;
use raywright_optics::Bsdf;
use raywright_scene::Scene;
use std::sync::Arc;

/// Where light comes from, to the places of a scene, by way of mirrors and glass: paths that want to find it had better
/// go where photons came from (Jensen, "Importance Driven Path Tracing using the Photon Map", 1995).
///
/// A path from a matt surface finds a lamp behind a ball of glass only by chance, the less often the smaller the lamp's
/// image, and each time it counts for the more: the fireflies of path tracing. The lamp cannot be asked, for nothing
/// goes straight to it. So photons are sent from the lights to what is sharp, and followed to where they fall
/// (`flight.rs`); places are divided into cells of about as many of them (`cells.rs`), and photons of a cell
/// that came by the same surfaces are taken together for a ball that light comes from (`lobe.rs`). A path draws its
/// direction from the cones to these or from its surface, and is weighed by the density of both together
/// (`local.rs`). So photons that are missing, or wrong, make a picture noisier and never another one, and nothing about
/// them need be exact.
///
/// It depends on the scene alone: not on the camera, nor on threads.
#[derive(Debug)]
pub struct Guide {
    cells: Cells,
}

impl Guide {
    /// That of a scene, which keeps it. Photons are sent when it is first asked for. `None` where none comes anywhere
    /// by way of what is sharp, and when it is cancelled before all have come.
    pub fn of(scene: &Scene, cancel: &Cancel) -> Option<Arc<Self>> {
        let sent = || {
            let photons = flight::photons(scene, cancel)?;
            let usual = flight::usual(scene, &photons);
            Some(Self::new(photons, usual).map(Arc::new))
        };
        scene.kept(sent).and_then(|guide| (*guide).clone())
    }

    /// What photons tell of it, and how much light comes straight from lights to where they have fallen, over area, on
    /// average; `None` without photons.
    fn new(photons: Vec<Photon>, usual: f64) -> Option<Self> {
        (!photons.is_empty()).then(|| Self { cells: Cells::new(photons, usual) })
    }

    /// Where light comes to a place from; `None` where no photon has been about.
    #[inline]
    pub fn at(&self, place: DVec3) -> Option<LocalGuide<'_>> {
        self.cells.find(place).map(|cell| LocalGuide::new(cell, place))
    }
}

/// Whether a surface scatters light so widely that it is worth while to aim: not in single directions alone, nor in a
/// lobe that knows better where light matters, nor to both sides.
#[inline]
pub fn is_matt<S: Bsdf>(bsdf: &S) -> bool {
    /// The roughness of what is sharp, at most.
    const SHARP: f64 = 0.2;
    let roughness = bsdf.roughness();
    !bsdf.is_delta() && !bsdf.transmits() && (roughness == 0.0 || roughness > SHARP)
}
