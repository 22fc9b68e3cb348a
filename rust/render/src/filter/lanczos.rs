//! The Lanczos filter: a windowed sinc.

use super::FilterProfile;
use std::f64::consts::PI;

/// sinc(x) · sinc(x / n), cut off at its n-th zero: the ideal filter windowed by the central lobe of another (Duchon,
/// "Lanczos Filtering in One and Two Dimensions", 1979). It is the sharpest filter here and rings most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lanczos {
    lobes: u32,
}

impl Lanczos {
    /// Maximum number of lobes.
    pub const MOST: u32 = 16;

    /// Creates a filter that ends at `lobes` pixels.
    pub fn new(lobes: u32) -> Result<Self, String> {
        if (1..=Self::MOST).contains(&lobes) {
            Ok(Self { lobes })
        } else {
            Err(format!("lobes is {lobes}, expected 1 to {}", Self::MOST))
        }
    }
}

impl FilterProfile for Lanczos {
    fn radius(&self) -> f64 {
        f64::from(self.lobes)
    }

    fn evaluate(&self, x: f64) -> f64 {
        // The sine of π x from the distance to the nearest zero, so that zeros are exact.
        let whole = x.round();
        let sine = (PI * (x - whole)).sin() * if whole as i64 % 2 == 0 { 1.0 } else { -1.0 };
        let sinc = if x == 0.0 { 1.0 } else { sine / (PI * x) };
        let angle = PI * x / f64::from(self.lobes);
        let window = if x == 0.0 {
            1.0
        } else if x == f64::from(self.lobes) {
            0.0
        } else {
            angle.sin() / angle
        };
        sinc * window
    }

    fn parts(&self) -> usize {
        self.lobes as usize
    }
}
