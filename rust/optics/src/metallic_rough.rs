//! The metallic-roughness BRDF of glTF.

mod metallic_rough_lanes;

use super::albedo::{MirrorLoss, SchlickShare};
use super::conductor::{above, made_up, mirrors};
use super::lobes::{Grazing, diffuse};
use super::mirror::mirrored;
use super::{Bsdf, BsdfSample, Facets, Ggx, Rgb, fresnel};
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

/// The metallic-roughness model (Khronos, "glTF 2.0", 2021, appendix B): GGX microfacets of roughness α = roughness²,
/// with Schlick's Fresnel term. The reflectance F₀ at normal incidence is interpolated by `metallic` between 0.04 and
/// the base color. The dielectric part has a diffuse base.
///
/// Where the specification leaves the coupling open, this BRDF is reciprocal and conserves energy. The base gets the
/// light that dielectric facets transmit, (1 − R(wo)) (1 − R(wi)) / (π (1 − R̄)), and losses of metal facets are
/// compensated. A white base is white at every roughness and metalness. Both sides reflect.
///
/// The dielectric part has the specification's index of 1.5, and reflects by that relative to its surroundings.
#[derive(Clone, Copy, Debug)]
pub struct MetallicRough {
    rough: Option<RoughMetal>,
    /// Base contribution, over π and the mean transmittance to it.
    base: Rgb,
    /// Multiple scattering of metal, over π and the mean loss.
    multiple: Rgb,
    /// Base color.
    color: Rgb,
    metallic: f64,
    dielectric: Ends,
    /// Directional distribution of multiple scattering.
    grazing: Grazing,
}

/// Reflectances at normal and grazing incidence, interpolated by Schlick's weight.
#[derive(Clone, Copy, Debug)]
struct Ends {
    normal: f64,
    grazing: f64,
}

impl Ends {
    /// Single-scattering albedo, from those with Schlick's weight and with reflectance 1.
    #[inline(always)]
    fn once(self, (schlick, kept): (f64, f64)) -> f64 {
        self.normal * kept + (self.grazing - self.normal) * schlick
    }
}

#[derive(Clone, Copy, Debug)]
struct RoughMetal {
    ggx: Ggx,
    loss: MirrorLoss,
    schlick: SchlickShare,
}

impl RoughMetal {
    fn new(ggx: Ggx) -> Self {
        Self { ggx, loss: MirrorLoss::new(ggx), schlick: SchlickShare::new(ggx) }
    }
}

impl MetallicRough {
    /// Reflectance of a dielectric in air, for this index of refraction.
    const DIELECTRIC: Ends = Ends { normal: 0.04, grazing: 1.0 };
    const IOR: f64 = 1.5;

    /// Creates the BRDF from a base color, a metalness and a roughness, each 0 to 1. Where roughness² is below
    /// [`Ggx::SMOOTH`] it is specular.
    pub fn new(base_color: Rgb, metallic: f64, roughness: f64) -> Self {
        Self::of(base_color, metallic, roughness, Self::DIELECTRIC)
    }

    /// Creates the BRDF in a medium of index `outside`. The dielectric is invisible if that is its own index or
    /// greater.
    pub fn within(base_color: Rgb, metallic: f64, roughness: f64, outside: f64) -> Self {
        if outside == 1.0 {
            return Self::new(base_color, metallic, roughness);
        }
        Self::of(base_color, metallic, roughness, Self::dielectric((Self::IOR / outside).max(1.0)))
    }

    /// Reflectance of a dielectric with a relative index, at least 1. At normal incidence it is Fresnel's. At grazing
    /// incidence Fresnel's reflectance is always 1, but the closer the index is to 1 the later it rises, which
    /// Schlick's weight cannot follow. Its amplitude is scaled instead, by the ratio of cosine-weighted averages to
    /// that in air.
    fn dielectric(eta: f64) -> Ends {
        let normal = |eta: f64| ((eta - 1.0) / (eta + 1.0)).powi(2);
        let added = |eta: f64| fresnel::dielectric_average(eta) - normal(eta);
        let Ends { normal: air, grazing } = Self::DIELECTRIC;
        Ends { normal: normal(eta), grazing: normal(eta) + (grazing - air) * added(eta) / added(Self::IOR) }
    }

    fn of(base_color: Rgb, metallic: f64, roughness: f64, dielectric: Ends) -> Self {
        let metallic = metallic.clamp(0.0, 1.0);
        let rough = Ggx::rough([roughness * roughness; 2]).map(RoughMetal::new);
        // Schlick's (1 − cos)⁵ has a cosine-weighted average of 1/21.
        let lost = rough.as_ref().map_or(0.0, |rough| rough.loss.average());
        let schlick = rough.as_ref().map_or(1.0 / 21.0, |rough| rough.schlick.average());
        let average = dielectric.once((schlick, 1.0 - lost));
        let metal = base_color + (Rgb::ONE - base_color) / 21.0;
        let multiple = if lost > 0.0 { made_up(lost, metal) * metallic } else { Rgb::ZERO };
        let base = base_color * ((1.0 - metallic) * FRAC_1_PI / (1.0 - average));
        let grazing = Grazing::new(rough.as_ref().map_or(1.0, |rough| rough.ggx.alpha()[0]));
        Self { rough, base, multiple, color: base_color, metallic, dielectric, grazing }
    }

    /// Values of the base and of multiple scattering for `wi`, above, from the single-scattering albedos of `wo` and
    /// `wi`. Also returns the densities of metal and base samples, by the probabilities of facets and metal
    /// ([`MetallicRough::shares`]).
    #[inline(always)]
    fn wide(
        (base, multiple, grazing, dielectric): (Rgb, Rgb, &Grazing, Ends),
        [facets, metal]: [f64; 2],
        wi: DVec3,
        [once_o, once_i]: [(f64, f64); 2],
    ) -> (Rgb, [f64; 2]) {
        let reaching = (1.0 - dielectric.once(once_o)) * (1.0 - dielectric.once(once_i));
        let lost = (1.0 - once_o.1) * (1.0 - once_i.1);
        let densities = [metal * grazing.pdf(wi.z), (1.0 - facets - metal).max(0.0) * wi.z * FRAC_1_PI];
        ((base * reaching + multiple * lost) * wi.z, densities)
    }

    /// Value and density of facet reflection between two directions above, from the result of [`Facets::mirroring`].
    #[inline(always)]
    fn glossy((ggx, f0, f90): (&Ggx, Rgb, f64), facets: f64, [wo, wi]: [DVec3; 2], told: (f64, f64)) -> (Rgb, f64) {
        let (density, cosine) = told;
        let once = fresnel::schlick_between(cosine, f0, f90) * (density * ggx.reflection_geometry(wo, wi));
        (once, facets * ggx.reflected_pdf(wo, density))
    }

    /// Reflectance at normal incidence.
    #[inline]
    fn f0(&self) -> Rgb {
        self.color * self.metallic + self.dielectric.normal * (1.0 - self.metallic)
    }

    /// Reflectance at grazing incidence.
    #[inline]
    fn f90(&self) -> f64 {
        1.0 - (1.0 - self.dielectric.grazing) * (1.0 - self.metallic)
    }

    /// Single-scattering albedos of direction `w` with Schlick's weight and with reflectance 1.
    #[inline]
    fn once(&self, w: DVec3) -> (f64, f64) {
        match &self.rough {
            None => (fresnel::schlick_weight(w.z), 1.0),
            Some(rough) => (rough.schlick.of(w.z), 1.0 - rough.loss.of(w)),
        }
    }

    /// Sampling probabilities of single scattering and of multiple scattering by metal.
    #[inline]
    fn shares(&self, once: (f64, f64)) -> [f64; 2] {
        let facets = (self.f0() * once.1 + (Rgb::splat(self.f90()) - self.f0()) * once.0).max();
        let color = self.color.max();
        let (metal, base) = (
            color * self.metallic * (1.0 - once.1),
            color * (1.0 - self.metallic) * (1.0 - self.dielectric.once(once)),
        );
        let sum = facets + metal + base;
        if sum > 0.0 { [facets / sum, metal / sum] } else { [0.0; 2] }
    }
}

impl Bsdf for MetallicRough {
    #[inline]
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> (Rgb, f64) {
        if !mirrors::<Ggx>(wo, wi) {
            return (Rgb::ZERO, 0.0);
        }
        let (wo, wi) = (above(wo), above(wi));
        let once = [self.once(wo), self.once(wi)];
        let shares = self.shares(once[0]);
        let (wide, [spread, matt]) =
            Self::wide((self.base, self.multiple, &self.grazing, self.dielectric), shares, wi, once);
        let Some(RoughMetal { ggx, .. }) = &self.rough else { return (wide, spread + matt) };
        let (glossy, facet) = Self::glossy((ggx, self.f0(), self.f90()), shares[0], [wo, wi], ggx.mirroring(wo, wi));
        (wide + glossy, facet + spread + matt)
    }

    #[inline]
    fn sample(&self, wo: DVec3, choice: &mut dyn FnMut() -> f64, u: [f64; 2]) -> Option<BsdfSample> {
        if !Ggx::sees(wo) {
            return None;
        }
        let up = above(wo);
        let [facets, metal] = self.shares(self.once(up));
        let choice = choice();
        let facet = choice < facets;
        let choices = if facet {
            [0.0, facets]
        } else if choice < facets + metal {
            [facets, facets + metal]
        } else {
            [facets + metal, 1.0]
        };
        let mut wi = match &self.rough {
            None if facet => {
                let weight = fresnel::schlick_between(up.z, self.f0(), self.f90()) / facets;
                return Some(BsdfSample::delta(mirrored(wo), weight).of_lobe([0.0, facets]));
            }
            Some(rough) if facet => rough.ggx.sample_reflection(up, u),
            _ if choice < facets + metal => self.grazing.sample(u),
            _ => diffuse(up, u),
        };
        if wi.z <= 0.0 {
            return None;
        }
        wi.z = wi.z.copysign(wo.z);
        let (value, pdf) = self.evaluate(wo, wi);
        (pdf > 0.0).then(|| BsdfSample::new(wi, value / pdf, pdf).of_lobe(choices))
    }

    fn albedo(&self) -> Rgb {
        self.color * (1.0 - self.f0()) + self.f0()
    }

    fn is_delta(&self) -> bool {
        self.rough.is_none() && self.base.is_black()
    }

    fn roughness(&self) -> f64 {
        self.rough.as_ref().map_or(0.0, |rough| rough.ggx.mean_alpha())
    }
}
