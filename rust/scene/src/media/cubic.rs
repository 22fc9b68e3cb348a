//! Cubic polynomials of extinction along a ray, as in the cells of a grid.

use raywright_optics::Rgb;

/// Extinction along a segment as a cubic polynomial of the position, 0 to 1; coefficients with the constant first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic(pub [Rgb; 4]);

impl Cubic {
    /// The polynomial with these values at 0, 1/3, 2/3 and 1.
    pub fn through([a, b, c, d]: [Rgb; 4]) -> Self {
        let linear = (a * -11.0 + b * 18.0 - c * 9.0 + d * 2.0) * 0.5;
        let square = (a * 18.0 - b * 45.0 + c * 36.0 - d * 9.0) * 0.5;
        let cube = ((b - c) * 3.0 + d - a) * 4.5;
        Self([a, linear, square, cube])
    }

    /// Scales it per channel.
    #[inline]
    pub fn times(&self, by: Rgb) -> Self {
        let [a, b, c, d] = self.0;
        Self([by * a, by * b, by * c, by * d])
    }

    /// Mean over the segment.
    #[inline]
    pub fn mean(&self) -> Rgb {
        let [a, b, c, d] = self.0;
        a + b / 2.0 + c / 3.0 + d / 4.0
    }

    /// Integral from 0 to a position, for all channels.
    #[inline]
    pub fn up_to(&self, share: f64) -> Rgb {
        let [a, b, c, d] = self.0;
        (a + (b / 2.0 + (c / 3.0 + d * (share / 4.0)) * share) * share) * share
    }

    /// Position where the integral of a channel reaches a value below its total, by Newton's method within shrinking
    /// bounds.
    pub fn reach(&self, channel: usize, integral: f64) -> f64 {
        /// Iteration limit; after the 60th bisection the bounds coincide.
        const MOST: u32 = 100;
        let [a, b, c, d] = [self.0[0][channel], self.0[1][channel], self.0[2][channel], self.0[3][channel]];
        let value = |s: f64| a + (b + (c + d * s) * s) * s;
        let (mut low, mut high, mut share) = (0.0, 1.0, 0.5);
        for _ in 0..MOST {
            let off = (a + (b / 2.0 + (c / 3.0 + d * (share / 4.0)) * share) * share) * share - integral;
            if off < 0.0 {
                low = share;
            } else {
                high = share;
            }
            let newton = share - off / value(share);
            let next = if (low..=high).contains(&newton) { newton } else { 0.5 * (low + high) };
            let is_found = (next - share).abs() <= 1e-14;
            share = next;
            if is_found && value(share) > 0.0 {
                break;
            }
        }
        share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_the_cubic_of_its_values_and_integrates_it() {
        // 2 − 3 s + s² + 4 s³ in all three channels, times 1, 2 and 3.
        let value = |s: f64| Rgb::new(1.0, 2.0, 3.0) * (2.0 - 3.0 * s + s * s + 4.0 * s * s * s);
        let cubic = Cubic::through([0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(value));
        for (term, expected) in cubic.0.into_iter().zip([2.0, -3.0, 1.0, 4.0]) {
            assert!((term - Rgb::new(1.0, 2.0, 3.0) * expected).abs().max() < 1e-13, "{cubic:?}");
        }
        // 2 s − 3 s² / 2 + s³ / 3 + s⁴.
        let integral = |s: f64| 2.0 * s - 1.5 * s * s + s.powi(3) / 3.0 + s.powi(4);
        assert!((cubic.mean() - cubic.up_to(1.0)).abs().max() < 1e-14);
        for i in 0..20 {
            let share = f64::from(i) / 20.0;
            assert!((cubic.up_to(share)[1] - 2.0 * integral(share)).abs() < 1e-13);
            assert!((cubic.reach(2, 3.0 * integral(share)) - share).abs() < 1e-12, "{share}");
        }
    }

    #[test]
    fn what_begins_with_nothing_is_reached() {
        // s³ has slope 0 at its start; its integral is s⁴ / 4.
        let cubic = Cubic([Rgb::ZERO, Rgb::ZERO, Rgb::ZERO, Rgb::ONE]);
        for share in [1e-3, 0.1, 0.5, 0.999] {
            assert!((cubic.reach(0, f64::powi(share, 4) / 4.0) / share - 1.0).abs() < 1e-10, "{share}");
        }
    }
}
