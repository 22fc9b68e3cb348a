//! A diffuse base under a clear coat: plastic, varnish, glaze.

mod coated_lanes;

use super::albedo::{Coat, Tabulated};
use super::bsdf::either;
use super::conductor::{above, mirrors};
use super::lobes::diffuse;
use super::mirror::mirrored;
use super::{Bsdf, BsdfSample, Facets, Ggx, Rgb, fresnel};
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

/// A dielectric coat, smooth or with microfacets, over a diffuse base. The coat reflects R(ω). The rest reaches the
/// base and is reflected between base and coat any number of times (Wolff, Nayar and Oren, "Improved Diffuse Reflection
/// Models for Computer Vision", 1998). With F̄ the mean internal reflectance of the coat, the base contributes (1 −
/// R(wo)) (1 − R(wi)) / (π (1 − R̄)) ρ (1 − F̄) / (1 − ρ F̄). The BRDF is reciprocal, and a white base is white under
/// any coat. Interreflection between facets of a rough coat is assumed to reach the base. Both sides reflect.
#[derive(Clone, Copy, Debug)]
pub struct Coated<F: Tabulated = Ggx> {
    eta: f64,
    rough: Option<RoughCoat<F>>,
    /// Albedo of the base under the coat.
    base: Rgb,
    /// Mean reflectance of the coat from outside.
    average: f64,
}

#[derive(Clone, Copy, Debug)]
struct RoughCoat<F> {
    facets: F,
    coat: Coat,
}

impl Coated {
    /// Creates the BRDF from a base reflectance, 0 to 1, the coat's relative index of refraction `eta` ≥ 1, and its GGX
    /// roughness, 0 to 1. Below [`Facets::SMOOTH`] the coat is specular.
    pub fn new(reflectance: Rgb, eta: f64, alpha: f64) -> Self {
        Self::of(reflectance, eta, Ggx::rough([alpha; 2]))
    }
}

impl<F: Tabulated> Coated<F> {
    /// Creates the BRDF with isotropic facets; without them the coat is specular.
    pub fn of(reflectance: Rgb, eta: f64, facets: Option<F>) -> Self {
        let eta = fresnel::bounded(eta);
        let rough = facets.map(|facets| RoughCoat { facets, coat: Coat::new(facets, eta) });
        let within = fresnel::dielectric_average(1.0 / eta);
        let average = rough.as_ref().map_or_else(|| fresnel::dielectric_average(eta), |rough| rough.coat.average());
        Self { eta, rough, base: reflectance * (1.0 - within) / (Rgb::ONE - reflectance * within), average }
    }

    /// Reflectance of the coat for direction `w`.
    #[inline]
    fn reflectance(&self, w: DVec3) -> f64 {
        match &self.rough {
            None => fresnel::dielectric(w.z.abs(), self.eta),
            Some(rough) => rough.coat.of(w.z),
        }
    }

    /// Value and density of the base for `wi`, above, from `base` and `average`. `share` is the sampling probability of
    /// the coat; `reflectance` and `there` are the coat's reflectances for `wo` and `wi`.
    #[inline(always)]
    fn matt((base, average): (Rgb, f64), share: f64, wi: DVec3, [reflectance, there]: [f64; 2]) -> (Rgb, f64) {
        let reaching = (1.0 - reflectance) * (1.0 - there);
        (base * (reaching * FRAC_1_PI * wi.z / (1.0 - average)), (1.0 - share) * wi.z * FRAC_1_PI)
    }

    /// Value and density of the coat's facets between two directions above, from the result of [`Facets::mirroring`].
    #[inline(always)]
    fn glossy((facets, eta): (&F, f64), share: f64, [wo, wi]: [DVec3; 2], (density, cosine): (f64, f64)) -> (f64, f64) {
        let coat = fresnel::dielectric(cosine, eta) * density * facets.reflection_geometry(wo, wi);
        (coat, share * facets.reflected_pdf(wo, density))
    }

    /// Sampling probability of the coat, from its reflectance.
    #[inline]
    fn share(&self, reflectance: f64) -> f64 {
        let base = self.base.max() * (1.0 - reflectance);
        if reflectance > 0.0 { reflectance / (reflectance + base) } else { 0.0 }
    }
}

impl<F: Tabulated> Bsdf for Coated<F> {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        if !mirrors::<F>(wo, wi) {
            return (Rgb::ZERO, 0.0);
        }
        let (wo, wi) = (above(wo), above(wi));
        let reflectance = self.reflectance(wo);
        let share = self.share(reflectance);
        let (base, diffuse) = Self::matt((self.base, self.average), share, wi, [reflectance, self.reflectance(wi)]);
        let Some(RoughCoat { facets, .. }) = &self.rough else { return (base, diffuse) };
        let (coat, glossy) = Self::glossy((facets, self.eta), share, [wo, wi], facets.mirroring(wo, wi));
        (base + coat, glossy + diffuse)
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if !F::sees(wo) {
            return None;
        }
        let up = above(wo);
        let reflectance = self.reflectance(up);
        let share = self.share(reflectance);
        let coat = choice() < share;
        let mut wi = match &self.rough {
            None if coat => {
                let weight = Rgb::splat(reflectance / share);
                return Some(BsdfSample::delta(mirrored(wo), weight).of_lobe([0.0, share]));
            }
            Some(rough) if coat => rough.facets.sample_reflection(up, u),
            _ => diffuse(up, u),
        };
        if wi.z <= 0.0 {
            return None;
        }
        wi.z = wi.z.copysign(wo.z);
        let (value, pdf) = self.evaluate(wo, wi);
        (pdf > 0.0).then(|| BsdfSample::new(wi, value / pdf, pdf).of_lobe(either(share, coat)))
    }

    fn albedo(&self) -> Rgb {
        Rgb::splat(self.average) + self.base * (1.0 - self.average)
    }

    fn roughness(&self) -> f64 {
        self.rough.as_ref().map_or(0.0, |rough| rough.facets.mean_alpha())
    }
}
