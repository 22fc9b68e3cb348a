//! Into which directions a medium scatters.

use crate::math::{DVec3, Frame};
use std::f64::consts::{FRAC_1_PI, TAU};

/// The phase function of Henyey and Greenstein ("Diffuse Radiation in the Galaxy", 1941): by one number, the mean
/// cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    g: f64,
}

impl HenyeyGreenstein {
    /// Of a mean cosine between −1 (all light goes back) and 1 (all goes on), both excluded: `None` for another.
    pub fn new(g: f64) -> Option<Self> {
        (g.abs() < 1.0).then_some(Self { g })
    }

    /// The mean cosine.
    pub fn g(&self) -> f64 {
        self.g
    }

    /// The density in solid angle of going on along `next` after `before`, both unit.
    #[inline]
    pub fn pdf(&self, before: DVec3, next: DVec3) -> f64 {
        let g = self.g;
        // 1 + g² − 2g cos θ, where it is small, from numbers that are: 1 − cos θ is half the square of the chord.
        let chord = (next - before).length_squared();
        let square = (1.0 - g) * (1.0 - g) + g * chord;
        0.25 * FRAC_1_PI * (1.0 - g) * (1.0 + g) / (square * square.sqrt())
    }

    /// Draws a direction to go on along, with the density of [`HenyeyGreenstein::pdf`].
    ///
    /// The inverse of the distribution is taken for 1 − cos θ, in which nothing cancels, and g = 0 is no exception: 1 −
    /// cos θ = 2 (1 − u)(1 + gu) ((1 − g) / (1 − g + 2gu))².
    #[inline]
    pub fn sample(&self, before: DVec3, u: [f64; 2]) -> DVec3 {
        let g = self.g;
        let part = (1.0 - g) / (1.0 - g + 2.0 * g * u[0]);
        let less = (2.0 * (1.0 - u[0]) * (1.0 + g * u[0]) * part * part).clamp(0.0, 2.0);
        let sine = (less * (2.0 - less)).sqrt();
        let (sin, cos) = (TAU * u[1]).sin_cos();
        let frame = Frame::new(before);
        // From where it came: so that a hair's breadth of turning is not lost in a sum with 1.
        before + frame.tangent * (sine * cos) + frame.bitangent * (sine * sin) - before * less
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;
    use crate::sampling::chi_square::assert_frequencies;

    const BEFORE: DVec3 = DVec3::new(0.48, -0.6, 0.64);

    /// The share of light that turns by a cosine of at most `c`, in closed form.
    fn share(g: f64, c: f64) -> f64 {
        if g.abs() < 1e-12 {
            return 0.5 * (1.0 + c);
        }
        let root = |c: f64| ((1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - c)).sqrt();
        (1.0 - g) * (1.0 + g) / (2.0 * g) * (1.0 / root(c) - 1.0 / (1.0 + g))
    }

    #[test]
    fn draws_have_the_distribution_and_the_mean_cosine() {
        for g in [-0.999, -0.5, 0.0, 1e-9, 0.7, 0.999] {
            let phase = HenyeyGreenstein::new(g).unwrap();
            let mut counts = vec![0; 20];
            let count = 50_000;
            let mut sum = 0.0;
            for number in 0..count {
                let next = phase.sample(BEFORE, Sampler::new(21, 0, number).two(0));
                assert!((next.length() - 1.0).abs() < 1e-12);
                let cosine = next.dot(BEFORE);
                sum += cosine;
                counts[((share(g, cosine) * 20.0) as usize).min(19)] += 1;
            }
            assert_frequencies(&counts, &[0.05; 20]);
            // A cosine's variance is at most 1: five standard errors, once in two million.
            assert!((sum / f64::from(count) - g).abs() < 5.0 / f64::from(count).sqrt());
        }
    }

    #[test]
    fn density_is_the_distributions_slope() {
        for g in [-0.999, -0.3, 0.0, 0.6, 0.999] {
            let phase = HenyeyGreenstein::new(g).unwrap();
            for step in 1..40 {
                // Finer near where the density is sharpest.
                let near = f64::from(step) / 40.0;
                let c: f64 = 1f64.copysign(g) * (1.0 - 2.0 * near.powi(4));
                let h = 1e-3 * near.powi(4);
                if c.abs() > 1.0 - h {
                    continue;
                }
                let slope = (share(g, c + h) - share(g, c - h)) / (2.0 * h);
                let frame = Frame::new(BEFORE);
                let next = BEFORE * c + frame.tangent * (1.0 - c * c).sqrt();
                let density = phase.pdf(BEFORE, next) * TAU;
                assert!((density / slope - 1.0).abs() < 1e-4, "g {g}, cosine {c}: {density} not {slope}");
            }
        }
    }

    #[test]
    fn refuses_what_is_no_mean_cosine() {
        for bad in [-1.0, 1.0, 2.0, f64::NAN] {
            assert_eq!(HenyeyGreenstein::new(bad), None);
        }
    }
}
