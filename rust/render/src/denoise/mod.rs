//! Pictures filtered by parts of their own samples, such that the other parts tell the error of what comes out.
//!
//! A picture is in two halves of samples, each in two quarters ([`Halves`]). Each half is filtered by itself, in some
//! ways ([`candidates`]); which way is best where, a quarter of the other half says; and how wrong the outcome is, the
//! quarter that is left ([`settle`]). So nothing is judged by what it was made of.

mod features;
mod halves;
mod planes;
mod regression;
mod selection;
mod settled;
mod similarity;

pub use features::FEATURES;
pub use halves::Halves;
pub use settled::{Denoised, settle};

use planes::Size;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;

/// How much pixels may differ, in standard deviations of their noise, to be taken for the same: one way to filter each.
const BANDWIDTHS: [f64; 2] = [0.5, 1.0];

/// Each half of a picture in some ways: as it is, and filtered by what is alike in it and in what is seen there first.
///
/// That is the nonlinearly weighted first-order regression of Bitterli, Rousselle, Moon, Iglesias-Guitián, Adler,
/// Mitchell, Jarosz and Novák ("Nonlinearly Weighted First-Order Regression for Denoising Monte Carlo Renderings",
/// 2016), but that its weights come from one quarter for the values of the other, and not from one half for the other:
/// so halves stay independent. `features` are two independent pictures of [`FEATURES`] numbers a pixel, each number
/// between about −1 and 1. Returns soon after `cancel` is raised, with nothing of use.
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
