//! What scatters light at a point: one interface over all kinds.

use super::{Diffuse, Rgb};
use glam::DVec3;

/// The bidirectional scattering distribution function at a point of a surface.
///
/// Directions are unit vectors in the shading frame, z along the normal, both pointing away from the surface: `wo`
/// to where the light goes, `wi` to where it comes from. A kind of scattering is one variant and one file; a batch
/// calls it through a `match`, which predicts well and inlines, rather than through a pointer.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf {
    /// Lambert's: equally bright from everywhere.
    Diffuse(Diffuse),
}

/// A direction drawn from a [`Bsdf`].
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Where the light comes from.
    pub wi: DVec3,
    /// Scattering function times cosine over density: what the path's throughput is multiplied by.
    pub weight: Rgb,
    /// Density in solid angle. Infinite where a single direction has all of it, as with a mirror: weighed against any
    /// other way to find this direction, such a sample then gets all the weight.
    pub pdf: f64,
}

impl Bsdf {
    /// The scattering function times |cos θ| of `wi`, without what has a single direction.
    #[inline]
    pub fn evaluate(&self, wo: DVec3, wi: DVec3) -> Rgb {
        match self {
            Self::Diffuse(diffuse) => diffuse.evaluate(wo, wi),
        }
    }

    /// The density in solid angle with which [`Bsdf::sample`] draws `wi`, without what has a single direction.
    #[inline]
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        match self {
            Self::Diffuse(diffuse) => diffuse.pdf(wo, wi),
        }
    }

    /// Draws where the light comes from: `choice` among the parts that scattering has (only asked for when it has
    /// several), `u` for the direction. `None` if the draw scatters nothing.
    #[inline]
    pub fn sample(&self, wo: DVec3, _choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        match self {
            Self::Diffuse(diffuse) => diffuse.sample(wo, u),
        }
    }
}

impl From<Diffuse> for Bsdf {
    fn from(diffuse: Diffuse) -> Self {
        Self::Diffuse(diffuse)
    }
}
