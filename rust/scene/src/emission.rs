//! Emission of surfaces.

use crate::textures::{Needs, TexturePoint, Value};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;

/// The emitting sides of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// The side of the normals: the outside of a closed surface.
    #[default]
    Front,
    /// The opposite side: the inside of a closed surface.
    Back,
    /// Both sides.
    Both,
}

impl Sides {
    /// Returns whether a direction is on an emitting side. `cosine` is its cosine to the normal, or any number of that
    /// sign.
    #[inline]
    pub fn shine(self, cosine: f64) -> bool {
        match self {
            Self::Front => cosine > 0.0,
            Self::Back => cosine < 0.0,
            Self::Both => cosine.abs() > 0.0,
        }
    }

    /// The normal of the emitting side, for a surface of this normal; `None` if both sides emit.
    pub fn facing(self, normal: DVec3) -> Option<DVec3> {
        match self {
            Self::Front => Some(normal),
            Self::Back => Some(-normal),
            Self::Both => None,
        }
    }

    /// Number of emitting sides.
    pub fn count(self) -> f64 {
        if self == Self::Both { 2.0 } else { 1.0 }
    }
}

/// Radiance emitted by a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    /// Emitted radiance, equal in all directions.
    pub radiance: Value,
    /// Emitting sides.
    pub sides: Sides,
}

impl Default for Emission {
    /// No emission.
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
    /// Returns whether the emission is zero everywhere.
    pub fn is_dark(&self) -> bool {
        self.radiance.is_black()
    }

    /// Radiance emitted from a point in a direction with this cosine to the normal.
    #[inline]
    pub fn towards(&self, cosine: f64, point: &TexturePoint) -> Rgb {
        if self.sides.shine(cosine) { self.radiance.at(point) } else { Rgb::ZERO }
    }

    /// The lookup data that evaluation needs.
    pub fn needs(&self) -> Needs {
        self.radiance.needs()
    }

    /// Returns whether the radiance is finite and not negative.
    pub fn is_physical(&self) -> bool {
        self.radiance.range().into_iter().all(Rgb::is_radiance)
    }
}
