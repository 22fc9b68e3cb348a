//! Interface of microfacet distributions.

use raywright_base::math::DVec3;
use std::fmt::Debug;

/// A distribution of microfacets with independent slopes and heights, so that masking is Smith's (Heitz, "Understanding
/// the Masking-Shadowing Function in Microfacet-Based BRDFs", 2014). Roughness is α along x and y.
///
/// Directions are on the side of the normal: z > 0. Nothing divides by a cosine. Where formulas have G / cos θ, this
/// code uses the length s(ω) = |z| (1 + 2Λ(ω)), which is never 0, so everything is valid up to grazing incidence.
pub trait Facets: Copy + Debug + PartialEq {
    /// Below this roughness a surface is smooth. Its lobe, 10⁻⁵ radians wide, is sharper than the sun's disk by a
    /// factor of 500; the energy difference is below 10⁻⁸ except within 10⁻³ of grazing.
    const SMOOTH: f64 = 1e-5;

    /// Creates facets with this roughness along x and y, 0 to 1. A roughness below [`Facets::SMOOTH`] is raised to it.
    fn new(alpha: [f64; 2]) -> Self;

    /// Creates facets with the roughness of existing ones.
    fn with(alpha: [f64; 2]) -> Self;

    /// Creates facets of a rough surface; `None` if it is smooth in both directions.
    #[inline(always)]
    fn rough(alpha: [f64; 2]) -> Option<Self> {
        (alpha[0] >= Self::SMOOTH || alpha[1] >= Self::SMOOTH).then(|| Self::new(alpha))
    }

    /// Roughness along x and y.
    fn alpha(&self) -> [f64; 2];

    /// Roughness of the isotropic distribution with equal density at the normal: √(αx αy).
    #[inline(always)]
    fn mean_alpha(&self) -> f64 {
        let [ax, ay] = self.alpha();
        (ax * ay).sqrt()
    }

    /// Density of facets about the unit normal `h`, per surface area and solid angle. Its integral with cos θ is 1.
    fn density(&self, h: DVec3) -> f64;

    /// [`Facets::density`] of the facets that mirror one direction to another, and the cosine to both.
    fn mirroring(&self, wo: DVec3, wi: DVec3) -> (f64, f64);

    /// s(ω).
    fn stretch(&self, w: DVec3) -> f64;

    /// Samples the normal of a facet visible from `wo`, by two numbers in [0, 1).
    fn sample_visible(&self, wo: DVec3, u: [f64; 2]) -> DVec3;

    /// Visible share of the facets' area that faces `w`: Smith's G₁.
    #[inline(always)]
    fn masking(&self, w: DVec3) -> f64 {
        2.0 * w.z.abs() / (w.z.abs() + self.stretch(w))
    }

    /// G₂(wo, wi) / (4 cos θo): the factor on F D for reflection, including the cosine of `wi`. G₂ is
    /// height-correlated: high facets are visible from both sides, and low ones from neither.
    #[inline(always)]
    fn reflection_geometry(&self, wo: DVec3, wi: DVec3) -> f64 {
        // G₂ = 1 / (1 + Λ(wo) + Λ(wi)), and 1 + 2Λ = s / z.
        0.5 * wi.z / (self.stretch(wo) * wi.z + self.stretch(wi) * wo.z)
    }

    /// G₁(wo) / cos θo, and G₂(wo, wi) / cos θo for transmission to `wi` on the other side. A refraction at a visible
    /// facet is assumed to escape if the facet is visible from the other side, G₂ = min(G₁(wo), G₁(wi)).
    #[inline(always)]
    fn refraction_geometry(&self, wo: DVec3, wi: DVec3) -> [f64; 2] {
        let seen = 2.0 / (wo.z.abs() + self.stretch(wo));
        [seen, seen.min(2.0 * (wi.z / wo.z).abs() / (wi.z.abs() + self.stretch(wi)))]
    }

    /// Density of [`Facets::sample_visible`] for `h`, by solid angle of facet normals.
    #[inline(always)]
    fn visible_pdf(&self, wo: DVec3, h: DVec3) -> f64 {
        self.density(h) * wo.dot(h).max(0.0) * 2.0 / (wo.z + self.stretch(wo))
    }

    /// Density of [`Facets::sample_reflection`] by solid angle, for facets of this density.
    #[inline(always)]
    fn reflected_pdf(&self, wo: DVec3, density: f64) -> f64 {
        // D G₁ (wo · h) / cos θo, over the Jacobian 4 (wo · h) of reflection.
        density * 0.5 / (wo.z + self.stretch(wo))
    }

    /// Samples an incident direction by reflection at a visible facet. It may be below the horizon.
    #[inline(always)]
    fn sample_reflection(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        let h = self.sample_visible(wo, u);
        h * (2.0 * wo.dot(h)) - wo
    }

    /// Returns whether a direction is far enough from the tangent plane for products of cosines not to underflow:
    /// with a cosine above 10⁻¹⁰⁰.
    #[inline(always)]
    fn sees(w: DVec3) -> bool {
        w.z.abs() > 1e-100
    }
}
