//! What facets of perfect mirrors lose.

use super::tables::mirror::{ANISOTROPIC, AVERAGE, ISOTROPIC};
use super::{averages, of_alpha, of_x, plane, volume, x_of};
use crate::optics::Ggx;
use glam::DVec3;

/// Sizes of the tables: grazing by α, grazing by α along by α across, and the averages by α and α.
pub(super) const ISOTROPIC_SIZES: [usize; 2] = [32, 24];
pub(super) const ANISOTROPIC_SIZES: [usize; 3] = [20, 11, 11];
pub(super) const AVERAGE_SIZES: [usize; 2] = [28, 28];

/// The share of white light that does not leave after one reflection, for facets of given roughness.
#[derive(Clone, Copy, Debug)]
pub struct MirrorLoss {
    ggx: Ggx,
    /// Where in the tables each roughness is, as a variable from 0 to 1.
    at: [f64; 2],
}

impl MirrorLoss {
    /// Of these facets.
    #[inline]
    pub fn new(ggx: Ggx) -> Self {
        let [a, b] = ggx.alpha();
        Self { ggx, at: [of_alpha(a), of_alpha(b)] }
    }

    /// Of light from `w`: 1 − ∫ D G₂ / (4 cos θ) dω.
    ///
    /// Within 0.004 of the integral where both α are the same, and within 0.01 otherwise.
    #[inline]
    pub fn of(&self, w: DVec3) -> f64 {
        let grazing = of_x(x_of(&self.ggx, w));
        let [a, b] = self.ggx.alpha();
        if a == b {
            return plane(&ISOTROPIC, ISOTROPIC_SIZES, [grazing, self.at[0]]);
        }
        self.of_brushed(grazing, w)
    }

    #[inline(never)]
    fn of_brushed(&self, grazing: f64, w: DVec3) -> f64 {
        // At the same α tan θ the azimuth matters little, and between the axes it goes as these powers say.
        let ([a, b], [at_a, at_b]) = (self.ggx.alpha(), self.at);
        let (along, across) = (a.powf(1.6) * w.x * w.x, b.powf(1.6) * w.y * w.y);
        let share = if along + across > 0.0 { across / (along + across) } else { 0.5 };
        let at = |first, second| volume(&ANISOTROPIC, ANISOTROPIC_SIZES, [grazing, first, second]);
        at(at_a, at_b) * (1.0 - share) + at(at_b, at_a) * share
    }

    /// Its mean over even light, ∫ loss cos θ dω / π, as its table has it, within 1 %.
    #[inline]
    pub fn average(&self) -> f64 {
        let [a, b] = self.ggx.alpha();
        averages(&AVERAGE, AVERAGE_SIZES, [a.cbrt(), b.cbrt()]).exp() * (0.5 * (a * a + b * b))
    }
}
