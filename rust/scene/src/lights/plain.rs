//! Surfaces that shine alike everywhere, as they are drawn from.

use super::{Luminous, Sides};
use crate::Geometry;
use crate::textures::TexturePoint;
use raywright_accel::Primitives;
use raywright_base::math::DVec3;
use raywright_optics::Rgb;

/// A triangle or a sphere that shines alike everywhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlainLight {
    pub primitive: u32,
    pub figure: Figure,
    pub radiance: Rgb,
    /// Whether the front shines, and the back.
    pub sides: [bool; 2],
}

/// Where it is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Figure {
    Triangle { corners: [DVec3; 3], normal: DVec3 },
    Ball { center: DVec3, radius: f64 },
}

impl PlainLight {
    /// One of a geometry, if it is one that no ray goes on through.
    #[inline]
    pub fn new(geometry: &Geometry, luminous: &Luminous, primitive: u32) -> Option<Self> {
        let Luminous { emission, open: None } = luminous else { return None };
        let figure = match geometry.shape(primitive) {
            None => Figure::Triangle { corners: geometry.corners(primitive), normal: geometry.normal(primitive) },
            Some(shape) => {
                let (center, radius) = shape.ball()?;
                Figure::Ball { center, radius }
            }
        };
        let sides = [emission.sides != Sides::Back, emission.sides != Sides::Front];
        let radiance = || emission.radiance.at(&TexturePoint::NOWHERE);
        (!emission.needs().any()).then(|| Self { primitive, figure, radiance: radiance(), sides })
    }
}
