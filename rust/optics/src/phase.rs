//! Phase functions of media.

use raywright_base::math::{DVec3, Frame};
use raywright_base::sampling::warp;
use std::f64::consts::{FRAC_1_PI, TAU};

/// A phase function, by the scattering angle. Directions are unit vectors along the path: `before` scattering and
/// `next` after it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Phase {
    /// Isotropic scattering.
    #[default]
    Isotropic,
    /// Henyey-Greenstein scattering with a mean cosine.
    HenyeyGreenstein(HenyeyGreenstein),
    /// Rayleigh scattering, by particles much smaller than a wavelength.
    Rayleigh,
}

impl Phase {
    /// Density by solid angle of continuing along `next`, which equals the value of the phase function.
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

    /// Maximum density, straight forwards or backwards.
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

    /// Coefficients of the density.
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

    /// Samples a direction with the density of [`Phase::pdf`].
    #[inline]
    pub fn sample(&self, before: DVec3, u: [f64; 2]) -> DVec3 {
        match self {
            Self::Isotropic => warp::uniform_sphere(u),
            Self::HenyeyGreenstein(by) => by.sample(before, u),
            Self::Rayleigh => {
                // The distribution (μ³ + 3μ + 4) / 8 is inverted by Cardano's formula. Its two roots do not cancel if
                // the greater comes first (Frisvad, "Importance Sampling the Rayleigh Phase Function", 2011).
                let a = 4.0 * u[0] - 2.0;
                let root = (a.abs() + (a * a + 1.0).sqrt()).cbrt();
                let cosine = (root - 1.0 / root).copysign(a).clamp(-1.0, 1.0);
                turned(before, 1.0 - cosine, u[1])
            }
        }
    }
}

/// Coefficients of the density of any phase function, for branch-free loops.
#[derive(Clone, Copy, Debug)]
pub struct PhaseTerms {
    scale: f64,
    sign: f64,
    least: f64,
    chord: f64,
    square: f64,
}

impl PhaseTerms {
    /// Density of continuing along `next` after `before`; equals [`Phase::pdf`] up to rounding.
    #[inline(always)]
    pub fn pdf(&self, before: [f64; 3], next: [f64; 3]) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| next[axis] - before[axis] * self.sign);
        let cosine = before[0] * next[0] + before[1] * next[1] + before[2] * next[2];
        let square = self.least + self.chord * (x * x + y * y + z * z);
        self.scale * (1.0 + self.square * cosine * cosine) / (square * square.sqrt())
    }
}

/// Rotates a unit direction by an angle given as 1 − cos θ, so that a tiny rotation is not rounded away.
#[inline]
fn turned(before: DVec3, less: f64, u: f64) -> DVec3 {
    let sine = (less * (2.0 - less)).max(0.0).sqrt();
    let (sin, cos) = (TAU * u).sin_cos();
    let frame = Frame::new(before);
    before + frame.tangent * (sine * cos) + frame.bitangent * (sine * sin) - before * less
}

/// The phase function of Henyey and Greenstein ("Diffuse Radiation in the Galaxy", 1941), by its mean cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    g: f64,
}

impl HenyeyGreenstein {
    /// Creates it with a mean cosine between −1 (backwards) and 1 (forwards), both excluded: `None` for another.
    pub fn new(g: f64) -> Option<Self> {
        (g.abs() < 1.0).then_some(Self { g })
    }

    /// Mean cosine.
    pub fn g(&self) -> f64 {
        self.g
    }

    /// Density by solid angle of continuing along `next` after `before`, both unit.
    ///
    /// 1 + g² − 2g cos θ is (1 − |g|)² plus |g| times the squared chord between `next` and the peak direction, two
    /// non-negative numbers.
    #[inline]
    pub fn pdf(&self, before: DVec3, next: DVec3) -> f64 {
        let g = self.g.abs();
        let chord = (next - before * 1f64.copysign(self.g)).length_squared();
        let square = (1.0 - g) * (1.0 - g) + g * chord;
        0.25 * FRAC_1_PI * (1.0 - g) * (1.0 + g) / (square * square.sqrt())
    }

    /// Samples a direction with the density of [`HenyeyGreenstein::pdf`].
    ///
    /// The distribution is inverted for 1 − cos θ, with θ measured from the peak, which avoids cancellation and covers
    /// g = 0: 1 − cos θ = 2 (1 − u)(1 + gu) ((1 − g) / (1 − g + 2gu))².
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

    /// Share of light with a scattering cosine of at most `c`, in closed form.
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
            // A cosine's variance is at most 1: five standard errors, a false alarm in two million.
            assert!((sum / f64::from(count) - g).abs() < 5.0 / f64::from(count).sqrt());
        }
    }

    #[test]
    fn density_is_the_distributions_slope() {
        for g in [-0.999, -0.3, 0.0, 0.6, 0.999] {
            let phase = HenyeyGreenstein::new(g).unwrap();
            for step in 1..40 {
                // Finer near the peak of the density.
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
        // Nearly all light is in a needle: the density along it is (1 + g) / (4π (1 − g)²), and the sides are equally
        // sharp.
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
        // Means of Legendre polynomials of the cosine, and the shares scattered by less than 10 and 90 degrees.
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
                // Four standard errors; the probability of exceeding them is 1 in 16,000.
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
