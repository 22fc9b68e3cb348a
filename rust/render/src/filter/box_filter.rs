//! The box filter.

use super::{Filter, length};

/// The mean over a square; with a radius of half a pixel, that of an ideal sensor. Every sample has weight 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box {
    radius: f64,
}

impl Box {
    /// Creates a square of side 2 · `radius`.
    pub fn new(radius: f64) -> Result<Self, String> {
        Ok(Self { radius: length("radius", radius)? })
    }
}

/// The pixel's own square.
impl Default for Box {
    fn default() -> Self {
        Self { radius: 0.5 }
    }
}

impl Filter for Box {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn evaluate(&self, x: f64, y: f64) -> f64 {
        if x.abs().max(y.abs()) <= self.radius { 0.25 / (self.radius * self.radius) } else { 0.0 }
    }

    #[inline]
    fn sample(&self, u: [f64; 2]) -> ([f64; 2], f64) {
        // Exact for the default radius, because u has few enough bits.
        (u.map(|u| (u - 0.5) * (2.0 * self.radius)), 1.0)
    }
}
