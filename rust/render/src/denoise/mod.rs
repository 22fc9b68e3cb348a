//! Denoising with an unbiased error estimate, by cross-validation between parts of the samples.
//!
//! A picture consists of two halves of its samples, each of two quarters ([`Halves`]). Each half is filtered in several
//! ways ([`candidates`]). A quarter of the other half selects the best candidate per pixel, and the remaining quarter
//! estimates the error ([`settle`]). So no data is judged by itself.

mod features;
mod halves;
mod mse_estimate;
mod planes;
mod regression;
mod selection;
mod similarity;

pub use features::FEATURES;
pub use halves::Halves;
pub use mse_estimate::{Denoised, settle};

use planes::Size;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;

/// Bandwidths of the filters, in standard deviations of the noise within which pixels count as equal.
const BANDWIDTHS: [f64; 2] = [0.5, 1.0];

/// Filters each half of a picture: unfiltered, and with weights by similarity of color and features.
///
/// The filter is the nonlinearly weighted first-order regression of Bitterli, Rousselle, Moon, Iglesias-Guitián, Adler,
/// Mitchell, Jarosz and Novák ("Nonlinearly Weighted First-Order Regression for Denoising Monte Carlo Renderings",
/// 2016). Unlike there, weights for one quarter come from the other quarter of the same half, so that halves stay
/// independent. `features` are two independent pictures of [`FEATURES`] numbers per pixel, each between about −1 and 1.
/// Returns soon after `cancel` is raised, with an invalid result.
pub fn candidates(halves: &Halves, features: &[Vec<f64>; 2], cancel: &Cancel) -> [Vec<Vec<Rgb>>; 2] {
    let size = Size { width: halves.width, height: halves.height };
    let features = features::prefiltered(features, size, cancel);
    let bounded = halves.quarters.iter().flatten().all(|mean| mean.min() >= 0.0);
    std::array::from_fn(|half| {
        let quarters = [&halves.quarters[2 * half], &halves.quarters[2 * half + 1]];
        let variance = halves.variance(half);
        let [one, other] = [[0, 1], [1, 0]].map(|[guide, values]| {
            regression::filtered(quarters[guide], &variance, quarters[values], &features, size, &BANDWIDTHS, cancel)
        });
        let mean = |a: &Rgb, b: &Rgb| {
            let mean = (*a + *b) / 2.0;
            if bounded { mean.at_least(Rgb::ZERO) } else { mean }
        };
        let both = one.iter().zip(&other).map(|(one, other)| one.iter().zip(other).map(|(a, b)| mean(a, b)).collect());
        std::iter::once(halves.mean(half)).chain(both).collect()
    })
}
