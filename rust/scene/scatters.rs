//! What an encounter with a surface asks of how it scatters light.

use super::materials::Scattering;
use crate::math::DVec3;
use crate::optics::{Bsdf, BsdfSample, Diffuse, Rgb, Scatter};

/// What an encounter asks of the scattering at its point. Directions as [`Bsdf`] has them.
pub trait Scatters {
    /// The scattering function times |cos θ| of `wi`, and the density with which it is drawn.
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64);

    /// Draws where the light comes from.
    fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample>;

    /// Whether light goes through to the other side.
    fn transmits(&self) -> bool;

    /// Whether all of it goes in single directions.
    fn is_delta(&self) -> bool;

    /// What is reflected, if that is the same into every direction.
    fn diffuse(&self) -> Option<Rgb>;

    /// How rough its sharpest part is ([`Bsdf::roughness`]).
    fn roughness(&self) -> f64;

    /// What of it is left for light that came to such a surface before ([`Bsdf::again`]).
    fn again(&self) -> Rgb;
}

impl<S: Scatters> Scatters for &S {
    #[inline(always)]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        (**self).evaluate(wo, wi)
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        (**self).sample(wo, choice, u)
    }

    #[inline(always)]
    fn transmits(&self) -> bool {
        (**self).transmits()
    }

    #[inline(always)]
    fn is_delta(&self) -> bool {
        (**self).is_delta()
    }

    #[inline(always)]
    fn diffuse(&self) -> Option<Rgb> {
        (**self).diffuse()
    }

    #[inline(always)]
    fn roughness(&self) -> f64 {
        (**self).roughness()
    }

    #[inline(always)]
    fn again(&self) -> Rgb {
        (**self).again()
    }
}

impl Scatters for Scattering {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        Self::evaluate(self, wo, wi)
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        Self::sample(self, wo, choice, u)
    }

    #[inline]
    fn transmits(&self) -> bool {
        match self {
            Self::One(bsdf) => bsdf.transmits(),
            Self::Several(parts) => parts.iter().any(|(_, bsdf)| bsdf.transmits()),
        }
    }

    #[inline]
    fn is_delta(&self) -> bool {
        match self {
            Self::One(bsdf) => bsdf.is_delta(),
            Self::Several(parts) => parts.iter().all(|(_, bsdf)| bsdf.is_delta()),
        }
    }

    #[inline]
    fn diffuse(&self) -> Option<Rgb> {
        if let Self::One(bsdf) = self { Scatters::diffuse(bsdf) } else { None }
    }

    #[inline]
    fn roughness(&self) -> f64 {
        Self::roughness(self)
    }

    #[inline]
    fn again(&self) -> Rgb {
        Self::again(self)
    }
}

impl Scatters for Diffuse {
    #[inline(always)]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        Scatter::evaluate(self, wo, wi)
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        Scatter::sample(self, wo, choice, u)
    }

    #[inline(always)]
    fn transmits(&self) -> bool {
        false
    }

    #[inline(always)]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline(always)]
    fn diffuse(&self) -> Option<Rgb> {
        Some(self.reflectance)
    }

    #[inline(always)]
    fn roughness(&self) -> f64 {
        Scatter::roughness(self)
    }

    #[inline(always)]
    fn again(&self) -> Rgb {
        Rgb::ONE
    }
}

impl Scatters for Bsdf {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        Self::evaluate(self, wo, wi)
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: impl FnOnce() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        Self::sample(self, wo, choice, u)
    }

    #[inline]
    fn transmits(&self) -> bool {
        Self::transmits(self)
    }

    #[inline]
    fn is_delta(&self) -> bool {
        Self::is_delta(self)
    }

    #[inline]
    fn diffuse(&self) -> Option<Rgb> {
        if let Self::Diffuse(diffuse) = self { Some(diffuse.reflectance) } else { None }
    }

    #[inline]
    fn roughness(&self) -> f64 {
        Self::roughness(self)
    }

    #[inline]
    fn again(&self) -> Rgb {
        Self::again(self)
    }
}
