//! Where lights are and where they shine to: what a tree of lights knows of a part of them.

use super::LightSampleContext;
use raywright_base::math::{DVec3, Frame};
use std::f64::consts::{FRAC_PI_2, PI};

/// A box around lights, a cone around the ways they face, and how far from these they shine
/// (Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBounds {
    /// The least corner of the box.
    pub min: DVec3,
    /// The greatest corner.
    pub max: DVec3,
    /// The axis of the cone, unit.
    pub axis: DVec3,
    /// The cosine of the angle between axis and rim of the cone; −1 if it holds all directions.
    pub cos_cone: f64,
    /// The cosine of the greatest angle to where it faces at which a light still shines, at most a right angle.
    pub cos_reach: f64,
    /// The sum of the greatest intensities, W·sr⁻¹.
    pub intensity: f64,
}

/// Room for the roundings of cones, in radians: what is at the rim must be inside.
const ROOM: f64 = 1e-6;

impl LightBounds {
    /// A point that shines everywhere.
    pub fn everywhere(position: DVec3, intensity: f64) -> Self {
        let (min, max) = (position, position);
        Self { min, max, axis: DVec3::Z, cos_cone: -1.0, cos_reach: 0.0, intensity }
    }

    /// A point that shines, about evenly, as far as an angle from an axis, in radians.
    pub fn within(position: DVec3, axis: DVec3, angle: f64, intensity: f64) -> Self {
        let (min, max) = (position, position);
        Self { min, max, axis, cos_cone: (angle + ROOM).cos(), cos_reach: (1e-3f64).cos(), intensity }
    }

    /// A surface in a box, of one normal or of any, that shines by the cosine.
    pub fn surface([min, max]: [DVec3; 2], normal: Option<DVec3>, intensity: f64) -> Self {
        let (axis, cos_cone) = normal.map_or((DVec3::Z, -1.0), |n| (n, 1.0));
        Self { min, max, axis, cos_cone, cos_reach: 0.0, intensity }
    }

    /// The middle of the box.
    #[inline(always)]
    pub fn centre(&self) -> DVec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Around both.
    pub fn union(&self, other: &Self) -> Self {
        let (axis, cos_cone) = cone_of(self, other);
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            axis,
            cos_cone,
            cos_reach: self.cos_reach.min(other.cos_reach),
            intensity: self.intensity + other.intensity,
        }
    }

    /// About what all of it brings to a receiver; 0 only if it brings nothing.
    ///
    /// As if all were at the middle, but facing the receiver as much as any of it can, and as far above the receiver's
    /// horizon.
    #[inline(always)]
    pub fn importance(&self, receiver: &LightSampleContext) -> f64 {
        let way = receiver.position - self.centre();
        let (square, radius) = (way.length_squared(), 0.25 * (self.max - self.min).length_squared());
        // Sines and cosines are taken times the distance, so that they need no quotient, and their roots need not wait
        // for each other. What does not count is computed too, and left: lanes have no branches.
        let inverse = 1.0 / square;
        let (sin_ball, cos_ball) = (radius.sqrt(), (square - radius).sqrt());
        let to_ball = |sin: f64, cos: f64| {
            let outside = (cos * cos_ball + sin * sin_ball) * inverse;
            if cos >= cos_ball { 1.0 } else { outside }
        };
        let (mut importance, mut is_missed) = (self.intensity * inverse, false);
        if self.cos_cone > -1.0 {
            let (cos, distance) = (self.axis.dot(way), square.sqrt());
            // The angle to the nearest normal, and then what of it is left by the nearest point.
            let (sin, sin_cone) = (across(cos, square), across(self.cos_cone, 1.0));
            let nearest = to_ball(sin * self.cos_cone - cos * sin_cone, cos * self.cos_cone + sin * sin_cone);
            let cos = if cos >= self.cos_cone * distance { 1.0 } else { nearest };
            is_missed = cos < self.cos_reach;
            importance *= cos;
        }
        let cos = -receiver.normal.dot(way);
        let above = importance * to_ball(across(cos, square), cos).max(0.0);
        let importance = if receiver.is_free() { importance } else { above };
        // Within the ball around the box, all ways to it are possible.
        let within = if radius > 0.0 { self.intensity / radius } else { 0.0 };
        let outside = if is_missed { 0.0 } else { importance };
        if square <= radius { within } else { outside }
    }

    /// The cost of a part of a tree, up to what is the same for all: intensity times the area that it takes, times the
    /// directions that it shines to (Conty Estevez and Kulla, 2018, their equation 1). The area is that of the ball
    /// around the box, as boxes of lights in a row have none.
    pub fn cost(&self) -> f64 {
        let cone = self.cos_cone.clamp(-1.0, 1.0).acos();
        let (sin, cos) = cone.sin_cos();
        let reach = (cone + self.cos_reach.clamp(-1.0, 1.0).acos()).min(PI);
        let directions = 2.0 * PI * (1.0 - cos)
            + FRAC_PI_2 * (2.0 * reach * sin - (cone - 2.0 * reach).cos() - 2.0 * cone * sin + cos);
        self.intensity * directions * (self.max - self.min).length_squared()
    }
}

/// The sine of an angle by its cosine, both times a length of this square.
#[inline(always)]
fn across(cos: f64, square: f64) -> f64 {
    (square - cos * cos).max(0.0).sqrt()
}

/// The least cone around two, with a little room.
fn cone_of(a: &LightBounds, b: &LightBounds) -> (DVec3, f64) {
    let angles = [a, b].map(|bounds| bounds.cos_cone.clamp(-1.0, 1.0).acos());
    let (wide, narrow, [wider, narrower]) =
        if angles[0] >= angles[1] { (a, b, angles) } else { (b, a, [angles[1], angles[0]]) };
    // By both sine and cosine, so that small angles keep their digits.
    let between = wide.axis.cross(narrow.axis).length().atan2(wide.axis.dot(narrow.axis));
    if between + narrower <= wider {
        return (wide.axis, wide.cos_cone);
    }
    let half = 0.5 * (wider + between + narrower) + ROOM;
    if half >= PI {
        return (wide.axis, -1.0);
    }
    let across = narrow.axis - wide.axis * narrow.axis.dot(wide.axis);
    // Opposite axes are turned to each other about any.
    let across = across.try_normalize().unwrap_or_else(|| Frame::new(wide.axis).tangent);
    let (sin, cos) = (half - ROOM - wider).sin_cos();
    ((wide.axis * cos + across * sin).normalize(), half.cos())
}
