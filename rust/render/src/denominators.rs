//! What errors are measured against: how bright each pixel is, as far as its samples and its neighbours tell.

use super::sightings::Chance;
use raywright_optics::Rgb;

/// What is added to the square of a brightness, so that the dark does not count infinitely.
pub(super) const FLOOR: f64 = 0.01;

/// The brightness of a pixel, and of the four beside it; at the border, its own instead.
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

/// What the squared errors of a pixel are divided by: an estimate of μ² + 0.01.
///
/// A pixel's own x will not do for μ: samples are skewed, so that the pixels which happen to have a large s² happen to
/// be bright as well, and dividing the one by the other hides a part of the error. At 16 samples this makes it a sixth
/// too small in a Cornell box, at 2 samples less than half, and more than twice too small with point-like highlights.
/// Nor is it repaired by the usual corrections, of x² by s²/n or of 1/(x² + 0.01) by a Taylor series: the noise is too
/// large for them (both were tried, as was the variance of one half of the samples over the mean of the other).
///
/// So μ is taken from the neighbourhood: the median of the pixel and the four beside it. A mean of neighbours is much
/// too bright next to a light, so that errors there are lost (8 to 13 % of all at 16 samples); medians or trimmed means
/// of all eight lose too much beside dark corners. Below 16 samples the pixel itself has no vote, which would cost 10 %
/// of the error at 8 samples. From there on it has one: where neighbours have nothing to do with each other, it is
/// worth more. Two bounds keep the median where it can be right.
///
/// It may contradict the pixel's own mean by 5/√n standard errors at most. Weighed by s², a mean of n samples is off by
/// γ/√n standard errors, where γ is the skewness of the samples, some 2 to 5 in global illumination: there is that much
/// to mend and no more. So detail finer than a pixel is not smoothed away, and with more samples each pixel speaks for
/// itself.
///
/// And the denominator is at least a quarter of the one that the pixel gives. A pixel that one sample made bright may
/// be a dark one with a stray sample or a bright one on the edge of a lamp; one sample cannot tell, and the error of a
/// lamp over the square of its dark surroundings would drown all others in the sum. Of two samples this leaves a
/// quarter of the error of a Cornell box out, and of four a tenth; with less of a bound, more than that would be made
/// up where no lamp is near.
pub(super) struct Denominators {
    /// One over them.
    pub inverse: Rgb,
    /// One over what the pixel's own mean would make them.
    pub own: Rgb,
}

impl Denominators {
    /// From the brightness of a cross of pixels, the first the one in the middle, and the variance of that one's mean,
    /// which is of so many samples.
    #[inline]
    pub fn new(cross: &[Rgb; 5], variance: Rgb, samples: f64) -> Self {
        let [mean, a, b, c, d] = *cross;
        let leeway = 5.0 / samples.sqrt();
        let off = variance.sqrt() * leeway;
        // The middle two of four: the larger of the two smaller, and the smaller of the two larger; then in order.
        let (low, high) = (a.at_most(b).at_least(c.at_most(d)), a.at_least(b).at_most(c.at_least(d)));
        let (low, high) = (low.at_most(high), low.at_least(high));
        let middle = if samples < 16.0 { (low + high) / 2.0 } else { mean.at_least(low).at_most(high) };
        let likely = middle.at_least(mean - off).at_most(mean + off);
        let by_itself = mean * mean + FLOOR;
        Self { inverse: (likely * likely + FLOOR).at_least(by_itself / 4.0).recip(), own: by_itself.recip() }
    }

    /// For what comes from the sample that stands out most in the pixel, whose mean is `without` if that one is left
    /// out. `around` is the mean of the pixels around.
    ///
    /// A bright sample that is one of few makes its pixel's mean larger as well, and would divide its own error: where
    /// light is found by one sample of a pixel, an error of 1 or 100 would pass for 1/n. So where the mean hangs on one
    /// sample, that is weighed by what the others say (leave one out). It is believed as far as it has witnesses: the
    /// pixels around, next to a lamp or in a caustic; or the whole picture, if what is as bright is mostly seen again
    /// ([`Chance`]). Without them its denominator is that of the others alone, which is much too small for a lamp that
    /// is smaller than a pixel. So errors are largest as the pixels around alone have it, and least by the most that
    /// the picture says; and if few pixels are even darker than that, `jumps.rs` tells what they add.
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

/// A mean hangs on one of so many samples if its square, and what is added, is larger by this factor than the samples
/// without that one make it, and the pixels around. Of a few samples of any kind one is by far the largest.
fn hangs(samples: f64) -> f64 {
    (1.0 + 8.0 / samples).powi(2).max(2.0)
}

/// One over what is to stand below what a single sample brings: the likely one, and those that make the error least and
/// largest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak {
    pub likely: Rgb,
    pub least: Rgb,
    pub most: Rgb,
    /// Whether the mean hangs on this one sample, whatever the pixels around say.
    pub hangs: bool,
}

/// The mean brightness of the up to eight pixels around one, `apart` from it along both axes; black if there are none.
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

    /// Of a pixel of 0.1 in which one of 64 samples was 64, as the pixels around are so bright, and what is as bright
    /// is seen again so often.
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
        // None: it may be the first of many, or a stray.
        assert!(close(peak(0.1, 0.0, 1.0), [1.1, 0.1, 0.1]));
        // The picture says that a quarter of it is to be expected, and a half at most.
        assert!(close(peak(0.1, 0.25, 0.5), [0.6, 0.35, 0.1]));
        // The pixels around are of the same brightness, or half as bright.
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
