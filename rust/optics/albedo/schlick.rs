//! What facets reflect at grazing angles, for Schlick's Fresnel term.

use super::tables::schlick::{AVERAGE, MEAN};
use super::{between, effective_cosine, plane};
use crate::optics::fresnel;

/// Sizes of the tables: √cos θ by ∛α, and the averages by ∛α.
pub(super) const SIZES: [usize; 2] = [24, 24];
pub(super) const AVERAGE_SIZE: usize = 24;

/// The mean of Schlick's (1 − cos)⁵ over the light that isotropic facets reflect once to a direction of this cosine.
/// Without roughness it is Schlick's own; within 0.004 of the integral.
#[inline]
pub fn schlick_share(alpha: f64, cosine: f64) -> f64 {
    let c = cosine.abs();
    let more = plane(&MEAN, SIZES, [c.sqrt(), alpha.cbrt()]) - 0.5;
    (fresnel::schlick_weight(effective_cosine(alpha, c)) + more).clamp(0.0, 1.0)
}

/// The mean over even light of [`schlick_share`] times what is not lost.
#[inline]
pub fn schlick_share_average(alpha: f64) -> f64 {
    let (i, f) = between(alpha.cbrt(), AVERAGE_SIZE);
    AVERAGE[i] * (1.0 - f) + AVERAGE[i + 1] * f
}
