//! Directional albedo of facets with Schlick's Fresnel weight.

use super::cubic::Cubic;
use super::tables::{SCHLICK, SCHLICK_AVERAGE};
use super::variables::{effective_cosine, of_alpha, of_cosine};
use super::{Tables, Tabulated};
use crate::fresnel;

/// Directional albedo of facets whose reflectance is Schlick's weight (1 − cos)⁵, with single scattering.
#[derive(Clone, Copy, Debug)]
pub struct SchlickShare {
    tables: &'static Tables,
    roughness: f64,
    alpha: Cubic,
}

impl SchlickShare {
    /// Looks up isotropic facets.
    #[inline]
    pub fn new<F: Tabulated>(facets: F) -> Self {
        Self::with(F::TABLES, facets.alpha()[0])
    }

    /// Looks up a roughness in these tables.
    #[inline]
    pub(super) fn with(tables: &'static Tables, roughness: f64) -> Self {
        Self { tables, roughness, alpha: Cubic::new(of_alpha(roughness), SCHLICK[1]) }
    }

    /// Albedo for a cosine. Without roughness it is Schlick's weight.
    #[inline]
    pub fn of(&self, cosine: f64) -> f64 {
        let cosine = cosine.abs();
        let more = self.tables.schlick.at(&Cubic::new(of_cosine(self.roughness, cosine), SCHLICK[0]), &self.alpha);
        (fresnel::schlick_weight(effective_cosine(self.roughness, cosine)) + more).clamp(0.0, 1.0)
    }

    /// Cosine-weighted average of the albedo.
    #[inline]
    pub fn average(&self) -> f64 {
        self.tables.schlick_average.at(&Cubic::new(of_alpha(self.roughness), SCHLICK_AVERAGE[0]))
    }
}
