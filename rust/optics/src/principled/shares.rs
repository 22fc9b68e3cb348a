//! How much of light the facets of a principled dielectric reflect.

use super::Look;
use crate::albedo::{Coat, MirrorLoss, SchlickShare};
use crate::{Facets, Ggx, Rgb, fresnel};

/// What facets of a dielectric reflect once, where a part of their Fresnel term has the colour of the base. They are
/// alike in all directions, as what is known of their losses is.
#[derive(Clone, Copy, Debug)]
pub struct DielectricShares {
    /// The facets.
    pub facets: Ggx,
    eta: f64,
    /// The tinted share of the Fresnel term, and its reflectance at normal incidence.
    tint: f64,
    tinted: Rgb,
}

impl DielectricShares {
    /// Of a roughness, between indices of this ratio, `eta` ≥ 1.
    #[inline]
    pub fn new(look: &Look, roughness: f64, eta: f64) -> Self {
        let facets = Ggx::new([(roughness * roughness).max(0.001); 2]);
        let tinted = (look.tint() * super::at_normal(eta)).clamp(Rgb::ZERO, Rgb::ONE);
        Self { facets, eta, tint: look.specular_tint, tinted }
    }

    /// The reflectance of a facet that light meets at a cosine.
    #[inline(always)]
    pub fn fresnel(&self, cosine: f64) -> Rgb {
        let plain = Rgb::splat(fresnel::dielectric(cosine, self.eta));
        plain + (fresnel::schlick(cosine, self.tinted) - plain) * self.tint
    }

    /// The share of light of a cosine that facets reflect.
    #[inline]
    pub fn of(&self, cosine: f64) -> Rgb {
        let plain = Coat::new(self.facets, self.eta).of(cosine);
        let all = self.facets;
        self.mixed(plain, || {
            let w = glam::DVec3::new(((1.0 - cosine) * (1.0 + cosine)).sqrt(), 0.0, cosine);
            [SchlickShare::new(all).of(cosine), 1.0 - MirrorLoss::new(all).of(w)]
        })
    }

    /// Its mean over even light.
    pub fn average(&self) -> Rgb {
        let all = self.facets;
        let plain = Coat::new(all, self.eta).average();
        self.mixed(plain, || [SchlickShare::new(all).average(), 1.0 - MirrorLoss::new(all).average()])
    }

    /// What is reflected where facets reflect this share of a dielectric, and these of Schlick's term and of 1.
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
