//! The picture that comes out, and how wrong it is.

use super::super::ErrorEstimate;
use super::super::denominators::{Denominators, cross};
use super::super::outliers::Largest;
use super::super::patchwork::Patchwork;
use super::halves::Halves;
use super::planes::{Size, blurred};
use super::selection::selected;
use crate::optics::Rgb;
use rayon::prelude::*;

/// A picture that was filtered, and what is known of its error.
#[derive(Clone, Debug)]
pub struct Denoised {
    /// The picture.
    pub means: Vec<Rgb>,
    /// What its pixels are off by, squared, as the pixels around tell.
    pub squares: Vec<Rgb>,
    /// Its error.
    pub error: ErrorEstimate,
}

/// Errors of a pixel are told by squares that go so far, twice one after the other.
const REACH: usize = 3;

/// Settles for one of the candidates of each half, pixel by pixel, and tells the error of the outcome.
///
/// One quarter b of the other half chooses among the candidates of a half, and the other, b′, tells what was chosen: of
/// a picture x that knows nothing of b′, (x − b′)² is (x − μ)² and the variance of b′ on average. That variance is
/// (b − b′)² / 2 less what b and b′ differ in, on average over all that there might be; x may know of b, for that
/// enters the sum without regard to x. So (x − b′)² − (b − b′)² / 2 is the squared error of x without bias, whatever
/// filter x comes from and however it was chosen. There are four such pictures: of two halves, each chosen by two
/// quarters. What comes out is their mean, whose squared error is the mean of theirs less their own variance about it,
/// to the last bit. No variance is known beforehand, and nothing is assumed of filters.
///
/// The denominators are as in every other error ([`Denominators`]), of the filtered picture.
pub fn settle(halves: &Halves, candidates: &[Vec<Vec<Rgb>>; 2]) -> Denoised {
    let size = Size { width: halves.width, height: halves.height };
    let quarters = &halves.quarters;
    let means = [halves.mean(0), halves.mean(1)];
    // Whose candidates, who chooses, who tells.
    let ways = [(0, 2, 3), (0, 3, 2), (1, 0, 1), (1, 1, 0)];
    let chosen = ways.map(|(half, chooser, _)| selected(&means[half], &candidates[half], &quarters[chooser], size));
    let picture: Vec<Rgb> =
        (0..size.pixels()).map(|i| (chosen[0][i] + chosen[1][i] + chosen[2][i] + chosen[3][i]) / 4.0).collect();
    let of = |i: usize| {
        let mut sum = Rgb::ZERO;
        for (chosen, (_, chooser, teller)) in chosen.iter().zip(ways) {
            let (off, apart) = (chosen[i] - quarters[teller][i], quarters[chooser][i] - quarters[teller][i]);
            let about = chosen[i] - picture[i];
            sum += off * off - apart * apart / 2.0 - about * about;
        }
        sum / 4.0
    };
    let errors: Vec<Rgb> = (0..size.pixels()).into_par_iter().map(of).collect();
    let apart = |i: usize| {
        let off = (chosen[0][i] + chosen[1][i] - chosen[2][i] - chosen[3][i]) / 4.0;
        off * off
    };
    // Two halves that were filtered apart vary apart: by that much the picture is off at least.
    let varies = smooth(&(0..size.pixels()).map(apart).collect::<Vec<Rgb>>(), size);
    let squares = smooth(&errors, size).iter().zip(&varies).map(|(error, least)| error.at_least(*least)).collect();
    let error = told(halves, &picture, &errors, &varies);
    Denoised { means: picture, squares, error }
}

fn smooth(values: &[Rgb], size: Size) -> Vec<Rgb> {
    let of = |channel: usize| {
        let plane: Vec<f64> = values.iter().map(|rgb| rgb[channel]).collect();
        blurred(&blurred(&plane, size, REACH), size, REACH)
    };
    let [red, green, blue] = [of(0), of(1), of(2)];
    (0..values.len()).map(|i| Rgb::new(red[i], green[i], blue[i])).collect()
}

/// The error of a picture from what its pixels' squared errors are, each without bias and with much noise.
///
/// The noise of each is independent of that of others but for patches, and their squares tell how large that of the sum
/// is. Denominators are in doubt by as much as choosing them has changed.
fn told(halves: &Halves, picture: &[Rgb], errors: &[Rgb], varies: &[Rgb]) -> ErrorEstimate {
    let (width, patch) = (halves.width, halves.patch);
    let across = width.div_ceil(patch);
    let mut patches = vec![0.0; across * halves.height.div_ceil(patch)];
    let mut own = 0.0;
    for (i, &error) in errors.iter().enumerate() {
        let (x, y) = (i % width, i / width);
        let denominators = Denominators::new(&cross(picture, width, x, y), varies[i], halves.samples);
        patches[y / patch * across + x / patch] += error.dot(denominators.inverse);
        own += error.dot(denominators.own);
    }
    let count = 3.0 * errors.len() as f64;
    let sum: f64 = patches.iter().sum();
    let mut largest = Largest::default();
    patches.iter().for_each(|&patch| largest.add(patch.max(0.0)));
    let evenness = Patchwork { patch: patch as u32 }.evenness();
    let noise = 1.96 * (evenness * patches.iter().map(|patch| patch * patch).sum::<f64>()).sqrt();
    let doubt = sum - own;
    let away = noise.hypot(doubt);
    let value = sum.max(0.0) / count;
    ErrorEstimate {
        value,
        low: ((sum - away) / count).max(0.0),
        high: (sum + away).max(0.0) / count,
        carried: if sum > 0.0 { largest.carry(sum) } else { None },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;

    const SIDE: usize = 24;

    /// Halves whose quarters are 1 and noise, and of a variance that is known.
    fn halves(seed: u64) -> Halves {
        let noise = |quarter: u32, i: usize| {
            let mut sampler = Sampler::new(seed, i as u32, quarter);
            // Skewed, of variance 1.
            Rgb::new(-sampler.one(0).ln(), -sampler.one(1).ln(), -sampler.one(2).ln())
        };
        let count = SIDE * SIDE;
        Halves {
            width: SIDE,
            height: SIDE,
            patch: 1,
            samples: 16.0,
            quarters: std::array::from_fn(|quarter| (0..count).map(|i| noise(quarter as u32, i)).collect()),
            variances: std::array::from_fn(|_| vec![Rgb::splat(0.5); count]),
        }
    }

    #[test]
    fn errors_are_told_without_bias_whatever_was_chosen() {
        // Candidates: as it is, half of it, and the truth that is a tenth too bright.
        let (mut told, mut are, mut held) = (0.0, 0.0, 0);
        for seed in 0..60 {
            let halves = halves(seed);
            let candidates = [0, 1].map(|half| {
                let mean = halves.mean(half);
                let part = mean.iter().map(|rgb| *rgb * 0.9).collect();
                vec![mean, part, vec![Rgb::splat(if half == 0 { 1.1 } else { 0.8 }); SIDE * SIDE]]
            });
            let done = settle(&halves, &candidates);
            let off = |rgb: &Rgb| (*rgb - Rgb::ONE).dot(*rgb - Rgb::ONE);
            let truth = done.means.iter().map(off).sum::<f64>() / (3 * SIDE * SIDE) as f64 / 1.01;
            told += done.error.value;
            are += truth;
            held += usize::from((done.error.low..=done.error.high).contains(&truth));
        }
        assert!((told / are - 1.0).abs() < 0.1, "{told} {are}");
        // Of intervals that hold in 95 of 100 cases, 51 of 60 or fewer do so once in 600.
        assert!(held > 51, "{held}");
    }
}
