//! The Mitchell-Netravali filter.

use super::{FilterProfile, length};

/// A cubic spline with a negative lobe, which sharpens (Mitchell and Netravali, "Reconstruction Filters in Computer
/// Graphics", 1988). B blurs, C rings; the authors advise B + 2C = 1, and B = C = 1/3 among these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mitchell {
    radius: f64,
    b: f64,
    c: f64,
}

impl Mitchell {
    /// Creates a spline that ends at `radius`; 2 pixels give the published filter.
    pub fn new(radius: f64, b: f64, c: f64) -> Result<Self, String> {
        for (name, value) in [("b", b), ("c", c)] {
            if !(0.0..=1.0).contains(&value) {
                return Err(format!("{name} is {value}, expected 0 to 1"));
            }
        }
        Ok(Self { radius: length("radius", radius)?, b, c })
    }
}

impl FilterProfile for Mitchell {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn evaluate(&self, x: f64) -> f64 {
        let (b, c, x) = (self.b, self.c, 2.0 * x / self.radius);
        if x < 1.0 {
            ((12.0 - 9.0 * b - 6.0 * c) * x + (-18.0 + 12.0 * b + 6.0 * c)) * x * x + (6.0 - 2.0 * b)
        } else {
            // The outer cubic in powers of 2 − x, so that it ends at exactly 0.
            let y = 2.0 - x;
            ((b + 6.0 * c) * y - 6.0 * c) * y * y
        }
    }

    fn parts(&self) -> usize {
        2
    }
}
