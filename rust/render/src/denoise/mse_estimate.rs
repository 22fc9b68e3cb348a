//! The denoised picture and its error estimate.

use super::super::ErrorEstimate;
use super::super::denominators::{Denominators, cross};
use super::super::outliers::{Largest, beside, is_find};
use super::super::patchwork::Patchwork;
use super::halves::Halves;
use super::planes::{Size, blurred};
use super::selection::selected;
use raywright_base::parallel;
use raywright_optics::Rgb;

/// A denoised picture with its error estimate.
#[derive(Clone, Debug)]
pub struct Denoised {
    /// The picture.
    pub means: Vec<Rgb>,
    /// Squared errors per pixel, averaged over neighbors.
    pub squares: Vec<Rgb>,
    /// Error of the picture.
    pub error: ErrorEstimate,
}

/// Radius of the box over which squared errors are averaged; applied twice.
const REACH: usize = 3;

/// Selects among the candidates of each half, pixel by pixel, and estimates the error of the result.
///
/// One quarter b of the other half selects among the candidates of a half, and the other quarter, b′, estimates the
/// error. For a picture x that is independent of b′, the expectation of (x − b′)² is (x − μ)² plus the variance of b′.
/// The expectation of (b − b′)² / 2 is that variance, even if x depends on b, because x does not occur in it. So (x −
/// b′)² − (b − b′)² / 2 is an unbiased estimate of the squared error of x, for any filter and selection. There are four
/// such pictures: two halves, each selected by two quarters. The result is their mean, whose squared error is the mean
/// of theirs minus their variance about it. No variance needs to be known, and filters may be arbitrary.
///
/// Denominators are as in all error estimates (`denominators.rs`), except that the filtered picture replaces the
/// neighbors.
pub fn settle(halves: &Halves, candidates: &[Vec<Vec<Rgb>>; 2]) -> Denoised {
    let size = Size { width: halves.width, height: halves.height };
    let Outcome { picture, errors, apart } = outcome(halves, candidates, size);
    // Independently filtered halves differ by their own noise, which bounds the error from below.
    let varies = smooth(&apart, size);
    let squares = smooth(&errors, size).iter().zip(&varies).map(|(error, least)| error.at_least(*least)).collect();
    let error = told(halves, &picture, &errors, &varies);
    Denoised { means: picture, squares, error }
}

/// Result of the selection.
struct Outcome {
    picture: Vec<Rgb>,
    /// Unbiased squared errors of its pixels.
    errors: Vec<Rgb>,
    /// Squared differences of the halves from it.
    apart: Vec<Rgb>,
}

fn outcome(halves: &Halves, candidates: &[Vec<Vec<Rgb>>; 2], size: Size) -> Outcome {
    let quarters = &halves.quarters;
    // Half of the candidates, quarter that selects, quarter that estimates.
    let ways = [(0, 2, 3), (0, 3, 2), (1, 0, 1), (1, 1, 0)];
    let chosen = ways.map(|(half, chooser, _)| {
        selected(&candidates[half], &quarters[chooser], &halves.variances[half], halves.samples / 2.0, size)
    });
    let mean = |i: usize| (chosen[0][i] + chosen[1][i] + chosen[2][i] + chosen[3][i]) / 4.0;
    let picture: Vec<Rgb> = parallel::collect(size.pixels(), mean);
    let of = |i: usize| {
        let mut sum = Rgb::ZERO;
        for (chosen, (_, chooser, teller)) in chosen.iter().zip(ways) {
            let (off, apart) = (chosen[i] - quarters[teller][i], quarters[chooser][i] - quarters[teller][i]);
            let about = chosen[i] - picture[i];
            sum += off * off - apart * apart / 2.0 - about * about;
        }
        sum / 4.0
    };
    let errors = parallel::collect(size.pixels(), of);
    let apart = |i: usize| {
        let off = (chosen[0][i] + chosen[1][i] - chosen[2][i] - chosen[3][i]) / 4.0;
        off * off
    };
    let apart = parallel::collect(size.pixels(), apart);
    Outcome { picture, errors, apart }
}

fn smooth(values: &[Rgb], size: Size) -> Vec<Rgb> {
    let of = |channel: usize| {
        let plane: Vec<f64> = values.iter().map(|rgb| rgb[channel]).collect();
        blurred(&blurred(&plane, size, REACH), size, REACH)
    };
    let [red, green, blue] = [of(0), of(1), of(2)];
    (0..values.len()).map(|i| Rgb::new(red[i], green[i], blue[i])).collect()
}

/// Estimates the error of a picture from unbiased but noisy squared errors of its pixels.
///
/// Their noise is independent except within patches, so their squares give the noise of the sum. The uncertainty of
/// denominators is the change that alternatives would make: those of the filtered picture alone, which may be too
/// bright by leaked light, with and without neighbors, and those of the noisy picture. A few dominant pixels are
/// reported if they contain light that their neighbors do not show.
///
/// The squares are skewed: if the sum happens to be small, so are the squares that estimate its noise. So the upper end
/// uses the ratio that a logarithm with the same uncertainty would have.
fn told(halves: &Halves, picture: &[Rgb], errors: &[Rgb], varies: &[Rgb]) -> ErrorEstimate {
    let (width, patch) = (halves.width, halves.patch);
    let across = width.div_ceil(patch);
    let means: Vec<Rgb> = halves.mean(0).iter().zip(halves.mean(1)).map(|(a, b)| (*a + b) / 2.0).collect();
    let shown: Vec<f64> = means.iter().map(|mean| mean.abs().max()).collect();
    let mut patches = vec![0.0; across * halves.height.div_ceil(patch)];
    let (mut largest, mut others) = (Largest::default(), [0.0; 3]);
    for (i, &error) in errors.iter().enumerate() {
        let (x, y) = (i % width, i / width);
        let [mean, filtered] = [means[i], picture[i]];
        let variance = (halves.variances[0][i] + halves.variances[1][i]) / 4.0;
        let of = |cross: &[Rgb; 5], variance| Denominators::new(cross, variance, halves.samples);
        let likely = of(&[mean, filtered, filtered, filtered, filtered], variance);
        let near = of(&cross(picture, width, x, y), varies[i]);
        let noisy = of(&cross(&means, width, x, y), variance);
        let brings = error.dot(likely.inverse);
        for (other, inverse) in others.iter_mut().zip([near.inverse, near.own, noisy.inverse]) {
            *other += error.dot(inverse);
        }
        patches[y / patch * across + x / patch] += brings;
        let quarters = halves.quarters.each_ref().map(|quarter| quarter[i].abs().max());
        let brightest = quarters.into_iter().fold(0.0, f64::max);
        let rest = (quarters.iter().sum::<f64>() - brightest) / 3.0;
        if is_find(brightest, rest, beside(&shown, width, x, y, patch)) {
            largest.add(brings.max(0.0));
        }
    }
    let count = 3.0 * errors.len() as f64;
    let sum: f64 = patches.iter().sum();
    let evenness = Patchwork { patch: patch as u32 }.evenness();
    let noise = 1.96 * (evenness * patches.iter().map(|patch| patch * patch).sum::<f64>()).sqrt();
    let [least, most] = others.iter().fold([sum; 2], |[least, most], &other| [least.min(other), most.max(other)]);
    let value = sum.max(0.0) / count;
    ErrorEstimate {
        value,
        low: ((sum - noise.hypot(sum - least)) / count).max(0.0),
        high: greatest(sum, noise.hypot(most - sum)) / count,
        carried: if sum > 0.0 { largest.carry(sum) } else { None },
    }
}

/// Upper end of a sum with this uncertainty.
fn greatest(sum: f64, away: f64) -> f64 {
    /// Beyond this ratio the sum carries no information.
    const MOST: f64 = 4.0;
    let times = if sum > 0.0 { (away / sum).min(MOST).exp() } else { 0.0 };
    (sum + away).max(sum * times).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;

    const SIDE: usize = 24;

    /// Halves whose quarters are 1 plus noise of known variance.
    fn halves(seed: u64) -> Halves {
        let noise = |quarter: u32, i: usize| {
            let mut sampler = Sampler::new(seed, i as u32, quarter);
            // Skewed noise of variance 1.
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
        // Candidates: unchanged, an independent part, and too bright everywhere.
        let size = Size { width: SIDE, height: SIDE };
        let (mut told, mut are, mut held) = (0.0, 0.0, 0);
        for seed in 0..60 {
            let halves = halves(seed);
            let candidates = [0, 1].map(|half| {
                let mean = halves.mean(half);
                let part = mean.iter().map(|rgb| *rgb * 0.8).collect();
                vec![mean, part, vec![Rgb::splat(if half == 0 { 1.4 } else { 1.2 }); SIDE * SIDE]]
            });
            let found = outcome(&halves, &candidates, size);
            let truth: f64 = found.picture.iter().map(|rgb| (*rgb - Rgb::ONE).dot(*rgb - Rgb::ONE)).sum();
            told += found.errors.iter().map(|error| error.sum()).sum::<f64>();
            are += truth;
            let error = settle(&halves, &candidates).error;
            let relative = truth / (3 * SIDE * SIDE) as f64 / 1.01;
            held += usize::from((error.low..=error.high).contains(&relative));
        }
        // A squared error is accurate to about 0.7 of itself, and that of 60 pictures to 1/40.
        assert!((told / are - 1.0).abs() < 0.1, "{told} {are}");
        // For 95 % intervals, 51 of 60 hits or fewer have a probability of 1 in 600.
        assert!(held > 51, "{held}");
    }
}
