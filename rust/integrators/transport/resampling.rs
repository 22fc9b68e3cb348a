//! One of several draws, to stand for their sum.

use crate::optics::Rgb;

/// Of all draws and what each brings, one, chosen with a probability that goes by what it brings, over that
/// probability: the mean is that of the sum, and only the one must still be seen to arrive (Talbot, Cline and Egbert,
/// "Importance Resampling for Global Illumination", 2005). One that brings nothing is never chosen; `None` if none
/// brings anything. `choice` is uniform in [0, 1).
///
/// Each draw in turn takes the place of the one kept before (Chao, "A General Purpose Unequal Probability Sampling
/// Plan", 1982), and what is left of the number once it has decided is uniform again. What is not finite is kept, so
/// that it is not hidden.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resampled<T> {
    choice: f64,
    sum: f64,
    /// The draw, what it brings, and how much that is.
    kept: Option<(T, Rgb, f64)>,
}

impl<T> Resampled<T> {
    /// Of no draws yet.
    #[inline]
    pub fn new(choice: f64) -> Self {
        Self { choice, sum: 0.0, kept: None }
    }

    /// Of one draw more.
    #[inline]
    pub fn add(&mut self, draw: T, brings: Rgb) {
        if brings.is_black() {
            return;
        }
        let strength = brings.sum();
        self.sum += strength;
        let probability = strength / self.sum;
        if self.choice >= probability {
            self.choice = (self.choice - probability) / (1.0 - probability);
        } else {
            self.choice /= probability;
            self.kept = Some((draw, brings, strength));
        }
        // A quotient may be rounded up to 1.
        self.choice = self.choice.min(1f64.next_down());
    }

    /// The one that is kept.
    #[inline]
    pub fn kept(self) -> Option<(T, Rgb)> {
        self.kept.map(|(draw, brings, strength)| (draw, brings * (self.sum / strength)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resampled<T>(choice: f64, draws: impl Iterator<Item = (T, Rgb)>) -> Option<(T, Rgb)> {
        let mut all = Resampled::new(choice);
        draws.for_each(|(draw, brings)| all.add(draw, brings));
        all.kept()
    }

    /// By the middles of so many equal steps.
    fn mean(brings: &[f64], seen: &[bool]) -> f64 {
        const STEPS: u32 = 10_000;
        let draws = || brings.iter().enumerate().map(|(i, &x)| (i, Rgb::new(0.5 * x, x, 0.0)));
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
        let all = |u: f64| resampled(u, brings.iter().map(|&x| ((), Rgb::splat(x)))).unwrap().1[1];
        for choice in [0.0, 0.1, 0.5, 0.999, 1f64.next_down()] {
            assert!((all(choice) - 3.001).abs() < 1e-15 * 4.0);
        }
    }

    #[test]
    fn nothing_is_brought_by_none() {
        assert!(resampled(0.5, [((), Rgb::ZERO), ((), Rgb::ZERO)].into_iter()).is_none());
        assert!(resampled(0.5, std::iter::empty::<((), Rgb)>()).is_none());
        let tiny = resampled(0.7, [((), Rgb::splat(1e-310)), ((), Rgb::ZERO)].into_iter()).unwrap();
        assert_eq!(tiny.1, Rgb::splat(1e-310));
    }

    #[test]
    fn what_is_not_finite_is_not_hidden() {
        for odd in [f64::NAN, f64::INFINITY] {
            for order in [[1.0, odd, 2.0], [odd, 1.0, 2.0], [1.0, 2.0, odd]] {
                for choice in [0.0, 0.3, 0.9] {
                    let (_, brings) = resampled(choice, order.iter().map(|&x| ((), Rgb::splat(x)))).unwrap();
                    assert!(!brings.is_finite(), "{order:?} {choice} {brings}");
                }
            }
        }
    }
}
