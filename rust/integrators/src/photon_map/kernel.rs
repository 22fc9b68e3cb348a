//! Kernels for density estimation.

use std::f64::consts::PI;

/// A kernel over a disk or a ball, with integral 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// Constant: bias r²/8 ∇²E, variance over the photon density 1/(π r²) (Silverman, "Density Estimation for
    /// Statistics and Data Analysis", 1986).
    Box,
    /// 1 − s/r: Jensen's cone filter with k = 1 (2001). Bias 3/40 r² ∇²E, variance 3/(2π r²).
    Cone,
    /// 1 − s²/r² (Epanechnikov, 1969): least error of all kernels for a number of photons. Bias r²/12 ∇²E, variance
    /// 4/(3π r²).
    Epanechnikov,
}

impl Kernel {
    /// Return the weight per area of a photon at a squared distance, given the squared disk radius; 0 from the rim on.
    #[inline]
    pub fn weight(self, squared: f64, radius: f64) -> f64 {
        if squared >= radius {
            return 0.0;
        }
        let share = squared / radius;
        let shape = match self {
            Self::Box => 1.0,
            Self::Cone => 3.0 * (1.0 - share.sqrt()),
            Self::Epanechnikov => 2.0 * (1.0 - share),
        };
        shape / (PI * radius)
    }

    /// Return the weight per volume, given the squared distance and the squared ball radius.
    #[inline]
    pub fn ball_weight(self, squared: f64, radius: f64) -> f64 {
        if squared >= radius {
            return 0.0;
        }
        let share = squared / radius;
        let shape = match self {
            Self::Box => 1.0,
            Self::Cone => 4.0 * (1.0 - share.sqrt()),
            Self::Epanechnikov => 2.5 * (1.0 - share),
        };
        shape * 0.75 / (PI * radius * radius.sqrt())
    }

    /// Return the integral of the ball kernel within the fraction `x` of its radius.
    pub fn ball_share(self, x: f64) -> f64 {
        let cube = x * x * x;
        match self {
            Self::Box => cube,
            Self::Cone => cube * (4.0 - 3.0 * x),
            Self::Epanechnikov => cube * (2.5 - 1.5 * x * x),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integrate a function of the distance over the unit disk, by the midpoints of 100,000 rings: exact to 1e-9.
    fn over_disk(f: impl Fn(f64) -> f64) -> f64 {
        let steps = 100_000;
        let at = |i| (f64::from(i) + 0.5) / f64::from(steps);
        (0..steps).map(|i| f(at(i)) * 2.0 * PI * at(i)).sum::<f64>() / f64::from(steps)
    }

    #[test]
    fn kernels_have_their_constants() {
        // For each kernel: a quarter of the mean squared distance, and the integral of the square.
        for (kernel, bias, variance) in [
            (Kernel::Box, 1.0 / 8.0, 1.0 / PI),
            (Kernel::Cone, 3.0 / 40.0, 3.0 / (2.0 * PI)),
            (Kernel::Epanechnikov, 1.0 / 12.0, 4.0 / (3.0 * PI)),
        ] {
            let weight = |s: f64| kernel.weight(s * s, 1.0);
            assert!((over_disk(weight) - 1.0).abs() < 1e-9);
            assert!((0.25 * over_disk(|s| s * s * weight(s)) - bias).abs() < 1e-9);
            assert!((over_disk(|s| weight(s) * weight(s)) - variance).abs() < 1e-9);
            assert_eq!(kernel.weight(4.0, 4.0), 0.0);
            // The kernel scales with the disk.
            assert!((kernel.weight(1.0, 16.0) * 16.0 - kernel.weight(0.0625, 1.0)).abs() < 1e-15);
        }
    }

    #[test]
    fn balls_have_all_of_their_weight_within_them() {
        for kernel in [Kernel::Box, Kernel::Cone, Kernel::Epanechnikov] {
            for share in [0.3, 0.7, 1.0] {
                // Midpoint rule over the shells of a ball of radius 2.
                let steps = 100_000;
                let at = |i| 2.0 * share * (f64::from(i) + 0.5) / f64::from(steps);
                let shell = |s: f64| 4.0 * PI * s * s * kernel.ball_weight(s * s, 4.0);
                let sum = (0..steps).map(|i| shell(at(i))).sum::<f64>() * 2.0 * share / f64::from(steps);
                assert!((sum - kernel.ball_share(share)).abs() < 1e-8);
            }
            assert_eq!(kernel.ball_share(1.0), 1.0);
            assert_eq!(kernel.ball_weight(4.0, 4.0), 0.0);
        }
    }
}
