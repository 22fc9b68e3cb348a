//! What facets reflect at grazing angles, for Schlick's Fresnel term.

use super::cubic::Cubic;
use super::tables::{SCHLICK, SCHLICK_AVERAGE};
use super::variables::{effective_cosine, of_alpha, of_cosine};
use super::{Tables, Tabulated};
use crate::fresnel;

/// How much of light of a cosine facets reflect out of the surface at once whose reflectance is Schlick's (1 − cos)⁵.
#[derive(Clone, Copy, Debug)]
pub struct SchlickShare {
    tables: &'static Tables,
    roughness: f64,
    alpha: Cubic,
}

impl SchlickShare {
    /// Of facets that are alike in all directions.
    #[inline]
    pub fn new<F: Tabulated>(facets: F) -> Self {
        Self::with(F::TABLES, facets.alpha()[0])
    }

    /// Of these tables.
    #[inline]
    pub(super) fn with(tables: &'static Tables, roughness: f64) -> Self {
        Self { tables, roughness, alpha: Cubic::new(of_alpha(roughness), SCHLICK[1]) }
    }

    /// From a direction of this cosine. Without roughness it is Schlick's own.
    #[inline]
    pub fn of(&self, cosine: f64) -> f64 {
        let cosine = cosine.abs();
        let more = self.tables.schlick.at(&Cubic::new(of_cosine(self.roughness, cosine), SCHLICK[0]), &self.alpha);
        (fresnel::schlick_weight(effective_cosine(self.roughness, cosine)) + more).clamp(0.0, 1.0)
    }

    /// Its mean over even light.
    #[inline]
    pub fn average(&self) -> f64 {
        self.tables.schlick_average.at(&Cubic::new(of_alpha(self.roughness), SCHLICK_AVERAGE[0]))
    }
}
