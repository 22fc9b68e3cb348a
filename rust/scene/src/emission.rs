//! How a surface shines.

use crate::textures::{Needs, TexturePoint, Value};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;

/// Which sides of a surface shine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// That to which the normals point: the outside of what is closed.
    #[default]
    Front,
    /// The other: the inside of what is closed.
    Back,
    /// Either.
    Both,
}

impl Sides {
    /// Whether there is light on the side on which the cosine to the normal, or what has its sign, is this.
    #[inline]
    pub fn shine(self, cosine: f64) -> bool {
        match self {
            Self::Front => cosine > 0.0,
            Self::Back => cosine < 0.0,
            Self::Both => cosine.abs() > 0.0,
        }
    }

    /// The way that a surface of this normal shines; none if it shines both ways.
    pub fn facing(self, normal: DVec3) -> Option<DVec3> {
        match self {
            Self::Front => Some(normal),
            Self::Back => Some(-normal),
            Self::Both => None,
        }
    }

    /// How many they are.
    pub fn count(self) -> f64 {
        if self == Self::Both { 2.0 } else { 1.0 }
    }
}

/// The light that a surface gives off by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    /// Radiance into every direction.
    pub radiance: Value,
    /// Where it shines.
    pub sides: Sides,
}

impl Default for Emission {
    /// None.
    fn default() -> Self {
        Self { radiance: Value::ZERO, sides: Sides::Front }
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
        if self.sides.shine(cosine) { self.radiance.at(point) } else { Rgb::ZERO }
    }

    /// What it must know of a point.
    pub fn needs(&self) -> Needs {
        self.radiance.needs()
    }

    /// Whether it can be: finite and not negative.
    pub fn is_physical(&self) -> bool {
        self.radiance.range().into_iter().all(Rgb::is_radiance)
    }
}
