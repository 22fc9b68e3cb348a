//! The Gaussian filter.

use super::{FilterProfile, length};

/// A normal distribution minus its value at the radius, so that it is continuous there (Pharr, Jakob and Humphreys,
/// "Physically Based Rendering", 4th edition, 2023, section 8.8.4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    radius: f64,
    sigma: f64,
}

impl Gaussian {
    /// Creates a Gaussian of standard deviation `sigma`, cut off at `radius`.
    pub fn new(radius: f64, sigma: f64) -> Result<Self, String> {
        Ok(Self { radius: length("radius", radius)?, sigma: length("sigma", sigma)? })
    }
}

impl FilterProfile for Gaussian {
    fn radius(&self) -> f64 {
        self.radius.min(WHOLE * self.sigma)
    }

    fn evaluate(&self, x: f64) -> f64 {
        let exponent = |x: f64| -0.5 * (x / self.sigma).powi(2);
        let (here, end) = (exponent(x), exponent(self.radius));
        if end < -0.5 * WHOLE * WHOLE {
            here.exp()
        } else {
            // exp(here) − exp(end), which keeps its digits if the Gaussian is much wider than the radius.
            end.exp() * (here - end).exp_m1()
        }
    }
}

/// Beyond this number of standard deviations, the value is below the rounding error at the center.
const WHOLE: f64 = 9.0;
