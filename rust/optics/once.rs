//! Facets that scatter once.

use super::Facets;
use crate::math::DVec3;

/// Facets whose masking and shadowing are independent of each other, G₂ = G₁(wo) G₁(wi), and which give nothing back of what they throw
/// on each other: the model of Walter et al. ("Microfacet Models for Refraction through Rough Surfaces", 2007) as it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Once<F>(F);

impl<F: Facets> Facets for Once<F> {
    #[inline]
    fn new(alpha: [f64; 2]) -> Self {
        Self(F::new(alpha))
    }

    #[inline]
    fn alpha(&self) -> [f64; 2] {
        self.0.alpha()
    }

    #[inline]
    fn density(&self, h: DVec3) -> f64 {
        self.0.density(h)
    }

    #[inline]
    fn mirroring(&self, wo: DVec3, wi: DVec3) -> (f64, f64) {
        self.0.mirroring(wo, wi)
    }

    #[inline]
    fn stretch(&self, w: DVec3) -> f64 {
        self.0.stretch(w)
    }

    #[inline]
    fn sample_visible(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        self.0.sample_visible(wo, u)
    }

    #[inline]
    fn reflection_geometry(&self, wo: DVec3, wi: DVec3) -> f64 {
        // Of either G₁ = 2 z / (z + s).
        wi.z / ((wo.z + self.stretch(wo)) * (wi.z + self.stretch(wi)))
    }

    #[inline]
    fn refraction_geometry(&self, wo: DVec3, wi: DVec3) -> [f64; 2] {
        let seen = 2.0 / (wo.z.abs() + self.stretch(wo));
        [seen, seen * self.masking(wi)]
    }
}
