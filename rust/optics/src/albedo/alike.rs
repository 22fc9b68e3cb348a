//! What facets of perfect mirrors lose that are alike in all directions.

use super::Tables;
use super::cubic::Cubic;
use super::tables::{MIRROR, MIRROR_AVERAGE};
use super::variables::{of_alpha, of_cosine};

/// Facets of one roughness, and where they are in the table.
#[derive(Clone, Copy, Debug)]
pub struct Alike {
    tables: &'static Tables,
    alpha: f64,
    column: Cubic,
}

impl Alike {
    /// Of these tables.
    #[inline]
    pub fn new(tables: &'static Tables, alpha: f64) -> Self {
        Self { tables, alpha, column: Cubic::new(of_alpha(alpha), MIRROR[1]) }
    }

    /// Of light of a cosine from 0 to 1, as [`super::MirrorLoss::of`].
    #[inline(always)]
    pub fn of(&self, cosine: f64) -> f64 {
        let (square, sine) = (self.alpha * self.alpha, (1.0 - cosine) * (1.0 + cosine));
        let row = Cubic::new(of_cosine(self.alpha, cosine), MIRROR[0]);
        let most = square / (cosine * cosine + square * sine);
        (most * self.tables.mirror.at(&row, &self.column)).clamp(0.0, 1.0)
    }

    /// Its mean over even light.
    pub fn average(&self) -> f64 {
        let at = Cubic::new(of_alpha(self.alpha), MIRROR_AVERAGE[0]);
        self.tables.mirror_average.at(&at).exp() * self.alpha * self.alpha
    }
}
