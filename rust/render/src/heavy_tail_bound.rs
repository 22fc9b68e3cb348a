//! Bound on the error of a few pixels that cannot reveal it themselves (heavy tails).

use super::denominators::FLOOR;
use raywright_optics::Rgb;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Expected numbers of pixels that may hide an error, by the size of the error.
///
/// A pixel on the rim of a lamp is partly as bright as the lamp, and its samples estimate the covered share. If one of
/// n samples hit the lamp, the share is likely about 1/n, but it may be a tenth of that. This is as rare as hitting
/// such a small share, but then the error over the squared true brightness is a hundred times what it seems. A picture
/// has many such pixels, and one of the rare kind contributes as much error as all others together. Variances do not
/// describe such sums. They are large because of their largest term: the sum exceeds x as often as one of its terms
/// does (Embrechts, Klüppelberg and Mikosch, "Modeling Extremal Events", 1997, section 1.3).
///
/// Rims have arbitrary positions within pixels, so covered shares are uniform a priori. After one of n samples hit,
/// their density is proportional to the share: a share below t/n, for t < 1, has probability t²/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jumps([f64; BINS]);

/// Number of half-octave bins of errors, and the exponent of the smallest, 2⁻²⁴; smaller errors are ignored.
const BINS: usize = 128;
const LEAST: i32 = -24;

/// Number of bins of covered shares, two per octave. The last is so small that hundreds of pixels have none below it.
const PARTS: i32 = 14;

/// The fourth root of a half.
const MIDDLE: f64 = 0.840_896_415_253_714_5;

impl Default for Jumps {
    fn default() -> Self {
        Self([0.0; BINS])
    }
}

impl Jumps {
    /// Adds the contribution of a sample: the `variance` of its pixel's mean due to it, that `mean`, the mean `without`
    /// it, and the error already reported, `told`.
    #[inline]
    pub fn add(&mut self, variance: Rgb, mean: Rgb, without: Rgb, told: f64) {
        let mut part = 1.0;
        for step in 0..=PARTS {
            // The center of the bin between this share and the next; 0 below the last.
            let (next, middle) = if step == PARTS { (0.0, 0.0) } else { (part * FRAC_1_SQRT_2, part * MIDDLE) };
            let likely = without + (mean - without) * middle;
            let more = variance.dot((likely * likely + FLOOR).recip()) * (1.0 - middle).powi(2) - told;
            if let Some(bin) = bin(more) {
                self.0[bin] += (part * part - next * next) / 2.0;
            }
            part = next;
        }
    }

    /// Adds the counts of another.
    pub fn join(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(expected, more)| *expected += more);
    }

    /// Error beyond the reported one that is exceeded with this probability.
    pub fn with(&self, probability: f64) -> f64 {
        let mut expected = 0.0;
        for (bin, count) in self.0.iter().enumerate().rev() {
            expected += count;
            if expected >= probability {
                return middle(bin);
            }
        }
        0.0
    }
}

/// Bin of an error; computed from its bits, so that it is the same on every machine.
#[inline]
fn bin(error: f64) -> Option<usize> {
    let exponent = (error.max(0.0).to_bits() >> 52) as i32 - 1023;
    let upper = error * f64::exp2(f64::from(-exponent)) >= SQRT_2;
    (exponent >= LEAST).then(|| (2 * (exponent - LEAST) as usize + usize::from(upper)).min(BINS - 1))
}

/// Representative error of a bin, accurate to a fifth.
fn middle(bin: usize) -> f64 {
    const QUARTER: f64 = MIDDLE * SQRT_2;
    f64::exp2(f64::from(bin as i32 / 2 + LEAST)) * if bin.is_multiple_of(2) { QUARTER } else { QUARTER * SQRT_2 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::sampling::Sampler;

    proptest! {
        #[test]
        fn errors_are_known_to_a_fifth(error in 1e-7..1e9f64) {
            prop_assert!((middle(bin(error).unwrap()) / error).ln().abs() <= 0.1733);
            prop_assert!(bin(1e-8).is_none() && bin(0.0).is_none() && bin(-1.0).is_none());
            prop_assert_eq!(bin(f64::MAX), Some(BINS - 1));
        }
    }

    /// Error of a pixel with this share of a lamp of 1000 on 0.1, if one of 16 samples hit the lamp.
    fn error(part: f64) -> f64 {
        let (off, truth) = (1000.0 * (1.0 / 16.0 - part), 0.1 + 1000.0 * part);
        off * off / (truth * truth + FLOOR)
    }

    #[test]
    fn rims_that_were_met_once_err_by_as_much_as_often() {
        // Pixels with random shares of the lamp: the error exceeded by this fraction of the pixels with exactly one
        // hit.
        let mut errors = Vec::new();
        for pixel in 0..400_000u32 {
            let part = Sampler::new(5, pixel, 0).one(0);
            if (1..=16).filter(|&n| Sampler::new(5, pixel, n).one(1) < part).count() == 1 {
                errors.push(error(part));
            }
        }
        errors.sort_unstable_by(|a, b| b.total_cmp(a));
        let [mean, without] = [1000.0 / 16.0 + 0.1, 0.1].map(Rgb::splat);
        for (pixels, probability) in [(1, 0.025), (1, 0.005), (4, 0.025), (20, 0.025)] {
            let mut jumps = Jumps::default();
            let red = Rgb::new(62.5f64.powi(2), 0.0, 0.0);
            (0..pixels).for_each(|_| jumps.add(red, mean, without, 0.0));
            let exceeded = errors[(errors.len() as f64 * probability / f64::from(pixels)) as usize];
            // Shares are binned by half octaves, and errors vary with their squares; one of 16 hits suggests a share of
            // 1/17.
            let ratio = jumps.with(probability) / exceeded;
            assert!((0.5..2.0).contains(&ratio), "{pixels} pixels, {probability}: {ratio}");
        }
    }

    #[test]
    fn what_is_told_already_is_no_jump() {
        let [mean, without] = [2.0, 1.0].map(Rgb::splat);
        let mut jumps = Jumps::default();
        // Three channels of variance 1 and brightness of at least 1.
        jumps.add(Rgb::ONE, mean, without, 3.0);
        assert_eq!(jumps, Jumps::default());
        assert_eq!(jumps.with(0.025), 0.0);
        jumps.add(Rgb::ONE, mean, without, 1.0);
        assert!(jumps.with(0.025) > 0.0 && jumps.with(0.025) < 2.4 && jumps.with(0.6) == 0.0);
    }
}
