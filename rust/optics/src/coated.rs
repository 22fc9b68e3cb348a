//! Plastic, varnish, glaze: a matt base under a clear coat.

mod lanes;

use super::albedo::{Coat, Tabulated};
use super::bsdf::either;
use super::conductor::{above, mirrors};
use super::lobes::diffuse;
use super::mirror::mirrored;
use super::{Bsdf, BsdfSample, Facets, Ggx, Rgb, fresnel};
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

/// A dielectric coat, smooth or with microfacets, over a diffuse base. The coat reflects R(ω); the rest reaches the
/// base, and light from there is reflected back to it under the coat any number of times (Wolff, Nayar and Oren,
/// "Improved Diffuse Reflection Models for Computer Vision", 1998): with F̄ the mean reflectance of the coat from
/// within, (1 − R(wo)) (1 − R(wi)) / (π (1 − R̄)) ρ (1 − F̄) / (1 − ρ F̄). Reciprocal, and a white base is white under
/// any coat. Light that a rough coat's facets throw on facets is taken to reach the base. Both sides reflect.
#[derive(Clone, Copy, Debug)]
pub struct Coated<F: Tabulated = Ggx> {
    eta: f64,
    rough: Option<Rough<F>>,
    /// What the base gives back of the light that reaches it.
    base: Rgb,
    /// Mean reflectance of the coat from outside.
    average: f64,
}

#[derive(Clone, Copy, Debug)]
struct Rough<F> {
    facets: F,
    coat: Coat,
}

impl Coated {
    /// Of a base's reflectance, 0 to 1, the coat's index of refraction relative to what is outside, `eta` ≥ 1, and its
    /// roughness of GGX, 0 to 1. Below [`Facets::SMOOTH`] it reflects in one direction.
    pub fn new(reflectance: Rgb, eta: f64, alpha: f64) -> Self {
        Self::of(reflectance, eta, Ggx::rough([alpha; 2]))
    }
}

impl<F: Tabulated> Coated<F> {
    /// Of facets that are alike in all directions; without them the coat reflects in one direction.
    pub fn of(reflectance: Rgb, eta: f64, facets: Option<F>) -> Self {
        let eta = fresnel::bounded(eta);
        let rough = facets.map(|facets| Rough { facets, coat: Coat::new(facets, eta) });
        let within = fresnel::dielectric_average(1.0 / eta);
        let average = rough.as_ref().map_or_else(|| fresnel::dielectric_average(eta), |rough| rough.coat.average());
        Self { eta, rough, base: reflectance * (1.0 - within) / (Rgb::ONE - reflectance * within), average }
    }

    /// The share of light from `w` that the coat reflects.
    #[inline]
    fn reflectance(&self, w: DVec3) -> f64 {
        match &self.rough {
            None => fresnel::dielectric(w.z.abs(), self.eta),
            Some(rough) => rough.coat.of(w.z),
        }
    }

    /// What the base scatters of light from `wi`, above, and the density of the draw, where one has the probability
    /// `share` to be the coat's: by `base` and `average`, and what the coat reflects of light to and from there.
    #[inline(always)]
    fn matt((base, average): (Rgb, f64), share: f64, wi: DVec3, [reflectance, there]: [f64; 2]) -> (Rgb, f64) {
        let reaching = (1.0 - reflectance) * (1.0 - there);
        (base * (reaching * FRAC_1_PI * wi.z / (1.0 - average)), (1.0 - share) * wi.z * FRAC_1_PI)
    }

    /// What facets of a coat reflect between two directions above, and the density of the draw, by what
    /// [`Facets::mirroring`] tells of them.
    #[inline(always)]
    fn glossy((facets, eta): (&F, f64), share: f64, [wo, wi]: [DVec3; 2], (density, cosine): (f64, f64)) -> (f64, f64) {
        let coat = fresnel::dielectric(cosine, eta) * density * facets.reflection_geometry(wo, wi);
        (coat, share * facets.reflected_pdf(wo, density))
    }

    /// The probability with which a draw is reflected by the coat, of which it reflects this share.
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
        let Some(Rough { facets, .. }) = &self.rough else { return (base, diffuse) };
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
