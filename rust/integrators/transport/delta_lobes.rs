//! The single directions that a surface scatters into.

use crate::math::DVec3;
use crate::optics::{Bsdf, BsdfSample, Rgb};
use crate::scene::materials::Scattering;

/// How often a choice between two parts is halved: until it is known as well as a picture keeps it.
const HALVINGS: u32 = 32;

/// Every single direction that light is scattered into, each with all of its weight, not over the chance to be drawn.
pub(super) fn singles(scattering: &Scattering, wo: DVec3, mut each: impl FnMut(BsdfSample)) {
    match scattering {
        Scattering::One(bsdf) => of_one(bsdf, wo, Rgb::ONE, &mut each),
        Scattering::Several(parts) => {
            for (weight, bsdf) in parts {
                of_one(bsdf, wo, *weight, &mut each);
            }
        }
    }
}

/// A kind of scattering has two parts at most, and the choice between them has one threshold: what lies under it is how
/// likely the first is.
fn of_one(bsdf: &Bsdf, wo: DVec3, weight: Rgb, each: &mut impl FnMut(BsdfSample)) {
    let draw = |choice: f64| bsdf.sample(wo, || choice, [0.5; 2]);
    let (first, last) = (draw(0.0), draw(1f64.next_down()));
    let is_single = |drawn: &Option<BsdfSample>| drawn.is_some_and(|s| s.pdf == f64::INFINITY);
    if !is_single(&first) && !is_single(&last) {
        return;
    }
    let same = |a: &Option<BsdfSample>, b: &Option<BsdfSample>| match (a, b) {
        (Some(a), Some(b)) => a.wi == b.wi && a.pdf == b.pdf,
        (None, None) => true,
        _ => false,
    };
    let mut emit = |drawn: Option<BsdfSample>, probability: f64| {
        if let Some(s) = drawn
            && is_single(&drawn)
            && probability > 0.0
        {
            each(BsdfSample { weight: s.weight * weight * probability, ..s });
        }
    };
    if same(&first, &last) {
        return emit(first, 1.0);
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if same(&draw(middle), &first) { low = middle } else { high = middle }
    }
    let probability = 0.5 * (low + high);
    emit(first, probability);
    emit(last, 1.0 - probability);
}
