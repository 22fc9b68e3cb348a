//! Albedo of the facets of a principled dielectric.

use super::Look;
use crate::albedo::{Coat, MirrorLoss, SchlickShare};
use crate::{Facets, Ggx, Rgb, fresnel};

/// Single-scattering albedo of dielectric facets whose Fresnel term is partly tinted by the base. The facets are
/// isotropic, because the tables of losses are.
#[derive(Clone, Copy, Debug)]
pub struct DielectricShares {
    /// The facets.
    pub facets: Ggx,
    eta: f64,
    /// Tinted share of the Fresnel term, and its reflectance at normal incidence.
    tint: f64,
    tinted: Rgb,
}

impl DielectricShares {
    /// Creates facets of a roughness with a relative index of refraction `eta` ≥ 1.
    #[inline]
    pub fn new(look: &Look, roughness: f64, eta: f64) -> Self {
        let facets = Ggx::new([(roughness * roughness).max(0.001); 2]);
        let tinted = (look.tint() * super::at_normal(eta)).clamp(Rgb::ZERO, Rgb::ONE);
        Self { facets, eta, tint: look.specular_tint, tinted }
    }

    /// Reflectance of a facet at a cosine.
    #[inline(always)]
    pub fn fresnel(&self, cosine: f64) -> Rgb {
        let plain = Rgb::splat(fresnel::dielectric(cosine, self.eta));
        plain + (fresnel::schlick(cosine, self.tinted) - plain) * self.tint
    }

    /// Albedo for a cosine.
    #[inline]
    pub fn of(&self, cosine: f64) -> Rgb {
        let plain = Coat::new(self.facets, self.eta).of(cosine);
        let all = self.facets;
        self.mixed(plain, || {
            let w = glam::DVec3::new(((1.0 - cosine) * (1.0 + cosine)).sqrt(), 0.0, cosine);
            [SchlickShare::new(all).of(cosine), 1.0 - MirrorLoss::new(all).of(w)]
        })
    }

    /// Cosine-weighted average of the albedo.
    pub fn average(&self) -> Rgb {
        let all = self.facets;
        let plain = Coat::new(all, self.eta).average();
        self.mixed(plain, || [SchlickShare::new(all).average(), 1.0 - MirrorLoss::new(all).average()])
    }

    /// Blends the albedo of a plain dielectric with the tinted one, from the albedos of Schlick's weight and of
    /// reflectance 1.
    #[inline]
    fn mixed(&self, plain: f64, of_tint: impl Fn() -> [f64; 2]) -> Rgb {
        let mut share = Rgb::splat(plain);
        if self.tint > 0.0 {
            let [grazing, kept] = of_tint();
            let tinted = self.tinted * kept + (Rgb::ONE - self.tinted) * grazing;
            share += (tinted - share) * self.tint;
        }
        share.clamp(Rgb::ZERO, Rgb::ONE)
    }
}
