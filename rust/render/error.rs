//! How wrong a picture still is, told from the picture alone.

use super::Film;
use crate::optics::Rgb;
use rayon::prelude::*;

/// An estimate of relMSE, the mean over pixels and channels of (x − μ)² / (μ² + 0.01), where x is the picture and μ what
/// it tends to. The interval holds the relMSE of this very picture in 95 of 100 cases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// The estimate.
    pub value: f64,
    /// The lower end of the interval.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

/// What is added to the square of a brightness, so that the dark does not count infinitely.
const FLOOR: f64 = 0.01;

/// Estimates the error of a film; `None` below two batches of samples, which say nothing of it.
///
/// The numerator is simple: the variance s²/n of a pixel's mean is an unbiased estimate of (x − μ)². The denominator is
/// not, for μ is unknown, and a pixel's own x will not do: samples are skewed, so that the pixels which happen to have a
/// large s² happen to be bright as well, and dividing the one by the other hides a part of the error. At 16 samples
/// this makes it a quarter too small in a Cornell box, and more than twice too small with point-like highlights. Nor is
/// it repaired by the usual corrections, of x² by s²/n or of 1/(x² + 0.01) by a Taylor series: the noise is too large
/// for them (both were tried, as was the variance of one half of the samples over the mean of the other).
///
/// So μ is taken from the neighbourhood: the median of the pixel and the four beside it. A mean of neighbours is much
/// too bright next to a light, by which errors there are lost (8 to 13 % of all at 16 samples); medians or trimmed means
/// of all eight lose too much beside dark corners. Two bounds keep the median where it can be right.
///
/// It may contradict the pixel's own mean by 5/√n standard errors at most. Weighed by s², a mean of n samples is off by
/// γ/√n standard errors, where γ is the skewness of the samples, some 2 to 5 in global illumination: there is that much
/// to mend and no more. So detail finer than a pixel is not smoothed away, and with more samples each pixel speaks for
/// itself.
///
/// And the denominator is at least a quarter of the one that the pixel gives. A pixel that one sample made bright may be
/// a dark one with a stray sample or a bright one on the edge of a lamp; one sample cannot tell, and the error of a lamp
/// over the square of its dark surroundings would drown all others in the sum.
pub(super) fn estimate(film: &Film) -> Option<ErrorEstimate> {
    let variances = film.variances()?;
    let means = film.means();
    let leeway = 5.0 / f64::from(film.batches()).sqrt();
    let (width, height) = (film.width() as usize, film.height() as usize);
    // Rows are summed on all cores, and their sums in order, so that the estimate does not depend on the threads.
    let rows: Vec<Sums> = (0..height)
        .into_par_iter()
        .map(|y| {
            let mut row = Sums::default();
            for x in 0..width {
                let here = y * width + x;
                let cross = [
                    means[here],
                    means[y * width + x.saturating_sub(1)],
                    means[y * width + (x + 1).min(width - 1)],
                    means[y.saturating_sub(1) * width + x],
                    means[(y + 1).min(height - 1) * width + x],
                ];
                row.add(&cross, variances[here], leeway);
            }
            row
        })
        .collect();
    let mut all = Sums::default();
    for row in &rows {
        all.error += row.error;
        all.squares += row.squares;
        all.own += row.own;
    }
    Some(all.estimate(3.0 * means.len() as f64))
}

/// Sums over pixels.
#[derive(Clone, Copy, Default)]
struct Sums {
    /// The errors.
    error: f64,
    /// Their squares.
    squares: f64,
    /// The errors with each pixel's own mean in the denominator.
    own: f64,
}

impl Sums {
    /// Adds a pixel of this variance, the first of the five of a cross, whose brightness may be so many standard errors
    /// off its mean.
    fn add(&mut self, cross: &[Rgb; 5], variance: Rgb, leeway: f64) {
        let (mut error, mut own) = (0.0, 0.0);
        for channel in 0..3 {
            let (mean, variance) = (cross[0][channel], variance[channel]);
            let off = leeway * variance.sqrt();
            let mut five = cross.map(|rgb| rgb[channel]);
            five.sort_unstable_by(f64::total_cmp);
            let likely = five[2].clamp(mean - off, mean + off);
            let by_itself = mean * mean + FLOOR;
            error += variance / (likely * likely + FLOOR).max(by_itself / 4.0);
            own += variance / by_itself;
        }
        self.error += error;
        self.squares += error * error;
        self.own += own;
    }

    /// The estimate, over so many values in all.
    ///
    /// Two things are uncertain. The true error of each pixel is one draw of (x − μ)², whose variance is twice the square
    /// of its mean; this is summed as if channels err together, as they nearly do, and pixels apart, as they do. And
    /// the denominators are in doubt by as much as choosing them has changed. An error is never negative, and a
    /// factor too large as likely as too small, so the interval is one of factors.
    fn estimate(&self, count: f64) -> ErrorEstimate {
        let value = self.error / count;
        if value == 0.0 {
            return ErrorEstimate { value, low: 0.0, high: 0.0 };
        }
        let chance = 1.96 * (2.0 * self.squares).sqrt() / self.error;
        let doubt = 1.0 - self.own / self.error;
        let factor = chance.hypot(doubt).exp();
        ErrorEstimate { value, low: value / factor, high: value * factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;

    /// A film whose samples are `brightness` of the pixel times a draw of mean 1, from 1/e on half of the time.
    fn film(side: u32, samples: u32, seed: u64, brightness: impl Fn(u32, u32) -> f64) -> Film {
        let mut film = Film::new(side, side, 16, 1);
        for tile in film.extend(samples) {
            for (i, (x, y)) in tile.pixels().enumerate() {
                for number in 0..samples {
                    // An exponential variable: variance 1, skewness 2.
                    let draw = -Sampler::new(seed, y * side + x, number).two(0)[0].ln();
                    tile.add(i, number, Rgb::splat(brightness(x, y) * draw), 1.0);
                }
            }
        }
        film
    }

    /// The true relMSE of a film.
    fn truth(film: &Film, brightness: impl Fn(u32, u32) -> f64) -> f64 {
        let means = film.means();
        let sum: f64 = means
            .iter()
            .enumerate()
            .map(|(i, mean)| {
                let mu = brightness(i as u32 % film.width(), i as u32 / film.width());
                (mean.x - mu).powi(2) / (mu * mu + FLOOR)
            })
            .sum();
        sum / means.len() as f64
    }

    #[test]
    fn agrees_with_the_true_error_of_smooth_edged_and_busy_pictures() {
        let smooth = |x: u32, y: u32| 0.05 + f64::from(x + y) / 32.0;
        let edged = |x: u32, y: u32| if x > 10 && y < 20 && x < 20 { 10.0 } else { 0.3 };
        let busy = |x: u32, y: u32| Sampler::new(77, x, y).one(0) + 0.1;
        let pictures: [&dyn Fn(u32, u32) -> f64; 3] = [&smooth, &edged, &busy];
        for (i, brightness) in pictures.into_iter().enumerate() {
            for samples in [16, 64, 256] {
                let (mut close, mut covered) = (0, 0);
                for seed in 0..100 {
                    let film = film(32, samples, seed, brightness);
                    let (estimate, truth) = (estimate(&film).unwrap(), truth(&film, brightness));
                    close += u32::from((0.8..1.25).contains(&(estimate.value / truth)));
                    covered += u32::from((estimate.low..estimate.high).contains(&truth));
                }
                // One that holds in 95 of 100 fails 89 of 100 times or fewer with probability 0.01.
                assert!(close >= 95 && covered >= 89, "picture {i}, {samples} samples: {close}, {covered}");
            }
        }
    }

    #[test]
    fn nothing_known_and_nothing_wrong() {
        assert_eq!(estimate(&film(4, 1, 0, |_, _| 1.0)), None);
        let black = estimate(&film(4, 4, 0, |_, _| 0.0)).unwrap();
        assert_eq!((black.value, black.low, black.high), (0.0, 0.0, 0.0));
    }

    #[test]
    fn is_bounded_by_a_lamp_in_the_dark() {
        // One sample of one pixel meets a lamp; its own mean alone would make that an error of 1.
        let lamp = |lit: f64| {
            let mut film = Film::new(9, 9, 16, 1);
            for tile in film.extend(16) {
                for pixel in 0..81 {
                    for number in 0..16 {
                        let bright = pixel == 40 && number == 3;
                        tile.add(pixel, number, Rgb::splat(if bright { lit } else { 0.01 }), 1.0);
                    }
                }
            }
            estimate(&film).unwrap()
        };
        let error = lamp(1e6);
        assert!(error.value < 4.01 / 81.0 && error.value > 1.0 / 81.0);
        assert!(error.low < error.value / 4.0 && error.high > error.value * 4.0);
    }
}
