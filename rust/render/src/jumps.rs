//! How much more than is told a few pixels may err, of many that cannot tell.

use super::denominators::FLOOR;
use raywright_optics::Rgb;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Errors that one pixel may hide, by how large they are: how many pixels are to be expected that do.
///
/// On the rim of a lamp a pixel is in part as bright as the next ones, and in which part its samples say. If one of n
/// met the lamp, the part is 1/n, or a tenth of that: rarely, as rarely as a sample meets so little, but the error over
/// the square of what the pixel is would be a hundred times what it seems to be. A picture has many such pixels, and
/// one that is of the rare kind makes as much error as all others do. Variances say nothing of sums like that. What
/// does is that they are large by their largest term: the sum is above x as often as one of its terms is (Embrechts,
/// Klüppelberg and Mikosch, "Modelling Extremal Events", 1997, section 1.3).
///
/// Rims lie anywhere in pixels, so parts are uniform before there is a sample, and proportional to themselves after one
/// of n met them: below t/n, for t < 1, with probability t²/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jumps([f64; BINS]);

/// Half octaves of errors that are told apart, the least of them 2⁻²⁴; what is smaller is not looked at.
const BINS: usize = 128;
const LEAST: i32 = -24;

/// Parts that are told apart, two an octave. The last is so small that hundreds of pixels have none below it.
const PARTS: i32 = 14;

/// The fourth root of a half.
const MIDDLE: f64 = 0.840_896_415_253_714_5;

impl Default for Jumps {
    fn default() -> Self {
        Self([0.0; BINS])
    }
}

impl Jumps {
    /// Counts in what a sample brings: the `variance` of its pixel's mean that comes from it, that `mean`, the mean
    /// `without` the sample, and the `told` error.
    #[inline]
    pub fn add(&mut self, variance: Rgb, mean: Rgb, without: Rgb, told: f64) {
        let mut part = 1.0;
        for step in 0..=PARTS {
            // In the middle of the parts between this and the next; below the last, none.
            let (next, middle) = if step == PARTS { (0.0, 0.0) } else { (part * FRAC_1_SQRT_2, part * MIDDLE) };
            let likely = without + (mean - without) * middle;
            let more = variance.dot((likely * likely + FLOOR).recip()) * (1.0 - middle).powi(2) - told;
            if let Some(bin) = bin(more) {
                self.0[bin] += (part * part - next * next) / 2.0;
            }
            part = next;
        }
    }

    /// Counts in all that another has counted.
    pub fn join(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(expected, more)| *expected += more);
    }

    /// What pixels err more than they tell with this probability.
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

/// Where an error belongs; read from the bits, so that it is the same everywhere.
#[inline]
fn bin(error: f64) -> Option<usize> {
    let exponent = (error.max(0.0).to_bits() >> 52) as i32 - 1023;
    let upper = error * f64::exp2(f64::from(-exponent)) >= SQRT_2;
    (exponent >= LEAST).then(|| (2 * (exponent - LEAST) as usize + usize::from(upper)).min(BINS - 1))
}

/// The errors of a bin, which they are off by a fifth at most.
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

    /// What a pixel errs by of which this part is a lamp of 1000 on 0.1, and one of 16 samples met that.
    fn error(part: f64) -> f64 {
        let (off, truth) = (1000.0 * (1.0 / 16.0 - part), 0.1 + 1000.0 * part);
        off * off / (truth * truth + FLOOR)
    }

    #[test]
    fn rims_that_were_met_once_err_by_as_much_as_often() {
        // Of pixels with any part of the lamp: the error that one in so many of those exceeds that met it once.
        let mut errors = Vec::new();
        for pixel in 0..400_000u32 {
            let part = Sampler::new(5, pixel, 0).one(0);
            if (1..=16).filter(|&n| Sampler::new(5, pixel, n).one(1) < part).count() == 1 {
                errors.push(error(part));
            }
        }
        errors.sort_by(|a, b| b.total_cmp(a));
        let [mean, without] = [1000.0 / 16.0 + 0.1, 0.1].map(Rgb::splat);
        for (pixels, probability) in [(1, 0.025), (1, 0.005), (4, 0.025), (20, 0.025)] {
            let mut jumps = Jumps::default();
            let red = Rgb::new(62.5f64.powi(2), 0.0, 0.0);
            (0..pixels).for_each(|_| jumps.add(red, mean, without, 0.0));
            let exceeded = errors[(errors.len() as f64 * probability / f64::from(pixels)) as usize];
            // Parts are told apart by half octaves, and their errors go by the squares; samples take the part of 1/17.
            let ratio = jumps.with(probability) / exceeded;
            assert!((0.5..2.0).contains(&ratio), "{pixels} pixels, {probability}: {ratio}");
        }
    }

    #[test]
    fn what_is_told_already_is_no_jump() {
        let [mean, without] = [2.0, 1.0].map(Rgb::splat);
        let mut jumps = Jumps::default();
        // Three channels of variance 1 that are at least 1 bright.
        jumps.add(Rgb::ONE, mean, without, 3.0);
        assert_eq!(jumps, Jumps::default());
        assert_eq!(jumps.with(0.025), 0.0);
        jumps.add(Rgb::ONE, mean, without, 1.0);
        assert!(jumps.with(0.025) > 0.0 && jumps.with(0.025) < 2.4 && jumps.with(0.6) == 0.0);
    }
}
