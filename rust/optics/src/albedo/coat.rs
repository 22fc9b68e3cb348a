//! What a rough coat reflects once.

use super::cubic::Cubic;
use super::tables::{COAT, COAT_AVERAGE};
use super::variables::{DENSEST, effective_cosine, of_alpha, of_alpha_root, of_cosine, of_index};
use super::{Alike, Tables, Tabulated};
use crate::fresnel;

/// How much of light of a cosine the facets of a dielectric coat reflect out of the surface at once.
#[derive(Clone, Copy, Debug)]
pub struct Coat {
    tables: &'static Tables,
    roughness: f64,
    eta: f64,
    alpha: Cubic,
    index: Cubic,
    /// What the facets would lose if they were mirrors.
    loss: Alike,
}

impl Coat {
    /// Of facets that are alike in all directions, with `eta` ≥ 1 the index within over that outside.
    #[inline]
    pub fn new<F: Tabulated>(facets: F, eta: f64) -> Self {
        Self::with(F::TABLES, facets.alpha()[0], eta)
    }

    /// Of these tables.
    #[inline]
    pub(super) fn with(tables: &'static Tables, roughness: f64, eta: f64) -> Self {
        let index = of_index(roughness, eta.min(DENSEST));
        let (alpha, index) = (Cubic::new(of_alpha_root(roughness), COAT[0]), Cubic::new(index, COAT[2]));
        Self { tables, roughness, eta, alpha, index, loss: Alike::new(tables, roughness) }
    }

    /// From a direction of this cosine. Without roughness it is Fresnel's own.
    #[inline]
    pub fn of(&self, cosine: f64) -> f64 {
        let cosine = cosine.abs();
        let more =
            self.tables.coat.at(&self.alpha, &Cubic::new(of_cosine(self.roughness, cosine), COAT[1]), &self.index);
        let mean = (fresnel::dielectric(effective_cosine(self.roughness, cosine), self.eta) + more).clamp(0.0, 1.0);
        mean * (1.0 - self.loss.of(cosine))
    }

    /// Its mean over even light.
    #[inline]
    pub fn average(&self) -> f64 {
        let alpha = Cubic::new(of_alpha(self.roughness), COAT_AVERAGE[0]);
        let index = Cubic::new(of_index(self.roughness, self.eta.min(DENSEST)), COAT_AVERAGE[1]);
        let more = self.tables.coat_average.at(&alpha, &index);
        (fresnel::dielectric_average(self.eta) + more).clamp(0.0, 1.0)
    }
}
