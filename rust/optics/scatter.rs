//! What is asked of every kind of scattering.

use super::Rgb;
use glam::DVec3;

/// What a kind of scattering is asked.
///
/// Directions are unit vectors in the shading frame, z along the normal, both pointing away from the surface: `wo` to
/// where the light goes, `wi` to where it comes from. A kind that only reflects does so on both sides. One that
/// transmits knows by the sign of `wo.z` on which side it is: above (z > 0) or below.
///
/// What scatters is radiance: where light crosses to another index of refraction, what is evaluated and every weight
/// have the factor 1 / η² in them, with η the index where the light comes from over that where it goes to
/// (Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, 5.2).
pub trait Scatter {
    /// The scattering function times |cos θ| of `wi`, and the density in solid angle with which [`Scatter::sample`]
    /// draws `wi`, both without what has a single direction. Whoever asks for the one mostly needs the other, and much
    /// of the work is the same.
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64);

    /// Draws where the light comes from: `choice`, uniform in [0, 1), among the parts that scattering has (only asked
    /// for when it has several), `u` for the direction. `None` if the draw scatters nothing.
    fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample>;

    /// Computes beforehand what goes by `wo` alone: several questions are to follow that have the same.
    fn prepare(&mut self, _wo: DVec3) {}

    /// About the share of white light that is scattered, for pictures of it: that of even light where the kind knows
    /// it.
    fn albedo(&self) -> Rgb;

    /// What all of it is to be multiplied by for light that came to such a surface before: 1 unless it scatters more
    /// than there is, in a channel ([`super::conductors::Curve::again`]).
    fn again(&self) -> Rgb {
        Rgb::ONE
    }

    /// Whether all of it goes in single directions, so that [`Scatter::evaluate`] is 0 everywhere.
    fn is_delta(&self) -> bool {
        false
    }

    /// Whether light goes through to the other side.
    fn transmits(&self) -> bool {
        false
    }

    /// How rough its sharpest part is, as the α of a microfacet distribution: 0 for single directions, 1 for what is
    /// about as wide as a hemisphere.
    fn roughness(&self) -> f64 {
        1.0
    }
}

/// A direction drawn from a [`super::Bsdf`].
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Where the light comes from.
    pub wi: DVec3,
    /// Scattering function times cosine over density: what the path's throughput is multiplied by.
    pub weight: Rgb,
    /// Density in solid angle. Infinite where a single direction has all of it, as with a mirror: weighed against any
    /// other way to find this direction, such a sample then gets all the weight.
    pub pdf: f64,
    /// The index of refraction on the side of `wi` over that on the side of `wo`: 1 unless light is refracted. A weight
    /// has 1 / eta² in it, which Russian roulette should not take for light lost.
    pub eta: f64,
}

impl BsdfSample {
    /// One that stays in its medium.
    #[inline]
    pub(super) fn new(wi: DVec3, weight: Rgb, pdf: f64) -> Self {
        Self { wi, weight, pdf, eta: 1.0 }
    }

    /// A single direction, in the same medium.
    #[inline]
    pub(super) fn delta(wi: DVec3, weight: Rgb) -> Self {
        Self::new(wi, weight, f64::INFINITY)
    }
}
