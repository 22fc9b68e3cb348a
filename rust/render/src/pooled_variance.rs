//! Per-pixel uncertainty from few batches, pooled with neighbors.

use super::Film;
use super::film::PixelStatistics;
use super::student::{digamma, trigamma, trigamma_inverse};
use raywright_base::parallel;
use raywright_optics::Rgb;

/// Uncertainty of each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// Unbiased variance of its mean, from its own batches.
    pub variances: Vec<Rgb>,
    /// Variance pooled with neighbors; a confidence interval is its square root times Student's t.
    pub pooled: Vec<Rgb>,
    /// Degrees of freedom of that t.
    pub degrees: Vec<f64>,
}

/// Radius of the pooled neighborhood.
const AWAY: usize = 2;

/// Maximum degrees of freedom from neighbors. Beyond it t barely changes, and a pixel with as many of its own still
/// has half the weight.
const MOST: f64 = 60.0;

/// Uncertainty of a film's pixels; `None` if a cell has fewer than two samples.
///
/// Few large batches give the least error, but the variance from four batches has three degrees of freedom: 1.96
/// standard errors would cover the truth in 86 of 100 cases. The variance for independent samples is known well, from
/// all samples. Only its reduction by stratification, a ratio, depends on batches. This ratio varies with the visible
/// content, so it is similar in adjacent pixels.
///
/// The similarity is estimated from the picture. A pixel's ratio is modeled as a realization around the mean of its
/// neighbors, distributed as inverse χ² with `d0` degrees of freedom. `d0` explains the scatter of log ratios about
/// that mean beyond the scatter from their own degrees `d`. Given the pixel's own ratio, the posterior ratio is a
/// weighted mean of both. The error of the pixel's mean over the resulting standard error follows Student's t with `d +
/// d0` degrees (Smyth, "Linear Models and Empirical Bayes Methods for Assessing Differential Expression", 2004). If
/// adjacent pixels differ, `d0` is small, and each pixel relies on itself. On the edge of a lamp, where stratification
/// reduces the variance more than beside it, the variance is overestimated.
pub(super) fn uncertainty(film: &Film) -> Option<Uncertainty> {
    let spreads = film.all_spreads()?;
    let cells = film.cells() as f64;
    let variances: Vec<Rgb> = spreads.iter().map(|spread| spread.variance).collect();
    let own = |spread: &PixelStatistics| if spread.degrees > 0.0 { spread.degrees } else { spread.samples - cells };
    if film.batch() == 1 || spreads.iter().all(|spread| spread.degrees == 0.0) {
        let degrees = spreads.iter().map(own).collect();
        return Some(Uncertainty { pooled: variances.clone(), variances, degrees });
    }
    let logs = parallel::collect(spreads.len(), |i| log_ratio(&spreads[i]));
    let around = around(&logs, film.width() as usize);
    let prior = prior(&spreads, &logs, &around);
    let offset = digamma(prior / 2.0) - (prior / 2.0).ln();
    let each = |i: usize| match (around[i], logs[i], &spreads[i]) {
        (Some(mean), Some(_), spread) => {
            let ratio = spread.variance.sum() / spread.alone.sum();
            let all = own(spread) + prior;
            let likely = (own(spread) * ratio + prior * (mean + offset).exp()) / all;
            (spread.alone * likely, all.min(spread.samples - cells))
        }
        (_, _, spread) => (spread.variance, own(spread)),
    };
    let (pooled, degrees) = parallel::collect(spreads.len(), each).into_iter().unzip();
    Some(Uncertainty { variances, pooled, degrees })
}

/// Unbiased logarithm of the ratio by which stratification reduces a pixel's variance; `None` if it is undefined.
fn log_ratio(spread: &PixelStatistics) -> Option<f64> {
    let (variance, alone) = (spread.variance.sum(), spread.alone.sum());
    let half = spread.degrees / 2.0;
    // Batches that agree to the last bit only show that they agree well.
    (half > 0.0 && alone > 0.0).then(|| (variance / alone).max(1e-12).ln() - digamma(half) + half.ln())
}

/// Mean of each pixel's neighbors, without itself, if there are enough.
fn around(logs: &[Option<f64>], width: usize) -> Vec<Option<f64>> {
    let height = logs.len() / width.max(1);
    let near = |at: usize, size: usize| at.saturating_sub(AWAY)..(at + AWAY + 1).min(size);
    let mean = |i: usize| {
        let (x, y) = (i % width, i / width);
        let places = near(y, height).flat_map(|row| near(x, width).map(move |column| row * width + column));
        let (mut sum, mut count) = (0.0, 0.0);
        for log in places.filter(|&place| place != i).filter_map(|place| logs[place]) {
            sum += log;
            count += 1.0;
        }
        // Fewer would tell less than the pixel itself.
        (count >= 8.0).then(|| sum / count)
    };
    parallel::collect(logs.len(), mean)
}

/// Degrees of freedom that the mean of the neighbors is worth.
fn prior(spreads: &[PixelStatistics], logs: &[Option<f64>], around: &[Option<f64>]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for ((spread, log), around) in spreads.iter().zip(logs).zip(around) {
        if let (Some(log), Some(around)) = (log, around) {
            sum += (log - around).powi(2) - trigamma(spread.degrees / 2.0);
            count += 1.0;
        }
    }
    // Excess of the squares over the sampling variance of the pixel's own batches.
    let excess = if count > 0.0 { sum / count } else { f64::INFINITY };
    (2.0 * trigamma_inverse(excess)).clamp(1e-3, MOST)
}

#[cfg(test)]
mod tests {
    use super::super::quantile;
    use super::*;
    use raywright_base::sampling::Sampler;

    const SIDE: u32 = 48;
    const BATCH: u32 = 8;

    /// A film of random values with mean 1 and this many batches; stratification reduces their variance to `ratio(x,
    /// y)`.
    fn film(seed: u64, batches: u32, ratio: impl Fn(u32, u32) -> f64) -> Film {
        let mut film = Film::new(SIDE, SIDE, 16, BATCH, false, None);
        for tile in film.extend_to(batches * BATCH) {
            for (i, (x, y)) in tile.pixels().enumerate() {
                for first in (0..batches * BATCH).step_by(BATCH as usize) {
                    let draws: [f64; BATCH as usize] =
                        std::array::from_fn(|n| Sampler::new(seed, y * SIDE + x, first + n as u32).one(0) - 0.5);
                    let off = draws.iter().sum::<f64>() / f64::from(BATCH) * (1.0 - ratio(x, y).sqrt());
                    draws.iter().for_each(|draw| tile.add(i, Rgb::splat(1.0 + draw - off), 1.0));
                }
            }
        }
        film
    }

    /// Ratio of estimated to true variances, coverage of 95 % intervals, and degrees of freedom.
    fn judged(batches: u32, ratio: fn(u32, u32) -> f64) -> [f64; 3] {
        let (mut told, mut are, mut held, mut degrees) = (0.0, 0.0, 0.0, 0.0);
        for seed in 0..4 {
            let film = film(seed, batches, ratio);
            let known = uncertainty(&film).unwrap();
            for (i, mean) in film.means().iter().enumerate() {
                let (x, y) = (i as u32 % SIDE, i as u32 / SIDE);
                told += known.variances[i][0];
                are += ratio(x, y) / 12.0 / f64::from(batches * BATCH);
                let freedom = known.degrees[i];
                let away = quantile(0.95, freedom) * known.pooled[i][0].sqrt();
                held += f64::from(u8::from((mean[0] - 1.0).abs() <= away));
                degrees += freedom;
            }
        }
        let count = f64::from(4 * SIDE * SIDE);
        [told / are, held / count, degrees / count]
    }

    #[test]
    fn few_batches_are_enough_where_pixels_are_alike() {
        // For 9216 pixels, 94.1 to 95.9 % are exceeded with probability 1 in 16,000; the bounds leave as much again.
        for batches in [4, 8] {
            let [told, held, degrees] = judged(batches, |x, _| if x < 24 { 0.5 } else { 0.2 });
            assert!((0.95..1.05).contains(&told), "{batches} batches: {told}");
            assert!((0.93..0.97).contains(&held), "{batches} batches: {held}");
            assert!(degrees > 15.0, "{degrees}");
        }
    }

    #[test]
    fn pixels_that_differ_speak_for_themselves() {
        // Adjacent pixels that differ by a factor of a hundred.
        let [told, held, degrees] = judged(8, |x, y| if (x * 7 + y * 11) % 5 < 2 { 1.0 } else { 0.01 });
        assert!((0.95..1.05).contains(&told), "{told}");
        assert!((0.93..0.97).contains(&held), "{held}");
        assert!(degrees < 15.0, "{degrees}");
    }

    #[test]
    fn samples_that_are_independent_need_no_neighbours() {
        let mut film = Film::new(3, 3, 16, 1, false, None);
        for tile in film.extend_to(5) {
            for (pixel, number) in (0..9).flat_map(|pixel| (0..5).map(move |number| (pixel, number))) {
                tile.add(pixel, Rgb::splat(Sampler::new(2, pixel as u32, number).one(0)), 1.0);
            }
        }
        let known = uncertainty(&film).unwrap();
        assert_eq!((&known.variances, &known.pooled), (&film.variances().unwrap(), &film.variances().unwrap()));
        assert!(known.degrees.iter().all(|&degrees| degrees == 4.0));
    }

    #[test]
    fn where_there_is_no_noise_there_is_nothing_to_know() {
        let mut film = Film::new(4, 4, 16, 2, false, None);
        for tile in film.extend_to(8) {
            (0..16).for_each(|pixel| (0..8).for_each(|_| tile.add(pixel, Rgb::ZERO, 1.0)));
        }
        let known = uncertainty(&film).unwrap();
        assert!(known.variances.iter().all(|&variance| variance.is_black()));
        assert!(known.degrees.iter().all(|degrees| degrees.is_finite()));
    }
}
