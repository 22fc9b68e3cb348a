//! Directional albedo of a rough dielectric coat with single scattering.

use super::cubic::Cubic;
use super::tables::{COAT, COAT_AVERAGE};
use super::variables::{DENSEST, effective_cosine, of_alpha, of_alpha_root, of_cosine, of_index};
use super::{Alike, Tables, Tabulated};
use crate::fresnel;

/// Directional albedo of the facets of a dielectric coat with single scattering.
#[derive(Clone, Copy, Debug)]
pub struct Coat {
    tables: &'static Tables,
    roughness: f64,
    eta: f64,
    alpha: Cubic,
    index: Cubic,
    /// Loss of the same facets if they reflected perfectly.
    loss: Alike,
}

impl Coat {
    /// Looks up isotropic facets; `eta` ≥ 1 is the inner over the outer index of refraction.
    #[inline]
    pub fn new<F: Tabulated>(facets: F, eta: f64) -> Self {
        Self::with(F::TABLES, facets.alpha()[0], eta)
    }

    /// Looks up a roughness in these tables.
    #[inline]
    pub(super) fn with(tables: &'static Tables, roughness: f64, eta: f64) -> Self {
        let index = of_index(roughness, eta.min(DENSEST));
        let (alpha, index) = (Cubic::new(of_alpha_root(roughness), COAT[0]), Cubic::new(index, COAT[2]));
        Self { tables, roughness, eta, alpha, index, loss: Alike::new(tables, roughness) }
    }

    /// Albedo for a cosine. Without roughness it is Fresnel's reflectance.
    #[inline]
    pub fn of(&self, cosine: f64) -> f64 {
        let cosine = cosine.abs();
        let more =
            self.tables.coat.at(&self.alpha, &Cubic::new(of_cosine(self.roughness, cosine), COAT[1]), &self.index);
        let mean = (fresnel::dielectric(effective_cosine(self.roughness, cosine), self.eta) + more).clamp(0.0, 1.0);
        mean * (1.0 - self.loss.of(cosine))
    }

    /// Cosine-weighted average of the albedo.
    #[inline]
    pub fn average(&self) -> f64 {
        let alpha = Cubic::new(of_alpha(self.roughness), COAT_AVERAGE[0]);
        let index = Cubic::new(of_index(self.roughness, self.eta.min(DENSEST)), COAT_AVERAGE[1]);
        let more = self.tables.coat_average.at(&alpha, &index);
        (fresnel::dielectric_average(self.eta) + more).clamp(0.0, 1.0)
    }
}
