//! How uncertain pixels of few batches are, told from those around as well.

use super::Film;
use super::film::Spread;
use super::student::{digamma, trigamma, trigamma_inverse};
use raywright_base::parallel;
use raywright_optics::Rgb;

/// How uncertain each pixel is.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// The variance of its mean, from its own batches, without bias.
    pub variances: Vec<Rgb>,
    /// The same as far as pixels around tell of it too: a mean is off by its root, times Student's t.
    pub pooled: Vec<Rgb>,
    /// Degrees of freedom of that t.
    pub degrees: Vec<f64>,
}

/// Pixels up to so many away tell of one.
const AWAY: usize = 2;

/// The most degrees of freedom that neighbours are worth: t is hardly another from there on, and a pixel with as many
/// of its own still has half of the say.
const MOST: f64 = 60.0;

/// How uncertain the pixels of a film are; `None` where a cell has fewer than two samples.
///
/// Few large batches leave the least error, and of a pixel with four of them the variance has three degrees of freedom:
/// 1.96 standard errors would hold the truth in 86 of 100 cases. But what samples bring without regard to each other is
/// known well, from all of them, and only what their placing leaves of that, a ratio, is known from batches. It goes by
/// what is seen, and so is much the same in pixels side by side. How much the same is seen from the picture: a pixel's
/// ratio is taken for one draw of many, distributed about the mean of the pixels around as inverse χ² of `d0` degrees
/// are, where `d0` is what explains how far log ratios are from that mean, beyond what their own degrees `d` do. Then
/// the likely ratio, given the pixel's own as well, is a weighted mean of the two, and what the pixel's mean is off by,
/// over the root of the variance, is Student's t of `d + d0` degrees (Smyth, "Linear Models and Empirical Bayes Methods
/// for Assessing Differential Expression", 2004). Where pixels side by side differ, `d0` is small, and each speaks for
/// itself. On the edge of a lamp, where placing leaves less than beside it, the variance comes out too large.
pub(super) fn uncertainty(film: &Film) -> Option<Uncertainty> {
    let spreads = film.all_spreads()?;
    let cells = film.cells() as f64;
    let variances: Vec<Rgb> = spreads.iter().map(|spread| spread.variance).collect();
    let own = |spread: &Spread| if spread.degrees > 0.0 { spread.degrees } else { spread.samples - cells };
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

/// The logarithm of what the placing of samples leaves of a pixel's variance, without bias; `None` where there is none.
fn log_ratio(spread: &Spread) -> Option<f64> {
    let (variance, alone) = (spread.variance.sum(), spread.alone.sum());
    let half = spread.degrees / 2.0;
    // Batches that agree to the last bit say no more than that they agree well.
    (half > 0.0 && alone > 0.0).then(|| (variance / alone).max(1e-12).ln() - digamma(half) + half.ln())
}

/// The mean of those around each pixel, without itself, if there are some.
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
        // Few would not tell more than the pixel itself does.
        (count >= 8.0).then(|| sum / count)
    };
    parallel::collect(logs.len(), mean)
}

/// How many degrees of freedom the mean of those around is worth.
fn prior(spreads: &[Spread], logs: &[Option<f64>], around: &[Option<f64>]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for ((spread, log), around) in spreads.iter().zip(logs).zip(around) {
        if let (Some(log), Some(around)) = (log, around) {
            sum += (log - around).powi(2) - trigamma(spread.degrees / 2.0);
            count += 1.0;
        }
    }
    // What is left of the squares when chance in the pixel's own batches is taken off.
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

    /// A film of draws of mean 1, so many batches of them, of whose variance their placing leaves `ratio(x, y)`.
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

    /// The variances told over those that there are, what share of intervals of 95 % holds, and degrees of freedom.
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
        // Of 9216 pixels chance leaves 94.1 to 95.9 % once in 16,000 cases; the bounds leave as much again.
        for batches in [4, 8] {
            let [told, held, degrees] = judged(batches, |x, _| if x < 24 { 0.5 } else { 0.2 });
            assert!((0.95..1.05).contains(&told), "{batches} batches: {told}");
            assert!((0.93..0.97).contains(&held), "{batches} batches: {held}");
            assert!(degrees > 15.0, "{degrees}");
        }
    }

    #[test]
    fn pixels_that_differ_speak_for_themselves() {
        // Side by side, a hundred times more and less.
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
