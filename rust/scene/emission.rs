//! How a surface shines.

use crate::optics::{Rgb, is_radiance};
use crate::scene::textures::{Needs, TexturePoint, Value};

/// The light that a surface gives off by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    /// Radiance into every direction.
    pub radiance: Value,
    /// Whether the side that the normals point away from shines too.
    pub both_sides: bool,
}

impl Default for Emission {
    /// None.
    fn default() -> Self {
        Self { radiance: Value::ZERO, both_sides: false }
    }
}

impl From<Rgb> for Emission {
    fn from(radiance: Rgb) -> Self {
        Self { radiance: radiance.into(), ..Self::default() }
    }
}

impl Emission {
    /// Whether it gives off nothing.
    pub fn is_dark(&self) -> bool {
        self.radiance.is_black()
    }

    /// The radiance from a point towards where the cosine to its normal is this.
    #[inline]
    pub fn towards(&self, cosine: f64, point: &TexturePoint) -> Rgb {
        if cosine > 0.0 || (self.both_sides && cosine < 0.0) { self.radiance.at(point) } else { Rgb::ZERO }
    }

    /// What it must know of a point.
    pub fn needs(&self) -> Needs {
        self.radiance.needs()
    }

    /// Whether it can be: finite and not negative.
    pub fn is_physical(&self) -> bool {
        self.radiance.range().into_iter().all(is_radiance)
    }
}
