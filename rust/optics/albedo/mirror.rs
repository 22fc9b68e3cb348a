//! What facets of perfect mirrors lose.

use super::tables::mirror::{ANISOTROPIC, AVERAGE, ISOTROPIC};
use super::{averages, of_alpha, of_x, plane, volume, x_of};
use crate::optics::Ggx;
use glam::DVec3;

/// Sizes of the tables: grazing by α, grazing by α along by α across, and the averages by α and α.
pub(super) const ISOTROPIC_SIZES: [usize; 2] = [32, 24];
pub(super) const ANISOTROPIC_SIZES: [usize; 3] = [20, 11, 11];
pub(super) const AVERAGE_SIZES: [usize; 2] = [28, 28];

/// The share of white light from `w` that does not leave after one reflection: 1 − ∫ D G₂ / (4 cos θ) dω.
///
/// Within 0.004 of the integral where both α are the same, and within 0.01 otherwise.
#[inline]
pub fn mirror_loss(ggx: &Ggx, w: DVec3) -> f64 {
    let grazing = of_x(x_of(ggx, w));
    let [a, b] = ggx.alpha();
    if a == b {
        return plane(&ISOTROPIC, ISOTROPIC_SIZES, [grazing, of_alpha(a)]);
    }
    // At the same α tan θ the azimuth matters little, and between the axes it goes as these powers say.
    let (along, across) = (a.powf(1.6) * w.x * w.x, b.powf(1.6) * w.y * w.y);
    let share = if along + across > 0.0 { across / (along + across) } else { 0.5 };
    let (a, b) = (of_alpha(a), of_alpha(b));
    let at = |first, second| volume(&ANISOTROPIC, ANISOTROPIC_SIZES, [grazing, first, second]);
    at(a, b) * (1.0 - share) + at(b, a) * share
}

/// The mean of [`mirror_loss`] over even light, ∫ loss cos θ dω / π, as its table has it, within 1 %.
#[inline]
pub fn mirror_loss_average(ggx: &Ggx) -> f64 {
    let [a, b] = ggx.alpha();
    averages(&AVERAGE, AVERAGE_SIZES, [a.cbrt(), b.cbrt()]).exp() * (0.5 * (a * a + b * b))
}
