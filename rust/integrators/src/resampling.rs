//! One of several draws, to stand for their sum.

use raywright_base::math::LANES;
use raywright_base::simd::{Level, loops};
use raywright_optics::{Rgb, RgbLanes};

/// Of all draws and what each brings, one, chosen with a probability that goes by what it brings, over that
/// probability: the mean is that of the sum, and only the one must still be seen to arrive (Talbot, Cline and Egbert,
/// "Importance Resampling for Global Illumination", 2005). One that brings nothing is never chosen; `None` if none
/// brings anything. `choice` is uniform in [0, 1).
///
/// Each draw in turn takes the place of the one kept before (Chao, "A General Purpose Unequal Probability Sampling
/// Plan", 1982), and what is left of the number once it has decided is uniform again. A draw that is not finite is
/// kept, so that it is not hidden.
#[derive(Clone, Copy, Debug)]
struct Resampled {
    choice: f64,
    sum: f64,
    /// The number of the draw, what it brings, and how much that is.
    kept: u64,
    brings: Rgb,
    strength: f64,
}

impl Resampled {
    /// In place of a draw's number where there is none.
    const NONE: u64 = u64::MAX;

    /// Of one draw more. Lanes have no branches: all is computed, and the result is selected.
    #[inline(always)]
    fn add(self, draw: u64, brings: Rgb) -> Self {
        let counts = !brings.is_black();
        let strength = brings.sum();
        let sum = self.sum + strength;
        let probability = strength / sum;
        let stays = self.choice >= probability;
        let left = if stays { (self.choice - probability) / (1.0 - probability) } else { self.choice / probability };
        let takes = counts & !stays;
        Self {
            // A quotient may be rounded up to 1.
            choice: if counts { left.min(1f64.next_down()) } else { self.choice },
            sum: if counts { sum } else { self.sum },
            kept: if takes { draw } else { self.kept },
            brings: Rgb::select(takes, brings, self.brings),
            strength: if takes { strength } else { self.strength },
        }
    }
}

/// The same for a lane each.
#[derive(Clone, Debug)]
pub(crate) struct ResampledLanes {
    choice: [f64; LANES],
    sum: [f64; LANES],
    kept: [u64; LANES],
    brings: RgbLanes,
    strength: [f64; LANES],
}

loops! {
    /// Of one draw more, the same for all lanes.
    fn resample(before: &ResampledLanes, draw: u64, brings: &RgbLanes, all: &mut ResampledLanes) {
        for i in 0..LANES {
            all.set(i, before.get(i).add(draw, brings.get(i)));
        }
    }
}

impl ResampledLanes {
    /// Of no draws yet.
    pub fn new(choice: [f64; LANES]) -> Self {
        let (zero, brings) = ([0.0; LANES], RgbLanes::ZERO);
        Self { choice, sum: zero, kept: [Resampled::NONE; LANES], brings, strength: zero }
    }

    /// Adds one draw more, the same for all lanes.
    #[inline]
    pub fn add(&mut self, level: Level, draw: u64, brings: &RgbLanes) {
        // Not in place, where a selection becomes a masked store, which is slow on processors of AMD.
        let before = self.clone();
        resample(level, &before, draw, brings, self);
    }

    #[inline(always)]
    fn get(&self, i: usize) -> Resampled {
        let (choice, sum, kept) = (self.choice[i], self.sum[i], self.kept[i]);
        Resampled { choice, sum, kept, brings: self.brings.get(i), strength: self.strength[i] }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, one: Resampled) {
        (self.choice[i], self.sum[i], self.kept[i]) = (one.choice, one.sum, one.kept);
        self.brings.set(i, one.brings);
        self.strength[i] = one.strength;
    }

    /// Return the draw that is kept in a lane, and its light as that of all.
    #[inline]
    pub fn kept(&self, lane: usize) -> Option<(usize, Rgb)> {
        let one = self.get(lane);
        (one.kept != Resampled::NONE).then(|| (one.kept as usize, one.brings * (one.sum / one.strength)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In the last lane, of which the others know nothing.
    fn resampled(choice: f64, draws: impl Iterator<Item = Rgb>) -> Option<(usize, Rgb)> {
        let mut all = ResampledLanes::new(std::array::from_fn(|lane| if lane == LANES - 1 { choice } else { 0.0 }));
        for (draw, brings) in draws.enumerate() {
            let mut lanes = RgbLanes::ZERO;
            lanes.set(LANES - 1, brings);
            all.add(Level::Scalar, draw as u64, &lanes);
        }
        assert!((0..LANES - 1).all(|lane| all.kept(lane).is_none()));
        all.kept(LANES - 1)
    }

    /// By the middles of so many equal steps.
    fn mean(brings: &[f64], seen: &[bool]) -> f64 {
        const STEPS: u32 = 10_000;
        let draws = || brings.iter().map(|&x| Rgb::new(0.5 * x, x, 0.0));
        let one = |step: u32| resampled((f64::from(step) + 0.5) / f64::from(STEPS), draws());
        (0..STEPS).filter_map(one).map(|(i, x)| if seen[i] { x[1] } else { 0.0 }).sum::<f64>() / f64::from(STEPS)
    }

    #[test]
    fn the_mean_is_that_of_the_sum_of_what_is_seen() {
        let brings = [0.3, 0.0, 2.0, 1e-3, 0.7];
        for bits in 0..32 {
            let seen: [bool; 5] = std::array::from_fn(|i| bits >> i & 1 == 1);
            let expected: f64 = brings.iter().zip(seen).map(|(x, seen)| if seen { *x } else { 0.0 }).sum();
            // Four draws share out the choices in eight ranges, at each end of which a step may go to the wrong one.
            assert!((mean(&brings, &seen) - expected).abs() <= 8.0 * 3.001 / 1e4, "{bits:b}");
        }
        // Unshadowed, it is the sum whatever the choice.
        let all = |u: f64| resampled(u, brings.iter().map(|&x| Rgb::splat(x))).unwrap().1[1];
        for choice in [0.0, 0.1, 0.5, 0.999, 1f64.next_down()] {
            assert!((all(choice) - 3.001).abs() < 1e-15 * 4.0);
        }
    }

    #[test]
    fn nothing_is_brought_by_none() {
        assert!(resampled(0.5, [Rgb::ZERO; 2].into_iter()).is_none());
        assert!(resampled(0.5, std::iter::empty()).is_none());
        let tiny = resampled(0.7, [Rgb::splat(1e-310), Rgb::ZERO].into_iter()).unwrap();
        assert_eq!(tiny.1, Rgb::splat(1e-310));
    }

    #[test]
    fn what_is_not_finite_is_not_hidden() {
        for odd in [f64::NAN, f64::INFINITY] {
            for order in [[1.0, odd, 2.0], [odd, 1.0, 2.0], [1.0, 2.0, odd]] {
                for choice in [0.0, 0.3, 0.9] {
                    let (_, brings) = resampled(choice, order.iter().map(|&x| Rgb::splat(x))).unwrap();
                    assert!(!brings.is_finite(), "{order:?} {choice} {brings}");
                }
            }
        }
    }
}
