//! Denominators of relative errors: estimates of each pixel's squared brightness.

use super::good_turing::Chance;
use raywright_optics::Rgb;

/// Added to the squared brightness, so that errors in black pixels have finite weight.
pub(super) const FLOOR: f64 = 0.01;

/// Brightness of a pixel and its four neighbors; at the border, its own brightness instead.
#[inline]
pub(super) fn cross(means: &[Rgb], width: usize, x: usize, y: usize) -> [Rgb; 5] {
    let here = y * width + x;
    let or_here = |there: bool, index: usize| means[if there { index } else { here }];
    [
        means[here],
        or_here(x > 0, here.wrapping_sub(1)),
        or_here(x + 1 < width, here + 1),
        or_here(y > 0, here.wrapping_sub(width)),
        or_here(here + width < means.len(), here + width),
    ]
}

/// Denominators of a pixel's squared errors: an estimate of μ² + 0.01.
///
/// A pixel's own mean x cannot replace μ. Samples are skewed, so pixels with a large s² tend to be bright as well, and
/// dividing one by the other hides part of the error. At 16 samples the result is a sixth too small in a Cornell box,
/// at 2 samples less than half, and more than twice too small with point-like highlights. The usual corrections, of x²
/// by s²/n or of 1/(x² + 0.01) by a Taylor series, do not help, because the noise is too large for them. (Both were
/// tried, as was the variance of one half of the samples over the mean of the other.)
///
/// So μ is estimated from the neighborhood: the median of the pixel and its four neighbors. A mean of neighbors is
/// much too bright next to a light, which hides errors there (8 to 13 % of the total at 16 samples). Medians or trimmed
/// means of all eight neighbors lose too much beside dark corners. Below 16 samples the pixel itself has no vote,
/// because that would cost 10 % of the error at 8 samples. From 16 samples on it has one, which is more accurate where
/// neighbors are unrelated. Two bounds limit the median.
///
/// First, it differs from the pixel's own mean by 5/√n standard errors at most. Weighted by s², a mean of n samples
/// deviates by γ/√n standard errors, where γ is the skewness of the samples, some 2 to 5 in global illumination; a
/// larger correction is not needed. So detail finer than a pixel is preserved, and with more samples each pixel relies
/// on itself.
///
/// Second, the denominator is at least a quarter of the pixel's own. A pixel with one bright sample may be dark with a
/// stray sample, or bright on the edge of a lamp. One sample cannot tell, and the error of a lamp over the square of
/// its dark surroundings would dominate the sum. With two samples this bound omits a quarter of the error of a Cornell
/// box, and with four a tenth. A looser bound would overestimate by more than that where no lamp is near.
pub(super) struct Denominators {
    /// One over the denominators.
    pub inverse: Rgb,
    /// One over the denominators from the pixel's own mean.
    pub own: Rgb,
}

impl Denominators {
    /// Computes denominators from a cross of pixel brightnesses, the center first, and the variance of its mean of
    /// `samples` samples.
    #[inline]
    pub fn new(cross: &[Rgb; 5], variance: Rgb, samples: f64) -> Self {
        let [mean, a, b, c, d] = *cross;
        let leeway = 5.0 / samples.sqrt();
        let off = variance.sqrt() * leeway;
        // The middle two of four, sorted: the larger of the two smaller, and the smaller of the two larger.
        let (low, high) = (a.at_most(b).at_least(c.at_most(d)), a.at_least(b).at_most(c.at_least(d)));
        let (low, high) = (low.at_most(high), low.at_least(high));
        let middle = if samples < 16.0 { (low + high) / 2.0 } else { mean.at_least(low).at_most(high) };
        let likely = middle.at_least(mean - off).at_most(mean + off);
        let by_itself = mean * mean + FLOOR;
        Self { inverse: (likely * likely + FLOOR).at_least(by_itself / 4.0).recip(), own: by_itself.recip() }
    }

    /// Denominators for the error from the pixel's brightest sample. `without` is the pixel's mean without it, and
    /// `around` the mean of its neighbors.
    ///
    /// A bright sample among few raises its pixel's mean and would thus divide its own error: light found by a single
    /// sample would have an error of 1/n instead of 1 or 100. So if the mean depends on one sample, its denominator
    /// comes from the other samples (leave one out). The sample is trusted as far as there is confirmation: by the
    /// neighbors, next to a lamp or in a caustic; or by the whole picture, if samples of this brightness are mostly
    /// seen again ([`Chance`]). Otherwise the denominator is that of the other samples alone, which is much too small
    /// for a lamp smaller than a pixel. So the largest error uses the neighbors alone, and the least error uses the
    /// upper bound from the whole picture. The contribution of a few even darker pixels is bounded in
    /// `heavy_tail_bound.rs`.
    #[inline]
    pub fn of_peak(&self, mean: Rgb, without: Rgb, around: Rgb, chance: &Chance, samples: f64) -> Peak {
        let (low, high) = (mean.at_most(without), mean.at_least(without));
        let squared = |likely: Rgb| {
            let likely = likely.at_least(low).at_most(high);
            (likely * likely + FLOOR).recip()
        };
        let confirmed = |chance: f64| squared(around.at_least(without + (mean - without) * chance));
        let others = without.at_least(around);
        let far = (others * others + FLOOR).recip() / hangs(samples);
        let or = |bold: Rgb, plain: Rgb| {
            let of = |channel: usize| {
                let is_alone = self.own[channel] < far[channel];
                if is_alone { bold[channel].max(plain[channel]) } else { plain[channel] }
            };
            Rgb::new(of(0), of(1), of(2))
        };
        let farther = (without * without + FLOOR).recip() / hangs(samples);
        Peak {
            likely: or(confirmed(chance.likely), self.inverse),
            least: or(confirmed(chance.most), self.own),
            most: or(squared(around), self.inverse.at_least(self.own)),
            hangs: (0..3).any(|channel| self.own[channel] < farther[channel]),
        }
    }
}

/// Ratio by which a mean's squared brightness plus floor must exceed that of the other samples and the neighbors for
/// the mean to depend on one of `samples` samples. Among few samples of any distribution, one is by far the largest.
fn hangs(samples: f64) -> f64 {
    (1.0 + 8.0 / samples).powi(2).max(2.0)
}

/// One over the denominators for a single sample's error: the likely one, and those of least and largest error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak {
    pub likely: Rgb,
    pub least: Rgb,
    pub most: Rgb,
    /// True if the mean depends on this one sample, whatever the neighbors show.
    pub hangs: bool,
}

/// Mean brightness of the up to eight neighbors at distance `apart` along both axes; black if there are none.
#[inline]
pub(super) fn around(means: &[Rgb], width: usize, x: usize, y: usize, apart: usize) -> Rgb {
    let height = means.len() / width;
    let (mut sum, mut count) = (Rgb::ZERO, 0.0);
    let near = |at: usize, size: usize| [at.checked_sub(apart), Some(at), Some(at + apart).filter(|&at| at < size)];
    for (i, y) in near(y, height).into_iter().enumerate() {
        for (j, x) in near(x, width).into_iter().enumerate() {
            if let (Some(x), Some(y)) = (x, y)
                && (i, j) != (1, 1)
            {
                sum += means[y * width + x];
                count += 1.0;
            }
        }
    }
    sum / f64::max(count, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pixel of 0.1 where one of 64 samples was 64, with neighbors of this brightness and these chances of similar
    /// samples.
    fn peak(around: f64, likely: f64, most: f64) -> [f64; 3] {
        let [mean, without, around] = [1.1, 0.1, around].map(Rgb::splat);
        let denominators = Denominators::new(&[mean, around, around, around, around], Rgb::ONE, 64.0);
        let peak = denominators.of_peak(mean, without, around, &Chance { likely, most }, 64.0);
        [peak.least, peak.likely, peak.most].map(|inverse| 1.0 / inverse[0])
    }

    fn close(found: [f64; 3], brightness: [f64; 3]) -> bool {
        found.iter().zip(brightness).all(|(found, b)| (found / (b * b + FLOOR) - 1.0).abs() < 1e-12)
    }

    #[test]
    fn a_bright_batch_is_believed_as_far_as_it_has_witnesses() {
        // No chance: it may be the first of many, or a stray sample.
        assert!(close(peak(0.1, 0.0, 1.0), [1.1, 0.1, 0.1]));
        // The picture predicts a chance of a quarter, and at most one half.
        assert!(close(peak(0.1, 0.25, 0.5), [0.6, 0.35, 0.1]));
        // Neighbors have the same brightness, or half of it.
        assert!(close(peak(1.1, 0.0, 0.0), [1.1, 1.1, 1.1]));
        assert!(close(peak(0.5, 0.0, 0.1), [0.5, 0.5, 0.5]));
    }

    #[test]
    fn neighbours_are_those_that_there_are() {
        let means: Vec<Rgb> = (0..12).map(|i| Rgb::splat(f64::from(1 << i))).collect();
        // Four columns and three rows.
        assert_eq!(around(&means, 4, 0, 0, 1), Rgb::splat(f64::from((1 << 1) + (1 << 4) + (1 << 5)) / 3.0));
        assert_eq!(around(&means, 4, 1, 1, 1)[0] * 8.0, f64::from(0b0111_0101_0111));
        assert_eq!(around(&means, 4, 1, 1, 2), Rgb::splat(f64::from(1 << 7)));
        assert_eq!(around(&means[..1], 1, 0, 0, 1), Rgb::ZERO);
    }
}
