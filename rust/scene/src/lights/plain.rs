//! Precomputed data of surfaces with uniform emission.

use super::{Luminous, Sides};
use crate::Geometry;
use crate::textures::TexturePoint;
use raywright_accel::Primitives;
use raywright_base::math::DVec3;
use raywright_optics::Rgb;

/// A triangle or a sphere of uniform emission.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlainLight {
    pub primitive: u32,
    pub figure: Figure,
    pub radiance: Rgb,
    /// True if the front, or the back, emits.
    pub sides: [bool; 2],
}

/// Geometry of the emitter.
#[derive(Clone, Copy, Debug)]
pub(super) enum Figure {
    Triangle { corners: [DVec3; 3] },
    Ball { center: DVec3, radius: f64 },
}

impl PlainLight {
    /// Computes the data of a primitive, if it is a triangle or sphere of uniform emission and opaque to straight rays.
    #[inline]
    pub fn new(geometry: &Geometry, luminous: &Luminous, primitive: u32) -> Option<Self> {
        let emission = luminous.emission;
        let radiance = || emission.radiance.at(&TexturePoint::NOWHERE);
        if emission.needs().any() { None } else { Self::shining(geometry, luminous, primitive, radiance()) }
    }

    /// The same of one whose emission depends on wavelength alone, with a radiance of 1 at each.
    pub fn by_waves(geometry: &Geometry, luminous: &Luminous, primitive: u32) -> Option<Self> {
        let needs = luminous.emission.needs();
        if needs.waves && !needs.of_place() { Self::shining(geometry, luminous, primitive, Rgb::ONE) } else { None }
    }

    fn shining(geometry: &Geometry, luminous: &Luminous, primitive: u32, radiance: Rgb) -> Option<Self> {
        let Luminous { emission, open: None } = luminous else { return None };
        let figure = match geometry.shape(primitive) {
            None => Figure::Triangle { corners: geometry.corners(primitive) },
            Some(shape) => {
                let (center, radius) = shape.ball()?;
                Figure::Ball { center, radius }
            }
        };
        let sides = [emission.sides != Sides::Back, emission.sides != Sides::Front];
        Some(Self { primitive, figure, radiance, sides })
    }
}
