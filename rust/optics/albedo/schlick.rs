//! What facets reflect at grazing angles, for Schlick's Fresnel term.

use super::tables::schlick::{AVERAGE, MEAN};
use super::{between, of_alpha, plane};

/// Sizes of the tables: √cos θ by α, and the averages by α.
pub(super) const SIZES: [usize; 2] = [32, 16];
pub(super) const AVERAGE_SIZE: usize = 24;

/// The mean of Schlick's (1 − cos)⁵ over the light that isotropic facets reflect once to a direction of this cosine.
///
/// Within 0.003 of the integral.
#[inline]
pub fn schlick_share(alpha: f64, cosine: f64) -> f64 {
    plane(&MEAN, SIZES, [cosine.abs().sqrt(), of_alpha(alpha)])
}

/// The mean over even light of [`schlick_share`] times what is not lost.
#[inline]
pub fn schlick_share_average(alpha: f64) -> f64 {
    let (i, f) = between(of_alpha(alpha), AVERAGE_SIZE);
    AVERAGE[i] * (1.0 - f) + AVERAGE[i + 1] * f
}
