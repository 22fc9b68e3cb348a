//! Bidirectional scattering distribution functions: what is asked of each, and what is drawn from it.

use super::Rgb;
use glam::DVec3;

/// The bidirectional scattering distribution function at a point of a surface.
///
/// Directions are unit vectors in the shading frame, z along the normal, both pointing away from the surface: `wo` to
/// where the light goes, `wi` to where it comes from. What only reflects does so on both sides. What transmits knows by
/// the sign of `wo.z` on which side it is: above (z > 0) or below.
///
/// What scatters is radiance: where light crosses to another index of refraction, what is evaluated and every weight
/// have the factor 1 / η² in them, with η the index where the light comes from over that where it goes to
/// (Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, 5.2).
pub trait Bsdf {
    /// The function times |cos θ| of `wi`, and the density in solid angle with which [`Bsdf::sample`] draws `wi`, both
    /// without what has a single direction. Whoever asks for the one mostly needs the other, and much of the work is
    /// the same.
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64);

    /// Draws where the light comes from: `choice`, uniform in [0, 1), among the lobes that it has (only asked for when
    /// there are several), `u` for the direction. `None` if the draw scatters nothing. Single directions have the least
    /// choices.
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample>;

    /// About the share of white light that is scattered, for pictures of it: that of even light where it is known.
    fn albedo(&self) -> Rgb;

    /// What all of it is to be multiplied by for light that came to such a surface before: 1 unless it scatters more
    /// than there is, in a channel ([`super::conductors::Curve::again`]).
    #[inline(always)]
    fn again(&self) -> Rgb {
        Rgb::ONE
    }

    /// Whether all of it goes in single directions, so that [`Bsdf::evaluate`] is 0 everywhere.
    #[inline(always)]
    fn is_delta(&self) -> bool {
        false
    }

    /// Whether light goes through to the other side.
    #[inline(always)]
    fn transmits(&self) -> bool {
        false
    }

    /// How rough its sharpest lobe is, as the α of a microfacet distribution: 0 for single directions, 1 for what is
    /// about as wide as a hemisphere.
    #[inline(always)]
    fn roughness(&self) -> f64 {
        1.0
    }

    /// What is reflected, if that is the same into every direction.
    #[inline(always)]
    fn diffuse(&self) -> Option<Rgb> {
        None
    }
}

/// One that is borrowed.
impl<B: Bsdf> Bsdf for &B {
    #[inline(always)]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        (**self).evaluate(wo, wi)
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        (**self).sample(wo, choice, u)
    }

    #[inline(always)]
    fn albedo(&self) -> Rgb {
        (**self).albedo()
    }

    #[inline(always)]
    fn again(&self) -> Rgb {
        (**self).again()
    }

    #[inline(always)]
    fn is_delta(&self) -> bool {
        (**self).is_delta()
    }

    #[inline(always)]
    fn transmits(&self) -> bool {
        (**self).transmits()
    }

    #[inline(always)]
    fn roughness(&self) -> f64 {
        (**self).roughness()
    }

    #[inline(always)]
    fn diffuse(&self) -> Option<Rgb> {
        (**self).diffuse()
    }
}

/// A direction drawn from a [`Bsdf`].
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Where the light comes from: in the shading frame, or in the world where an encounter with a surface drew it.
    pub wi: DVec3,
    /// Scattering function times cosine over density: what the path's throughput is multiplied by.
    pub weight: Rgb,
    /// Density in solid angle. Infinite where a single direction has all of it, as with a mirror: weighed against any
    /// other way to find this direction, such a sample then gets all the weight.
    pub pdf: f64,
    /// The index of refraction on the side of `wi` over that on the side of `wo`: 1 unless light is refracted. A weight
    /// has 1 / eta² in it, which Russian roulette should not take for light lost.
    pub eta: f64,
    /// Whether `wi` is on the other side of the surface than `wo`.
    pub is_through: bool,
    /// The choices, from and up to but not with, that lead to the lobe that it was drawn from.
    pub choices: [f64; 2],
}

impl BsdfSample {
    /// One on the side of `wo`, from the only lobe.
    #[inline(always)]
    pub fn new(wi: DVec3, weight: Rgb, pdf: f64) -> Self {
        Self { wi, weight, pdf, eta: 1.0, is_through: false, choices: [0.0, 1.0] }
    }

    /// A single direction on the side of `wo`, from the only lobe.
    #[inline(always)]
    pub(super) fn delta(wi: DVec3, weight: Rgb) -> Self {
        Self::new(wi, weight, f64::INFINITY)
    }

    /// The same on the other side, where the index of refraction is so many times as large.
    #[inline(always)]
    pub(super) fn through(self, eta: f64) -> Self {
        Self { eta, is_through: true, ..self }
    }

    /// The same of the lobe that has these choices.
    #[inline(always)]
    pub(super) fn of_lobe(self, choices: [f64; 2]) -> Self {
        Self { choices, ..self }
    }

    /// The probability of the lobe that it was drawn from.
    #[inline]
    pub fn probability(&self) -> f64 {
        self.choices[1] - self.choices[0]
    }

    /// Whether it is a single direction.
    #[inline]
    pub fn is_delta(&self) -> bool {
        self.pdf == f64::INFINITY
    }
}

/// The choices of the first of two lobes, of this probability, or of the second.
#[inline(always)]
pub(super) fn either(first: f64, is_first: bool) -> [f64; 2] {
    if is_first { [0.0, first] } else { [first, 1.0] }
}
