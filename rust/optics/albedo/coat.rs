//! What a rough coat reflects once.

use super::tables::coat::{AVERAGE, MEAN};
use super::{averages, effective_cosine, volume};
use crate::optics::fresnel;

/// Sizes of the tables: √cos θ by ∛α by index, and the averages by ∛α by index.
pub(super) const SIZES: [usize; 3] = [22, 16, 16];
pub(super) const AVERAGE_SIZES: [usize; 2] = [20, 20];

/// A variable from 0 to 1 for an index of refraction ≥ 1: the root of what it reflects of amplitude at normal
/// incidence.
#[inline]
pub(super) fn of_index(eta: f64) -> f64 {
    ((eta - 1.0) / (eta + 1.0)).max(0.0).sqrt()
}

/// The mean Fresnel reflectance of a dielectric of index `eta` ≥ 1 over the light that its isotropic facets reflect
/// once to a direction of this cosine, on the side of the thinner medium. Without roughness it is Fresnel's own; within
/// 0.01 of the integral for indices from 1.2 to 3.
#[inline]
pub fn coat(alpha: f64, eta: f64, cosine: f64) -> f64 {
    let c = cosine.abs();
    let more = volume(&MEAN, SIZES, [c.sqrt(), alpha.cbrt(), of_index(eta)]) - 0.5;
    (fresnel::dielectric(effective_cosine(alpha, c), eta) + more).clamp(0.0, 1.0)
}

/// The mean over even light of [`coat`] times what is not lost.
#[inline]
pub fn coat_average(alpha: f64, eta: f64) -> f64 {
    averages(&AVERAGE, AVERAGE_SIZES, [alpha.cbrt(), of_index(eta)])
}
