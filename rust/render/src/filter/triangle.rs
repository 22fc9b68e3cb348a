//! The triangle (tent) filter.

use super::{FilterProfile, length};

/// A linear falloff from the center to 0 at the radius; with a radius of one pixel, linear interpolation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    radius: f64,
}

impl Triangle {
    /// Creates a tent of this half width.
    pub fn new(radius: f64) -> Result<Self, String> {
        Ok(Self { radius: length("radius", radius)? })
    }
}

impl FilterProfile for Triangle {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn evaluate(&self, x: f64) -> f64 {
        1.0 - x / self.radius
    }
}
