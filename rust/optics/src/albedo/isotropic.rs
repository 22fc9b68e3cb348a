//! Single-scattering energy loss of isotropic, perfectly reflecting facets.

use super::Tables;
use super::cubic::Cubic;
use super::tables::{MIRROR, MIRROR_AVERAGE};
use super::variables::{of_alpha, of_cosine};

/// Facets of one roughness, with their position in the table.
#[derive(Clone, Copy, Debug)]
pub struct Alike {
    tables: &'static Tables,
    alpha: f64,
    column: Cubic,
}

impl Alike {
    /// Looks up facets of a roughness in these tables.
    #[inline]
    pub fn new(tables: &'static Tables, alpha: f64) -> Self {
        Self { tables, alpha, column: Cubic::new(of_alpha(alpha), MIRROR[1]) }
    }

    /// Loss for a cosine from 0 to 1, as [`super::MirrorLoss::of`].
    #[inline(always)]
    pub fn of(&self, cosine: f64) -> f64 {
        let (square, sine) = (self.alpha * self.alpha, (1.0 - cosine) * (1.0 + cosine));
        let row = Cubic::new(of_cosine(self.alpha, cosine), MIRROR[0]);
        let most = square / (cosine * cosine + square * sine);
        (most * self.tables.mirror.at(&row, &self.column)).clamp(0.0, 1.0)
    }

    /// Cosine-weighted average of the loss.
    pub fn average(&self) -> f64 {
        let at = Cubic::new(of_alpha(self.alpha), MIRROR_AVERAGE[0]);
        self.tables.mirror_average.at(&at).exp() * self.alpha * self.alpha
    }
}
