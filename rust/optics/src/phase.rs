//! Into which directions a medium scatters.

use raywright_base::math::{DVec3, Frame};
use raywright_base::sampling::warp;
use std::f64::consts::{FRAC_1_PI, TAU};

/// How a medium scatters, by the angle that light turns by. Directions are unit and go with the path: `before` as it
/// comes, `next` as it goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Phase {
    /// The same into every direction.
    #[default]
    Isotropic,
    /// By a mean cosine.
    HenyeyGreenstein(HenyeyGreenstein),
    /// As what is much smaller than a wavelength does.
    Rayleigh,
}

impl Phase {
    /// The density in solid angle of going on along `next`, which is all of the light that does.
    #[inline]
    pub fn pdf(&self, before: DVec3, next: DVec3) -> f64 {
        match self {
            Self::Isotropic => 0.25 * FRAC_1_PI,
            Self::HenyeyGreenstein(by) => by.pdf(before, next),
            Self::Rayleigh => {
                let cosine = before.dot(next);
                0.1875 * FRAC_1_PI * (1.0 + cosine * cosine)
            }
        }
    }

    /// Its greatest density: of going straight on, or back.
    pub fn greatest(&self) -> f64 {
        match self {
            Self::Isotropic => 0.25 * FRAC_1_PI,
            Self::HenyeyGreenstein(by) => {
                let g = by.g.abs();
                0.25 * FRAC_1_PI * (1.0 + g) / ((1.0 - g) * (1.0 - g))
            }
            Self::Rayleigh => 0.375 * FRAC_1_PI,
        }
    }

    /// Its terms.
    pub fn terms(&self) -> PhaseTerms {
        let even = PhaseTerms { scale: 0.25 * FRAC_1_PI, sign: 1.0, least: 1.0, chord: 0.0, square: 0.0 };
        match self {
            Self::Isotropic => even,
            Self::HenyeyGreenstein(HenyeyGreenstein { g }) => {
                let least = (1.0 - g.abs()) * (1.0 - g.abs());
                let scale = even.scale * (1.0 - g.abs()) * (1.0 + g.abs());
                PhaseTerms { scale, sign: 1f64.copysign(*g), least, chord: g.abs(), square: 0.0 }
            }
            Self::Rayleigh => PhaseTerms { scale: 0.1875 * FRAC_1_PI, square: 1.0, ..even },
        }
    }

    /// Draws a direction to go on along, with the density of [`Phase::pdf`].
    #[inline]
    pub fn sample(&self, before: DVec3, u: [f64; 2]) -> DVec3 {
        match self {
            Self::Isotropic => warp::uniform_sphere(u),
            Self::HenyeyGreenstein(by) => by.sample(before, u),
            Self::Rayleigh => {
                // The distribution (μ³ + 3μ + 4) / 8 is inverted by Cardano's formula, from whose two roots nothing
                // cancels where the greater comes first (Frisvad, "Importance Sampling the Rayleigh Phase Function",
                // 2011).
                let a = 4.0 * u[0] - 2.0;
                let root = (a.abs() + (a * a + 1.0).sqrt()).cbrt();
                let cosine = (root - 1.0 / root).copysign(a).clamp(-1.0, 1.0);
                turned(before, 1.0 - cosine, u[1])
            }
        }
    }
}

/// What is in the densities of any phase function, for loops that are one for all.
#[derive(Clone, Copy, Debug)]
pub struct PhaseTerms {
    scale: f64,
    sign: f64,
    least: f64,
    chord: f64,
    square: f64,
}

impl PhaseTerms {
    /// The density of going on along `next` after `before`, as [`Phase::pdf`] has it, but for rounding.
    #[inline(always)]
    pub fn pdf(&self, before: [f64; 3], next: [f64; 3]) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| next[axis] - before[axis] * self.sign);
        let cosine = before[0] * next[0] + before[1] * next[1] + before[2] * next[2];
        let square = self.least + self.chord * (x * x + y * y + z * z);
        self.scale * (1.0 + self.square * cosine * cosine) / (square * square.sqrt())
    }
}

/// A unit direction turned by an angle, of which 1 − cos θ is given: so that a hair's breadth of turning is not lost in
/// a sum with 1.
#[inline]
fn turned(before: DVec3, less: f64, u: f64) -> DVec3 {
    let sine = (less * (2.0 - less)).max(0.0).sqrt();
    let (sin, cos) = (TAU * u).sin_cos();
    let frame = Frame::new(before);
    before + frame.tangent * (sine * cos) + frame.bitangent * (sine * sin) - before * less
}

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
    ///
    /// 1 + g² − 2g cos θ is (1 − |g|)² + |g| times the square of the chord between `next` and where most light goes to,
    /// two numbers that are not negative.
    #[inline]
    pub fn pdf(&self, before: DVec3, next: DVec3) -> f64 {
        let g = self.g.abs();
        let chord = (next - before * 1f64.copysign(self.g)).length_squared();
        let square = (1.0 - g) * (1.0 - g) + g * chord;
        0.25 * FRAC_1_PI * (1.0 - g) * (1.0 + g) / (square * square.sqrt())
    }

    /// Draws a direction to go on along, with the density of [`HenyeyGreenstein::pdf`].
    ///
    /// The inverse of the distribution is taken for 1 − cos θ, θ from where most light goes to, in which nothing
    /// cancels, and g = 0 is no exception: 1 − cos θ = 2 (1 − u)(1 + gu) ((1 − g) / (1 − g + 2gu))².
    #[inline]
    pub fn sample(&self, before: DVec3, u: [f64; 2]) -> DVec3 {
        let g = self.g.abs();
        let part = (1.0 - g) / (1.0 - g + 2.0 * g * u[0]);
        let less = (2.0 * (1.0 - u[0]) * (1.0 + g * u[0]) * part * part).clamp(0.0, 2.0);
        turned(before * 1f64.copysign(self.g), less, u[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::Sampler;
    use raywright_base::sampling::chi_square::assert_frequencies;

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
        for g in [-0.9999, -0.5, 0.0, 1e-9, 0.7, 0.9999] {
            let phase = HenyeyGreenstein::new(g).unwrap();
            let straight = phase.pdf(BEFORE, BEFORE * 1f64.copysign(g));
            assert!((straight / Phase::HenyeyGreenstein(phase).greatest() - 1.0).abs() < 1e-9);
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
    fn values_are_those_of_the_formula() {
        // (1 − g²) / (4π (1 + g² − 2gμ)^1.5) at the cosines 1, 0 and −1.
        for (g, expected) in [
            (0.5, [0.477464829275686, 0.04270575260503062, 0.01768388256576615]),
            (0.9, [15.119719593730064, 0.006209060257965819, 0.0022043620926855303]),
            (-0.5, [0.01768388256576615, 0.04270575260503062, 0.477464829275686]),
            (0.999, [159075.3656203491, 5.632606061664662e-5, 1.991427718510274e-5]),
        ] {
            let phase = Phase::HenyeyGreenstein(HenyeyGreenstein::new(g).unwrap());
            for (next, value) in [DVec3::X, DVec3::Y, DVec3::NEG_X].into_iter().zip(expected) {
                assert!((phase.pdf(DVec3::X, next) / value - 1.0).abs() < 1e-12, "{g}");
            }
        }
        for (next, value) in [(DVec3::X, 0.1193662073189215), (DVec3::Z, 0.05968310365946075)] {
            assert!((Phase::Rayleigh.pdf(DVec3::X, next) / value - 1.0).abs() < 1e-14);
        }
        // Nearly all light in a needle: the density along it is (1 + g) / (4π (1 − g)²), and as sharp to either side.
        for g in [0.9999, -0.9999] {
            let needle = HenyeyGreenstein::new(g).unwrap();
            let ahead = BEFORE * 1f64.copysign(g);
            let peak = 1.9999 / (4.0 * std::f64::consts::PI * 1e-8);
            assert!((needle.pdf(BEFORE, ahead) / peak - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn terms_tell_the_same_density() {
        let phases = [0.5, -0.9, 0.0, 0.999].map(|g| Phase::HenyeyGreenstein(HenyeyGreenstein::new(g).unwrap()));
        for phase in phases.into_iter().chain([Phase::Isotropic, Phase::Rayleigh]) {
            for number in 0..100 {
                let next = warp::uniform_sphere(Sampler::new(24, 0, number).two(0));
                let told = phase.terms().pdf(BEFORE.to_array(), next.to_array());
                assert!((told / phase.pdf(BEFORE, next) - 1.0).abs() < 1e-13, "{phase:?}");
            }
        }
    }

    #[test]
    fn moments_and_shares_are_those_of_the_distribution() {
        // Means of Legendre polynomials of the cosine, and the shares turned by less than 10 and 90 degrees.
        for (g, expected) in [
            (0.9, [0.9, 0.81, 0.729, 0.6561, 0.509346633039619, 0.977096729007244]),
            (-0.35, [-0.35, 0.1225, -0.042875, 0.01500625, 0.00272109416246281, 0.2546224395874]),
        ] {
            let phase = HenyeyGreenstein::new(g).unwrap();
            for (degrees, value) in [(10f64, expected[4]), (90.0, expected[5])] {
                assert!((1.0 - share(g, degrees.to_radians().cos()) - value).abs() < 1e-11);
            }
            let count = 60_000;
            let mut sums = [[0.0; 2]; 4];
            for number in 0..count {
                let c = phase.sample(BEFORE, Sampler::new(22, 0, number).two(0)).dot(BEFORE);
                let polynomials =
                    [c, 1.5 * c * c - 0.5, 2.5 * c * c * c - 1.5 * c, (35.0 * c.powi(4) - 30.0 * c * c + 3.0) / 8.0];
                for (sum, p) in sums.iter_mut().zip(polynomials) {
                    sum[0] += p;
                    sum[1] += p * p;
                }
            }
            for (sum, value) in sums.iter().zip(expected) {
                let [mean, square] = sum.map(|s| s / f64::from(count));
                let error = ((square - mean * mean) / f64::from(count)).sqrt();
                // Four standard errors: chance exceeds them once in 16,000 cases.
                assert!((mean - value).abs() < 4.0 * error, "{g}: {mean} ± {error}, not {value}");
            }
        }
    }

    #[test]
    fn rayleighs_draws_have_its_distribution() {
        let mut counts = vec![0; 20];
        for number in 0..50_000 {
            let next = Phase::Rayleigh.sample(BEFORE, Sampler::new(23, 0, number).two(0));
            assert!((next.length() - 1.0).abs() < 1e-12);
            let c = next.dot(BEFORE);
            counts[(((c * c * c + 3.0 * c + 4.0) / 8.0 * 20.0) as usize).min(19)] += 1;
        }
        assert_frequencies(&counts, &[0.05; 20]);
        for u in [0.0, 1e-18, 0.5, 1.0 - 1e-16, 1.0] {
            assert!((Phase::Rayleigh.sample(BEFORE, [u, 0.3]).length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn refuses_what_is_no_mean_cosine() {
        for bad in [-1.0, 1.0, 2.0, f64::NAN] {
            assert_eq!(HenyeyGreenstein::new(bad), None);
        }
    }
}
