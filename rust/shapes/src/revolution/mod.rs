//! Cylinders, cones and paraboloids: what a line or a parabola draws when it is turned about an axis, between two
//! planes.
//!
//! With x a point relative to the foot of the axis and v the axis, |x × v| is |v| times the distance from the axis, and
//! x · v is |v| times the height. So all are the zeros of polynomials in what is given, with no unit vector and no
//! rotation:
//!
//! - from radius r to r + k: `v² |x × v|² = (r v² + k (x · v))²`;
//! - a parabola of radius r at height |v|: `|x × v|² = r² (x · v)`.
//!
//! The height is limited by 0 ≤ x · v ≤ v².

mod area;
mod meets;
mod shape;

use super::{Bounds, Point};
use raywright_base::math::robust::UNIT;
use raywright_base::math::{DVec3, Frame};
use std::f64::consts::TAU;

/// What is turned about the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Profile {
    /// A line, from one distance to another.
    Straight { base: f64, tip: f64 },
    /// A parabola, from the axis to a distance.
    Parabola { tip: f64 },
}

/// The parts of its surface.
pub(crate) const BASE: usize = 0;
pub(crate) const SIDE: usize = 1;
pub(crate) const TIP: usize = 2;

/// A surface of revolution about a segment.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    /// Where the axis begins.
    pub(crate) base: DVec3,
    /// Where it ends.
    pub(crate) tip: DVec3,
    /// What is turned.
    pub(crate) profile: Profile,
    /// Whether it is closed by disks.
    pub(crate) capped: bool,
}

impl Revolution {
    /// The radii of the two ends.
    pub(crate) fn radii(&self) -> [f64; 2] {
        match self.profile {
            Profile::Straight { base, tip } => [base, tip],
            Profile::Parabola { tip } => [0.0, tip],
        }
    }

    /// The frame about the axis, and the height.
    pub(crate) fn frame(&self) -> (Frame, f64) {
        let axis = self.tip - self.base;
        // Scaled first, so that no square overflows or vanishes.
        let scale = axis.abs().max_element();
        let scaled = axis / scale;
        let length = scaled.length();
        (Frame::new(scaled / length), length * scale)
    }

    /// The box around it: around its two rims, since nothing bulges out between them.
    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::of_support(|d| self.support(d))
    }

    /// The greatest d · x of its points, rounded up.
    pub(crate) fn support(&self, d: DVec3) -> f64 {
        let (frame, height) = self.frame();
        let across = d.cross(frame.normal).length();
        let rim = |end: DVec3, radius: f64| {
            let size = (end.abs() * d.abs()).element_sum() + radius * d.length();
            // The sum of three products errs by 3 UNIT of the sum of their sizes; the frame's own normal by 4 UNIT,
            // which tells on the second term only.
            end.dot(d) + radius * across + 16.0 * UNIT * size
        };
        match self.profile {
            Profile::Straight { base, tip } => rim(self.base, base).max(rim(self.tip, tip)),
            Profile::Parabola { tip } => {
                // Along the profile (r v, h v²): greatest at the rim or, where d points below it, at v = −r |d⊥| / (2 h
                // d∥).
                let along = d.dot(frame.normal) * height;
                let v = -tip * across / (2.0 * along);
                let bulge = if (0.0..=1.0).contains(&v) {
                    rim(self.base, 0.0) + v * tip * across / 2.0 + 32.0 * UNIT * (tip + height) * d.length()
                } else {
                    f64::NEG_INFINITY
                };
                bulge.max(rim(self.base, 0.0)).max(rim(self.tip, tip))
            }
        }
    }

    /// Where the second coordinate comes from the base cap to the side, and from there to the tip cap: by lengths along
    /// the profile, and half and half of a paraboloid.
    pub(crate) fn breaks(&self) -> [f64; 2] {
        match self.profile {
            _ if !self.capped => [0.0, 1.0],
            Profile::Parabola { .. } => [0.0, 0.5],
            Profile::Straight { base, tip } => {
                let slant = (self.frame().1).hypot(tip - base);
                let whole = base + slant + tip;
                [base / whole, (base + slant) / whole]
            }
        }
    }

    /// The coordinates of a point of a part, relative to the foot.
    pub(crate) fn coordinates(&self, part: usize, x: DVec3) -> [f64; 2] {
        let (frame, height) = self.frame();
        let local = frame.to_local(x);
        let turn = local.y.atan2(local.x) / TAU;
        let u = if turn < 0.0 { (turn + 1.0).min(1.0) } else { turn };
        let [low, high] = self.breaks();
        let distance = local.x.hypot(local.y);
        let [base, tip] = self.radii();
        let v = match part {
            BASE => (low * (distance / base)).min(low.next_down()),
            TIP => (1.0 - (1.0 - high) * (distance / tip)).max(high.next_up()),
            _ => {
                let along = match self.profile {
                    Profile::Straight { .. } => local.z / height,
                    Profile::Parabola { tip } => distance / tip,
                };
                (low + (high - low) * along).clamp(low, high)
            }
        };
        [u, v.clamp(0.0, 1.0)]
    }

    /// The point of given coordinates.
    ///
    /// The error of a coordinate is that of its last sum, one unit of its own, and those of the summands, which come
    /// from a few roundings each: 8 of the height's and 16 of the radius', with the frame's.
    pub(crate) fn at(&self, [u, v]: [f64; 2]) -> Point {
        let (frame, height) = self.frame();
        let [base, tip] = self.radii();
        let [low, high] = self.breaks();
        let (sin, cos) = (TAU * u).sin_cos();
        let out = frame.tangent * cos + frame.bitangent * sin;
        let round = (frame.bitangent * cos - frame.tangent * sin) * TAU;
        let up = frame.normal;
        let most = base.max(tip);
        let done = |x: DVec3, from: DVec3, normal: DVec3, dp: [DVec3; 2], dn: [DVec3; 2]| {
            let position = from + x;
            let error = UNIT * (position.abs().max_element() + 8.0 * height + 16.0 * most);
            Point { position, error, normal, uv: [u, v], dp, dn }
        };
        if v < low {
            let radius = base * (v / low);
            return done(out * radius, self.base, -up, [round * radius, out * (base / low)], [DVec3::ZERO; 2]);
        }
        if v > high {
            let slope = tip / (1.0 - high);
            let radius = slope * (1.0 - v);
            return done(out * radius, self.tip, up, [round * radius, out * -slope], [DVec3::ZERO; 2]);
        }
        let (span, along) = (high - low, (v - low) / (high - low));
        match self.profile {
            Profile::Straight { .. } => {
                let widening = tip - base;
                let radius = base + widening * along;
                let slant = height.hypot(widening);
                let (level, rise) = (height / slant, -widening / slant);
                // From the nearer end, so that its rim is met.
                let (from, x) = if along <= 0.5 {
                    (self.base, up * (height * along))
                } else {
                    (self.tip, up * (height * (along - 1.0)))
                };
                let dv = (out * widening + up * height) / span;
                let normal = out * level + up * rise;
                done(x + out * radius, from, normal, [round * radius, dv], [round * level, DVec3::ZERO])
            }
            Profile::Parabola { .. } => {
                let radius = tip * along;
                // Upwards it is h for every r, outwards 2 h s for every s of the way: the normal is at right angles.
                let (n, dn) = (out * (2.0 * height * along) - up * tip, out * (2.0 * height / span));
                let length = n.length();
                let normal = n / length;
                let (from, x) = if along <= 0.75 {
                    (self.base, up * (height * along * along))
                } else {
                    (self.tip, up * (height * (along - 1.0) * (along + 1.0)))
                };
                let dv = (out * tip + up * (2.0 * height * along)) / span;
                let turned = round * (2.0 * height * along / length);
                let bent = (dn - normal * normal.dot(dn)) / length;
                done(x + out * radius, from, normal, [round * radius, dv], [turned, bent])
            }
        }
    }
}
