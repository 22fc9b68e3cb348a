//! What facets of perfect mirrors lose.

use super::tables::mirror::{ANISOTROPIC, AVERAGE, ISOTROPIC};
use super::{averages, between, of_alpha, of_x, volume, within, x_of};
use crate::optics::{Facets, Ggx};
use glam::DVec3;

/// Sizes of the tables: grazing by α, grazing by α along by α across, and the averages by α and α.
pub(super) const ISOTROPIC_SIZES: [usize; 2] = [32, 24];
pub(super) const ANISOTROPIC_SIZES: [usize; 3] = [20, 11, 11];
pub(super) const AVERAGE_SIZES: [usize; 2] = [28, 28];

/// The share of white light that does not leave after one reflection, for facets of given roughness.
#[derive(Clone, Copy, Debug)]
pub struct MirrorLoss {
    ggx: Ggx,
    /// Between which columns of the table of facets that are alike in all directions.
    column: (usize, f64),
}

impl MirrorLoss {
    /// Of these facets.
    #[inline]
    pub fn new(ggx: Ggx) -> Self {
        Self { ggx, column: between(of_alpha(ggx.alpha()[0]), ISOTROPIC_SIZES[1]) }
    }

    /// Of light from `w`: 1 − ∫ D G₂ / (4 cos θ) dω.
    ///
    /// Within 0.004 of the integral where both α are the same, and within 0.01 otherwise.
    #[inline]
    pub fn of(&self, w: DVec3) -> f64 {
        let grazing = of_x(x_of(&self.ggx, w));
        let [a, b] = self.ggx.alpha();
        if a == b {
            let [rows, columns] = ISOTROPIC_SIZES;
            return within(&ISOTROPIC, columns, between(grazing, rows), self.column);
        }
        self.of_brushed(grazing, w)
    }

    #[inline(never)]
    fn of_brushed(&self, grazing: f64, w: DVec3) -> f64 {
        // At the same α tan θ the azimuth matters little, and between the axes it goes as these powers say.
        let [a, b] = self.ggx.alpha();
        let (along, across) = (a.powf(1.6) * w.x * w.x, b.powf(1.6) * w.y * w.y);
        let share = if along + across > 0.0 { across / (along + across) } else { 0.5 };
        let (a, b) = (of_alpha(a), of_alpha(b));
        let at = |first, second| volume(&ANISOTROPIC, ANISOTROPIC_SIZES, [grazing, first, second]);
        at(a, b) * (1.0 - share) + at(b, a) * share
    }

    /// Its mean over even light, ∫ loss cos θ dω / π, as its table has it, within 1 %.
    #[inline]
    pub fn average(&self) -> f64 {
        let [a, b] = self.ggx.alpha();
        averages(&AVERAGE, AVERAGE_SIZES, [a.cbrt(), b.cbrt()]).exp() * (0.5 * (a * a + b * b))
    }
}
