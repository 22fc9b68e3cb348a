//! The Blackman-Harris filter.

use super::{FilterProfile, length};

/// A sum of four cosines with almost no side lobes, nowhere negative (Harris, "On the Use of Windows for Harmonic
/// Analysis with the Discrete Fourier Transform", 1978: the minimum four-term window).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlackmanHarris {
    radius: f64,
}

impl BlackmanHarris {
    /// Creates a window that ends at `radius`.
    pub fn new(radius: f64) -> Result<Self, String> {
        Ok(Self { radius: length("radius", radius)? })
    }
}

impl FilterProfile for BlackmanHarris {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn evaluate(&self, x: f64) -> f64 {
        // All cosines from the first, by Chebyshev polynomials.
        let c = (std::f64::consts::PI * x / self.radius).cos();
        0.35875 + c * 0.48829 + (2.0 * c * c - 1.0) * 0.14128 + c * (4.0 * c * c - 3.0) * 0.01168
    }
}
