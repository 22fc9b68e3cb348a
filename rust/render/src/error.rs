//! Error estimate of a picture from its own samples.

use super::Film;
use super::denominators::{Denominators, around, cross};
use super::film::PixelStatistics;
use super::good_turing::{Chances, Sightings};
use super::heavy_tail_bound::Jumps;
use super::outliers::{DominantSamples, Largest, beside, is_find};
use super::patchwork::Patchwork;
use raywright_base::parallel;
use raywright_optics::Rgb;

/// An estimate of relMSE, the mean over pixels and channels of (x − μ)² / (μ² + 0.01), where x is the picture and μ its
/// expectation. The interval covers the relMSE of this very picture in 95 of 100 cases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// The estimate.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
    /// The few samples that dominate the estimate, which is then unreliable; `None` if there are many, or neighbors
    /// show the same brightness.
    pub carried: Option<DominantSamples>,
}

impl ErrorEstimate {
    /// Widest meaningful interval, as the ratio of its ends.
    const WIDEST: f64 = 30.0;

    /// Returns whether the estimate is reliable. If few samples dominate it, the next of their kind would change it. If
    /// its interval is wide, the light is too rare to be estimated.
    pub fn is_trusted(&self) -> bool {
        self.carried.is_none() && (self.high <= Self::WIDEST * self.low || self.value <= ROUNDING)
    }
}

/// Error of a picture that is accurate to a millionth; the remaining error is mostly rounding, and its distribution is
/// meaningless.
const ROUNDING: f64 = 1e-12;

/// Factor by which an error may be overestimated if stratified samples are treated as independent. Stratification
/// leaves two thirds of the error in batches of 8, and a third in batches of 32 (`benches/samplers.py`).
const EVENNESS: f64 = 4.0;

/// Estimates the error of a film; `None` if a pixel has fewer than two samples.
///
/// The numerator is simple: the variance s²/n of a pixel's mean is an unbiased estimate of (x − μ)². The denominator is
/// not, because μ is unknown; see [`Denominators`]. Light that no sample has found is in neither.
pub(super) fn estimate(film: &Film) -> Option<ErrorEstimate> {
    let fewest = film.fewest();
    if fewest < 2 {
        return None;
    }
    let means = film.means();
    let width = film.width() as usize;
    let (patch, cells) = (film.patch(), film.cells());
    // Rows of patches are summed on all cores, and their sums in order, so that the estimate does not depend on the
    // number of threads.
    let (height, band) = (film.height() as usize, patch as usize);
    let seen: Vec<(Sightings, Vec<f64>)> = parallel::map_chunks(height, band, |rows| {
        let (mut seen, mut shown, mut spreads) =
            (Sightings::default(), Vec::new(), vec![PixelStatistics::default(); width]);
        for y in rows {
            film.spreads(y as u32, &mut spreads);
            let peaks = spreads.iter().flat_map(|spread| &spread.peaks[..cells]);
            peaks.for_each(|peak| seen.add(peak.brightness, peak.again));
            shown.extend(spreads.iter().map(|spread| spread.others.abs().max()));
        }
        (seen, shown)
    });
    let mut sightings = Sightings::default();
    seen.iter().for_each(|(band, _)| sightings.join(band));
    let chances = sightings.chances();
    let shown: Vec<f64> = seen.into_iter().flat_map(|(_, shown)| shown).collect();
    let picture = PixelErrors { means: &means, shown: &shown, width, patch: patch as usize, cells, chances: &chances };
    let sums: Vec<ErrorSums> = parallel::map_chunks(height, band, |rows| {
        let (mut sums, mut spreads) = (ErrorSums::default(), vec![PixelStatistics::default(); width]);
        let mut patches = vec![Patch::default(); width.div_ceil(band)];
        for y in rows {
            film.spreads(y as u32, &mut spreads);
            for (x, spread) in spreads.iter().enumerate() {
                patches[x / band].add(&picture, (x, y), spread, &mut sums.jumps);
            }
        }
        for patch in &patches {
            sums.add(patch);
        }
        sums
    });
    let mut all = ErrorSums::default();
    for band in &sums {
        all.join(band);
    }
    let estimate = all.estimate(3.0 * means.len() as f64, Patchwork { patch }.evenness());
    let leeway = if fewest < 2 * film.batch() && film.batch() > 1 { EVENNESS } else { 1.0 };
    Some(ErrorEstimate { low: estimate.low / leeway, ..estimate })
}

/// Sums over patches.
#[derive(Clone, Copy, Default)]
struct ErrorSums {
    /// Errors.
    error: f64,
    /// Errors with the denominators that make them least, and with those that make them largest.
    least: f64,
    most: f64,
    /// Errors with the same denominator for all samples of a pixel, and with denominators from the pixel's own mean.
    alike: f64,
    own: f64,
    /// Sums of squares and cubes of the largest errors.
    squares: f64,
    cubes: f64,
    /// Possible contribution of rare samples to the second and third cumulant.
    rare: [f64; 2],
    /// Largest contributions of single unconfirmed samples.
    largest: Largest,
    /// Possible errors of pixels beyond the largest estimate.
    jumps: Jumps,
}

/// Sums over the pixels of a patch.
#[derive(Clone, Copy, Default)]
struct Patch {
    error: f64,
    least: f64,
    most: f64,
    alike: f64,
    own: f64,
    /// Contributions of the largest samples, per kind of cell. Neighbors mostly share one such sample within the
    /// patch.
    peaks: [f64; 2],
    /// The part of these that no neighbor confirms.
    finds: [f64; 2],
}

/// The whole picture, for neighbor lookups.
struct PixelErrors<'a> {
    means: &'a [Rgb],
    /// Brightness of pixels without their outliers.
    shown: &'a [f64],
    width: usize,
    patch: usize,
    cells: usize,
    chances: &'a Chances,
}

impl Patch {
    #[inline]
    fn add(&mut self, picture: &PixelErrors<'_>, (x, y): (usize, usize), spread: &PixelStatistics, jumps: &mut Jumps) {
        let PixelErrors { means, shown, width, patch, cells, chances } = *picture;
        let mean = means[y * width + x];
        let denominators = Denominators::new(&cross(means, width, x, y), spread.variance, spread.samples);
        // Pixels of a patch share their samples and cannot confirm each other.
        let around = around(means, width, x, y, patch);
        let beside = beside(shown, width, x, y, patch);
        let (mut rest, samples) = (spread.variance, spread.samples / cells as f64);
        for (cell, peak) in spread.peaks[..cells].iter().enumerate() {
            let of_peak = denominators.of_peak(mean, peak.without, around, chances.of(peak.brightness), samples);
            let brings = peak.variance.dot(of_peak.likely);
            self.peaks[cell] += brings;
            if is_find(peak.brightness, shown[y * width + x], beside) {
                self.finds[cell] += brings;
            }
            let most = peak.variance.dot(of_peak.most);
            if of_peak.hangs {
                jumps.add(peak.variance, mean, peak.without, most);
            }
            self.error += brings;
            self.least += peak.variance.dot(of_peak.least);
            self.most += most;
            rest -= peak.variance;
        }
        // Rounding may make it negative.
        let rest = rest.at_least(Rgb::ZERO);
        self.error += rest.dot(denominators.inverse);
        self.least += rest.dot(denominators.own);
        self.most += rest.dot(denominators.inverse.at_least(denominators.own));
        self.alike += spread.variance.dot(denominators.inverse);
        self.own += spread.variance.dot(denominators.own);
    }
}

impl ErrorSums {
    #[inline]
    fn add(&mut self, patch: &Patch) {
        self.error += patch.error;
        self.least += patch.least;
        self.most += patch.most;
        self.alike += patch.alike;
        self.own += patch.own;
        patch.finds.iter().for_each(|&find| self.largest.add(find));
        if patch.error > 0.0 {
            // Rounding may make the share exceed 1.
            let share = (patch.peaks[0].max(patch.peaks[1]) / patch.error).min(1.0);
            let square = patch.most * patch.most;
            self.squares += square;
            self.cubes += square * patch.most;
            self.rare[0] += square * share;
            self.rare[1] += square * patch.most * share * (22.0 + share);
        }
    }

    fn join(&mut self, other: &Self) {
        self.error += other.error;
        self.least += other.least;
        self.most += other.most;
        self.alike += other.alike;
        self.own += other.own;
        self.squares += other.squares;
        self.cubes += other.cubes;
        self.rare[0] += other.rare[0];
        self.rare[1] += other.rare[1];
        self.largest.join(&other.largest);
        self.jumps.join(&other.jumps);
    }

    /// The estimate over `count` values, where the variance of errors is `evenness` times that of fully correlated
    /// pixels in fixed patches ([`Patchwork::evenness`]).
    ///
    /// Three sources of uncertainty are treated as independent.
    ///
    /// First, the true error of each patch is one realization of (x − μ)². Channels are summed as fully correlated, as
    /// they nearly are, and patches as independent, as they are. (Pixels that take samples together are correlated to
    /// an unknown degree; the interval is slightly wide if the correlation is partial.) Let m be its expectation, which
    /// is the estimate. For a normal x the cumulants are m, 2m² and 8m³. Means of few bright and many dark samples are
    /// skewed, however. With λ bright samples, Poisson-distributed, the cumulants are m, (2 + 1/λ)m² and (8 + 22/λ +
    /// 1/λ²)m³, and the share of the largest sample in the estimate is 1/λ. Other distributions have smaller cumulants
    /// for the same share, which bounds Σδ⁴/(Σδ²)². This affects only rare large errors, so only the upper end uses it.
    /// A few such pixels, as on the rim of a lamp, may hold most of the variance. Then the sum is skewed too, and a
    /// symmetric interval would be exceeded only above.
    ///
    /// Second, the estimate itself is a sum over samples with variance m²/λ. An outlier raises both the error and its
    /// estimate, but they remain uncorrelated, because it also raises its pixel's denominator.
    ///
    /// Third, denominators are uncertain by the changes that alternative choices made, per pixel and in total. Per
    /// pixel, the larger error counts for the upper end. In total, the least error counts for the lower end. For the
    /// upper end it is the change from alternative denominators for all samples of a pixel; those of outliers are
    /// already part of the larger errors.
    ///
    /// All three are factors, and their logarithms are added in quadrature. In addition, one pixel of many may err by
    /// far more than it shows ([`Jumps`]). That is a term, added in quadrature to the upper end.
    fn estimate(&self, count: f64, evenness: f64) -> ErrorEstimate {
        let value = self.error / count;
        if value == 0.0 {
            return ErrorEstimate { value, low: 0.0, high: 0.0, carried: None };
        }
        let (square, cube) = (self.most.powi(2), self.most.powi(3));
        let (variance, skewed) = (2.0 * self.squares * evenness, 8.0 * self.cubes * evenness.powi(2));
        let least = quantile(-1.96, variance / square, skewed / cube);
        let (variance, skewed) = ((variance + self.rare[0]) / square, (skewed + self.rare[1]) / cube);
        // With very few samples, their rarity is uncertain too. The logarithm of the factor is then wider; otherwise it
        // is narrower.
        let greatest = quantile(1.96, variance, skewed).max((1.96 * variance.sqrt()).exp());
        let estimate = 1.96 * (self.rare[0] / square).sqrt();
        let doubts = [self.least / self.error, self.own / self.alike];
        let factor = |of: f64, doubt: f64| of.ln().hypot(estimate).hypot(doubt.ln()).exp();
        let (low, high) = (factor(least, doubts[0]), factor(greatest, doubts[1]));
        let carried = if value > ROUNDING { self.largest.carry(self.error) } else { None };
        let beyond = (self.most * (high - 1.0)).hypot(self.jumps.with(0.025));
        ErrorEstimate { value, low: value / low, high: (self.most + beyond) / count, carried }
    }
}

/// Quantile of a sum of squares with mean 1 and these second and third cumulants, for a normal deviate.
///
/// The sum is approximated by χ² with degrees of freedom that match the skewness (Pearson, 1959), and that by Wilson
/// and Hilferty (1931). The approximation fails below one degree, so one is the minimum. At 1.96 the result, in
/// standard deviations, is within 4 % down to a fifth of a degree.
fn quantile(normal: f64, variance: f64, skewed: f64) -> f64 {
    let degrees = (8.0 * variance.powi(3) / (skewed * skewed)).max(1.0);
    let part = 2.0 / (9.0 * degrees);
    let cube = (1.0 - part + normal * part.sqrt()).powi(3);
    // The square of one normal deviate exceeds a thousandth of its mean in 975 of 1000 cases, and so do sums of them.
    (1.0 + (variance * degrees / 2.0).sqrt() * (cube - 1.0)).max(0.001)
}

#[cfg(test)]
mod tests {
    use super::super::denominators::FLOOR;
    use super::*;
    use raywright_base::cases;
    use raywright_base::sampling::Sampler;

    /// A film whose samples are the pixel's `brightness` times a random factor of mean 1, above 1/e half of the time.
    fn film(side: u32, samples: u32, seed: u64, brightness: impl Fn(u32, u32) -> f64) -> Film {
        let mut film = Film::new(side, side, 16, 1, false, None);
        for tile in film.extend_to(samples) {
            for (i, (x, y)) in tile.pixels().enumerate() {
                for number in 0..samples {
                    // An exponential variable: variance 1, skewness 2.
                    let draw = -Sampler::new(seed, y * side + x, number).two(0)[0].ln();
                    tile.add(i, Rgb::splat(brightness(x, y) * draw), 1.0);
                }
            }
        }
        film
    }

    /// True relMSE of a film.
    fn truth(film: &Film, brightness: impl Fn(u32, u32) -> f64) -> f64 {
        let means = film.means();
        let sum: f64 = means
            .iter()
            .enumerate()
            .map(|(i, mean)| {
                let mu = brightness(i as u32 % film.width(), i as u32 / film.width());
                (mean[0] - mu).powi(2) / (mu * mu + FLOOR)
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
            // For detailed pictures the estimate is unreliable below 16 samples, because neighbors are unrelated.
            let counts = if i < 2 { &[2, 4, 8, 16, 64, 256][..] } else { &[16, 64, 256] };
            for &samples in counts.iter().filter(|&&samples| samples < 256 || cases::are_all()) {
                let (mut close, mut covered) = (0, 0);
                for seed in 0..100 {
                    let film = film(32, samples, seed, brightness);
                    let (estimate, truth) = (estimate(&film).unwrap(), truth(&film, brightness));
                    close += u32::from((0.8..1.25).contains(&(estimate.value / truth)));
                    covered += u32::from((estimate.low..estimate.high).contains(&truth));
                }
                // For a 95 % interval, 89 or fewer hits of 100 have probability 0.01.
                assert!(close >= 95 && covered >= 89, "picture {i}, {samples} samples: {close}, {covered}");
            }
        }
    }

    /// A film in halves with 16 to 64 samples per cell: random factors of mean 1.
    fn uneven(seed: u64, draw: impl Fn(u32, u32, f64) -> f64) -> Film {
        let mut film = Film::new(16, 16, 16, 1, true, None);
        for tile in film.extend_to(80) {
            for cell in 0..tile.counts().len() {
                let (x, y) = tile.position(cell);
                for nth in 0..16 * (1 + (3 * x + 5 * y + 2 * (cell as u32 % 2)) % 4) {
                    let uniform = Sampler::new(seed, y * 16 + x, tile.number(cell, nth)).two(0)[0];
                    tile.add(cell, Rgb::splat(draw(x, y, uniform)), 1.0);
                }
            }
        }
        film
    }

    #[test]
    fn holds_on_both_sides_for_halves_of_differing_counts_and_few_rare_samples() {
        let exponential = |_: u32, _: u32, uniform: f64| -uniform.ln();
        // One pixel in sixteen holds the error, with half of its light in one of `many` samples.
        let rims = [5.0, 10.0, 20.0].map(|many| {
            move |x: u32, y: u32, uniform: f64| {
                let rim = x % 4 == 2 && y % 4 == 2;
                if rim { 0.5 + if uniform * many < 1.0 { many / 2.0 } else { 0.0 } } else { 0.9 + 0.2 * uniform }
            }
        });
        let kinds: [&(dyn Fn(u32, u32, f64) -> f64 + Sync); 4] = [&exponential, &rims[0], &rims[1], &rims[2]];
        for (i, draw) in kinds.into_iter().enumerate() {
            let off = parallel::map(300, |seed| {
                let film = uneven(seed as u64, draw);
                let (estimate, truth) = (estimate(&film).unwrap(), truth(&film, |_, _| 1.0));
                [truth < estimate.low, truth > estimate.high]
            });
            let [below, above] = [0, 1].map(|side| off.iter().filter(|off| off[side]).count());
            // For a rate of 1 in 40 on each side, 15 or more of 300 have probability 0.01.
            assert!(below < 15 && above < 15, "kind {i}: {below} below, {above} above");
        }
    }

    #[test]
    fn quantiles_are_those_of_chi_squared() {
        // For 1, 2, 5 and 20 degrees of freedom, over their number: the quantiles at 1/40 and 39/40.
        for (degrees, low, high) in
            [(1.0, 0.001, 5.024), (2.0, 0.0253, 3.689), (5.0, 0.1662, 2.567), (20.0, 0.4795, 1.708)]
        {
            let (variance, skewed) = (2.0 / degrees, 8.0 / f64::powi(degrees, 2));
            assert!((quantile(-1.96, variance, skewed) - low).abs() < 0.02);
            assert!((quantile(1.96, variance, skewed) / high - 1.0).abs() < 0.02);
        }
    }

    #[test]
    fn nothing_known_and_nothing_wrong() {
        assert_eq!(estimate(&film(4, 1, 0, |_, _| 1.0)), None);
        let black = estimate(&film(4, 4, 0, |_, _| 0.0)).unwrap();
        assert_eq!((black.value, black.low, black.high), (0.0, 0.0, 0.0));
    }

    #[test]
    fn rounding_is_not_to_be_distrusted() {
        let off = |by: f64| {
            let mut film = Film::new(4, 4, 16, 1, false, None);
            for tile in film.extend_to(16) {
                for (pixel, number) in (0..16).flat_map(|pixel| (0..16).map(move |number| (pixel, number))) {
                    tile.add(pixel, Rgb::splat(if (pixel, number) == (5, 3) { 1.0 + by } else { 1.0 }), 1.0);
                }
            }
            estimate(&film).unwrap()
        };
        let (large, small) = (off(1e-3), off(1e-5));
        assert!(large.value > ROUNDING && large.carried.is_some_and(|carried| carried.samples == 1));
        assert!((0.0..ROUNDING).contains(&small.value) && small.carried.is_none());
    }

    #[test]
    fn what_the_next_pixels_show_by_all_their_samples_is_no_find() {
        // A lamp that two pixels on its rim hit with one of 16 samples each; all other samples agree.
        let carried = |lamp: [f64; 2], batch: u32, patch: u32| {
            let mut film = Film::new(12, 12, 12, batch, false, None).in_patches(patch);
            for tile in film.extend_to(16) {
                for (i, (x, y)) in tile.pixels().enumerate() {
                    for number in 0..16 {
                        let met = number == 5 && (x == 3 && y < 4 && y % 2 == 0);
                        let bright = if met {
                            lamp[0]
                        } else if x > 3 {
                            lamp[1]
                        } else {
                            0.1
                        };
                        tile.add(i, Rgb::splat(bright), 1.0);
                    }
                }
            }
            estimate(&film).unwrap().carried
        };
        for batch in [1, 4] {
            assert_eq!(carried([20.0, 20.0], batch, 1), None);
            assert_eq!(carried([20.0, 11.0], batch, 1), None);
            // A brighter sample than neighbors show, and one that nothing confirms.
            for shown in [9.0, 0.1] {
                let carried = carried([20.0, shown], batch, 1).expect("two samples are all there is");
                assert!(carried.samples <= 2 && carried.share > 0.5, "{carried:?}");
            }
        }
        // Pixels of one patch share their samples; the next patch counts like the next pixel.
        assert_eq!(carried([20.0, 20.0], 1, 4), None);
    }

    #[test]
    fn is_bounded_by_a_lamp_in_the_dark() {
        // One sample of one pixel hits a lamp; its own mean alone would make that an error of 1.
        let lamp = |lit: f64| {
            let mut film = Film::new(9, 9, 16, 1, false, None);
            for tile in film.extend_to(16) {
                for pixel in 0..81 {
                    for number in 0..16 {
                        let bright = pixel == 40 && number == 3;
                        tile.add(pixel, Rgb::splat(if bright { lit } else { 0.01 }), 1.0);
                    }
                }
            }
            estimate(&film).unwrap()
        };
        let error = lamp(1e6);
        assert!(error.value < 4.01 / 81.0 && error.value > 1.0 / 81.0);
        assert!(error.low < error.value / 4.0 && error.high > error.value * 4.0);
        let carried = error.carried.expect("one sample is all there is");
        assert!(carried.samples == 1 && carried.share > 0.9 && carried.share <= 1.0, "{carried:?}");
    }
}
