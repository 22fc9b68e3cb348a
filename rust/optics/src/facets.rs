//! Surfaces made of small mirrors: one interface over all distributions of them.

use raywright_base::math::DVec3;
use std::fmt::Debug;

/// Small mirrors, each with its own slope, independent of each other and of their heights: what is hidden of them is
/// Smith's (Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", 2014). Their slopes are
/// spread by a roughness α along x and one along y.
///
/// Directions are on the side of the normal: z > 0. Nothing divides by a cosine: where formulas have G / cos θ, these
/// have the length s(ω) = |z| (1 + 2Λ(ω)), which is never 0, so all of it holds up to grazing.
pub trait Facets: Copy + Debug + PartialEq {
    /// Below this roughness a surface is a smooth one: its lobe, 10⁻⁵ radians wide, is sharper than the sun's disk by a
    /// factor of 500, and what it does differently is below 10⁻⁸ of the light except within 10⁻³ of grazing.
    const SMOOTH: f64 = 1e-5;

    /// Of this roughness along x and y, 0 to 1. Where one is below [`Facets::SMOOTH`] it counts as that much.
    fn new(alpha: [f64; 2]) -> Self;

    /// Of a roughness that another has.
    fn with(alpha: [f64; 2]) -> Self;

    /// One for a rough surface, `None` where it is smooth in both directions.
    #[inline(always)]
    fn rough(alpha: [f64; 2]) -> Option<Self> {
        (alpha[0] >= Self::SMOOTH || alpha[1] >= Self::SMOOTH).then(|| Self::new(alpha))
    }

    /// The roughness along x and y.
    fn alpha(&self) -> [f64; 2];

    /// The roughness of the isotropic distribution with as many slopes: √(αx αy).
    #[inline(always)]
    fn mean_alpha(&self) -> f64 {
        let [ax, ay] = self.alpha();
        (ax * ay).sqrt()
    }

    /// The density of facets about the unit normal `h`, per area of the surface and solid angle. Its integral with
    /// cos θ is 1.
    fn density(&self, h: DVec3) -> f64;

    /// The density, as [`Facets::density`] has it, of the facets that mirror one direction to another, and the cosine
    /// to both.
    fn mirroring(&self, wo: DVec3, wi: DVec3) -> (f64, f64);

    /// s(ω).
    fn stretch(&self, w: DVec3) -> f64;

    /// Draws the normal of a facet as seen from `wo`, by two numbers in [0, 1).
    fn sample_visible(&self, wo: DVec3, u: [f64; 2]) -> DVec3;

    /// The share of the facets' area facing `w` that is seen from there: Smith's G₁.
    #[inline(always)]
    fn masking(&self, w: DVec3) -> f64 {
        2.0 * w.z.abs() / (w.z.abs() + self.stretch(w))
    }

    /// G₂(wo, wi) / (4 cos θo): what F D is multiplied by for reflection, with the cosine of `wi` in it. Here facets
    /// that are high are seen from both sides, and low ones from neither: G₂ is correlated by height.
    #[inline(always)]
    fn reflection_geometry(&self, wo: DVec3, wi: DVec3) -> f64 {
        // G₂ = 1 / (1 + Λ(wo) + Λ(wi)), and 1 + 2Λ = s / z.
        0.5 * wi.z / (self.stretch(wo) * wi.z + self.stretch(wi) * wo.z)
    }

    /// G₁(wo) / cos θo, and G₂(wo, wi) / cos θo for light that goes through to `wi` on the other side. Here a
    /// refraction that starts at a facet seen from one side is taken to get out where the facet is seen from the other,
    /// G₂ = min(G₁(wo), G₁(wi)).
    #[inline(always)]
    fn refraction_geometry(&self, wo: DVec3, wi: DVec3) -> [f64; 2] {
        let seen = 2.0 / (wo.z.abs() + self.stretch(wo));
        [seen, seen.min(2.0 * (wi.z / wo.z).abs() / (wi.z.abs() + self.stretch(wi)))]
    }

    /// The density, in solid angle of facet normals, with which [`Facets::sample_visible`] draws `h`.
    #[inline(always)]
    fn visible_pdf(&self, wo: DVec3, h: DVec3) -> f64 {
        self.density(h) * wo.dot(h).max(0.0) * 2.0 / (wo.z + self.stretch(wo))
    }

    /// The density, in solid angle, with which [`Facets::sample_reflection`] draws a direction to which facets of this
    /// density mirror.
    #[inline(always)]
    fn reflected_pdf(&self, wo: DVec3, density: f64) -> f64 {
        // D G₁ (wo · h) / cos θo, over the 4 (wo · h) of mirroring.
        density * 0.5 / (wo.z + self.stretch(wo))
    }

    /// Draws the direction from which a facet that `wo` sees reflects. It may lie below the horizon.
    #[inline(always)]
    fn sample_reflection(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        let h = self.sample_visible(wo, u);
        h * (2.0 * wo.dot(h)) - wo
    }

    /// Whether a direction is far enough from the plane for products of cosines to be numbers: at 10⁻¹⁰⁰ everything is.
    #[inline(always)]
    fn sees(w: DVec3) -> bool {
        w.z.abs() > 1e-100
    }
}
