//! Light that has come to a matt surface by way of sharp ones.

use raywright_base::math::DVec3;

/// Light that has come to a place.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Where it fell, just off the surface.
    pub position: DVec3,
    /// The shading normal there, on its side.
    pub normal: DVec3,
    /// The last surface before, that it came from.
    pub target: DVec3,
    /// About how much light it stands for, W, a mean of the channels.
    pub flux: f64,
    /// Tells by which surfaces it came, since the light or a matt one.
    pub chain: u64,
}
