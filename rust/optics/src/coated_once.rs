//! Plastic with a single-scattering coat.

use super::bsdf::either;
use super::bsdf_columns::LaneBsdf;
use super::conductor::above;
use super::lobes::diffuse;
use super::scalar_lanes::Looped;
use super::{Bsdf, BsdfSample, Facets, Once, Rgb, Through, fresnel};
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

/// A rough dielectric coat over a diffuse base, with single scattering. Light refracted by a facet reaches the base.
/// From there it leaves through another facet or is reflected back, any number of times. With T the transmittance from
/// outside and F̄ the mean internal reflectance, the base contributes ρ T(wo) T(wi) / (π η² (1 − ρ F̄)).
/// Interreflection between facets is lost at each scattering. Both sides reflect.
#[derive(Clone, Copy, Debug)]
pub struct CoatedOnce<F> {
    eta: f64,
    facets: Once<F>,
    through: Through,
    /// ρ / (η² (1 − ρ F̄)).
    base: Rgb,
}

impl<F: Facets> CoatedOnce<F> {
    /// Creates the BRDF from a base reflectance, 0 to 1, the coat's relative index of refraction `eta` ≥ 1, its facets,
    /// and their transmittance.
    pub fn new(reflectance: Rgb, eta: f64, facets: Once<F>, through: Through) -> Self {
        let eta = fresnel::bounded(eta);
        let base = reflectance / (Rgb::ONE - reflectance * through.within()) / (eta * eta);
        Self { eta, facets, through, base }
    }

    /// Sampling probability of the coat, from its transmittance.
    #[inline(always)]
    fn share(&self, through: f64) -> f64 {
        let base = self.base.max() * self.through.average() * through;
        let coat = 1.0 - through;
        if coat > 0.0 { coat / (coat + base) } else { 0.0 }
    }
}

impl<F: Facets> Bsdf for CoatedOnce<F> {
    #[inline(always)]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        if !F::sees(wo) || !F::sees(wi) || wo.z * wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let (wo, wi) = (above(wo), above(wi));
        let through = self.through.share(wo.z);
        let share = self.share(through);
        let base = self.base * (through * self.through.share(wi.z) * FRAC_1_PI * wi.z);
        let (density, cosine) = self.facets.mirroring(wo, wi);
        let coat = fresnel::dielectric(cosine, self.eta) * density * self.facets.reflection_geometry(wo, wi);
        (base + coat, share * self.facets.reflected_pdf(wo, density) + (1.0 - share) * wi.z * FRAC_1_PI)
    }

    #[inline(always)]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if !F::sees(wo) {
            return None;
        }
        let up = above(wo);
        let share = self.share(self.through.share(up.z));
        let coat = choice() < share;
        let mut wi = if coat { self.facets.sample_reflection(up, u) } else { diffuse(up, u) };
        if wi.z <= 0.0 {
            return None;
        }
        wi.z = wi.z.copysign(wo.z);
        let (value, pdf) = self.evaluate(wo, wi);
        (pdf > 0.0).then(|| BsdfSample::new(wi, value / pdf, pdf).of_lobe(either(share, coat)))
    }

    fn albedo(&self) -> Rgb {
        let through = self.through.average();
        Rgb::splat(1.0 - through) + self.base * (through * through)
    }

    fn roughness(&self) -> f64 {
        self.facets.mean_alpha()
    }
}

impl<F: Facets> LaneBsdf for CoatedOnce<F> {
    type Lanes = Looped;
}
