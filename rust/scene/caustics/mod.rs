//! Where light comes from by way of mirrors and glass.

mod aim;
mod cells;
mod lobe;
mod photon;
#[cfg(test)]
mod tests;

pub use aim::Aim;
pub(super) use photon::Photon;

use super::Scatters;
use crate::math::DVec3;
use cells::Cells;

/// Where light comes from, to the places of a scene, by way of mirrors and glass: paths that want to find it had better
/// go where photons came from (Jensen, "Importance Driven Path Tracing using the Photon Map", 1995).
///
/// A path from a matt surface finds a lamp behind a ball of glass only by chance, the less often the smaller the lamp's
/// image, and each time it counts for the more: the fireflies of path tracing. The lamp cannot be asked, for nothing
/// goes straight to it. So photons are sent from the lights to what is sharp, and followed to where they fall
/// (`scene/photons.rs`); places are divided into cells of about as many of them (`cells.rs`), and photons of a cell
/// that came by the same surfaces are taken together for a ball that light comes from (`lobe.rs`). A path draws its
/// direction from the cones to these or from its surface, and is weighed by the density of both together (`aim.rs`). So
/// photons that are missing, or wrong, make a picture noisier and never another one, and nothing about them need be
/// exact.
///
/// It depends on the scene alone: not on the camera, nor on threads.
#[derive(Debug)]
pub struct Caustics {
    cells: Cells,
}

impl Caustics {
    /// What photons tell of it, and how much light comes straight from lights to where they have fallen, over area, on
    /// average; `None` where no photon has come anywhere by way of what is sharp.
    pub(super) fn new(photons: Vec<Photon>, usual: f64) -> Option<Self> {
        (!photons.is_empty()).then(|| Self { cells: Cells::new(photons, usual) })
    }

    /// Where light comes to a place from; `None` where no photon has been about.
    #[inline]
    pub fn aim(&self, place: DVec3) -> Option<Aim<'_>> {
        self.cells.find(place).map(|cell| Aim::new(cell, place))
    }
}

/// Whether a surface scatters light so widely that it is worth while to aim: not in single directions alone, nor in a
/// lobe that knows better where light matters, nor to both sides.
#[inline]
pub fn is_matt<S: Scatters>(scattering: &S) -> bool {
    /// The roughness of what is sharp, at most.
    const SHARP: f64 = 0.2;
    let roughness = scattering.roughness();
    !scattering.is_delta() && !scattering.transmits() && (roughness == 0.0 || roughness > SHARP)
}
