//! What a rough coat reflects once.

use super::tables::coat::{AVERAGE, MEAN};
use super::{averages, of_alpha, volume};

/// Sizes of the tables: √cos θ by α by index, and the averages by α by index.
pub(super) const SIZES: [usize; 3] = [24, 10, 14];
pub(super) const AVERAGE_SIZES: [usize; 2] = [16, 20];

/// A variable from 0 to 1 for an index of refraction ≥ 1: the root of its reflectance at normal incidence, and the root of
/// that, for what an index near 1 does at grazing.
#[inline]
pub(super) fn of_index(eta: f64) -> f64 {
    ((eta - 1.0) / (eta + 1.0)).max(0.0).sqrt()
}

/// The mean Fresnel reflectance of a dielectric of index `eta` ≥ 1 over the light that its isotropic facets reflect once to
/// a direction of this cosine, on the side of the thinner medium. Within 0.004 of the integral from `eta` = 1.2 on.
#[inline]
pub fn coat(alpha: f64, eta: f64, cosine: f64) -> f64 {
    volume(&MEAN, SIZES, [cosine.abs().sqrt(), of_alpha(alpha), of_index(eta)])
}

/// The mean over even light of [`coat`] times what is not lost.
#[inline]
pub fn coat_average(alpha: f64, eta: f64) -> f64 {
    averages(&AVERAGE, AVERAGE_SIZES, [of_alpha(alpha), of_index(eta)])
}
