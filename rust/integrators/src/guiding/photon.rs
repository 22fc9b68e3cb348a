//! Guiding photons.

use raywright_base::math::DVec3;

/// A photon on a matte surface that arrived through specular ones.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Position just off the surface.
    pub position: DVec3,
    /// Shading normal on the side of incidence.
    pub normal: DVec3,
    /// Position on the last specular surface.
    pub target: DVec3,
    /// Approximate flux, W, averaged over the channels.
    pub flux: f64,
    /// Hash of the specular surfaces since the light or the last matte surface.
    pub chain: u64,
}
