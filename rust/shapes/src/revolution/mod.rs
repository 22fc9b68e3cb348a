//! Surfaces of revolution: cylinders, cones and paraboloids about a segment.
//!
//! Let x be a point relative to the foot of the axis and v the axis. Then |x × v| is |v| times the distance from the
//! axis, and x · v is |v| times the height. All surfaces are therefore zeros of polynomials in the given numbers,
//! without unit vectors or rotations:
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

/// The profile curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ProfileCurve {
    /// A straight line between two radii.
    Straight { base: f64, tip: f64 },
    /// A parabola from the axis to a rim radius.
    Parabola { tip: f64 },
}

/// The parts of its surface.
pub(crate) const BASE: usize = 0;
pub(crate) const SIDE: usize = 1;
pub(crate) const TIP: usize = 2;

/// A surface of revolution about a segment.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    /// The start of the axis.
    pub(crate) base: DVec3,
    /// The end of the axis.
    pub(crate) tip: DVec3,
    /// The profile curve.
    pub(crate) profile: ProfileCurve,
    /// True if it is closed by disks.
    pub(crate) capped: bool,
}

impl Revolution {
    /// The radii of the two ends.
    pub(crate) fn radii(&self) -> [f64; 2] {
        match self.profile {
            ProfileCurve::Straight { base, tip } => [base, tip],
            ProfileCurve::Parabola { tip } => [0.0, tip],
        }
    }

    /// The frame about the axis, and the height.
    pub(crate) fn frame(&self) -> (Frame, f64) {
        let axis = self.tip - self.base;
        // Scaled first, so that no square overflows or underflows.
        let scale = axis.abs().max_element();
        let scaled = axis / scale;
        let length = scaled.length();
        (Frame::new(scaled / length), length * scale)
    }

    /// The bounding box of the two rims; the surface does not bulge out between them.
    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::of_support(|d| self.support(d))
    }

    /// The support function: the greatest d · x over the surface, rounded up.
    pub(crate) fn support(&self, d: DVec3) -> f64 {
        let (frame, height) = self.frame();
        let across = d.cross(frame.normal).length();
        let rim = |end: DVec3, radius: f64| {
            let size = (end.abs() * d.abs()).element_sum() + radius * d.length();
            // The sum of three products errs by 3 UNIT of the sum of their magnitudes. The frame's normal errs by 4
            // UNIT, which affects only the second term.
            end.dot(d) + radius * across + 16.0 * UNIT * size
        };
        match self.profile {
            ProfileCurve::Straight { base, tip } => rim(self.base, base).max(rim(self.tip, tip)),
            ProfileCurve::Parabola { tip } => {
                // Along the profile (r v, h v²) the maximum is at the rim or, where d points below it, at v = −r |d⊥| /
                // (2 h d∥).
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

    /// The values of v at which the base cap ends and the tip cap begins. They follow the arc length of the profile,
    /// and halve v for a paraboloid.
    pub(crate) fn breaks(&self) -> [f64; 2] {
        match self.profile {
            _ if !self.capped => [0.0, 1.0],
            ProfileCurve::Parabola { .. } => [0.0, 0.5],
            ProfileCurve::Straight { base, tip } => {
                let slant = (self.frame().1).hypot(tip - base);
                let whole = base + slant + tip;
                [base / whole, (base + slant) / whole]
            }
        }
    }

    /// The surface parameters of a point of a part, relative to the foot.
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
                    ProfileCurve::Straight { .. } => local.z / height,
                    ProfileCurve::Parabola { tip } => distance / tip,
                };
                (low + (high - low) * along).clamp(low, high)
            }
        };
        [u, v.clamp(0.0, 1.0)]
    }

    /// The point at given surface parameters.
    ///
    /// A coordinate errs by one UNIT of itself for the last sum, and by the summands' errors from a few roundings each.
    /// These are 8 UNIT of the height and 16 of the radius, including the frame.
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
            ProfileCurve::Straight { .. } => {
                let widening = tip - base;
                let radius = base + widening * along;
                let slant = height.hypot(widening);
                let (level, rise) = (height / slant, -widening / slant);
                // From the nearer end, so that its rim is exact.
                let (from, x) = if along <= 0.5 {
                    (self.base, up * (height * along))
                } else {
                    (self.tip, up * (height * (along - 1.0)))
                };
                let dv = (out * widening + up * height) / span;
                let normal = out * level + up * rise;
                done(x + out * radius, from, normal, [round * radius, dv], [round * level, DVec3::ZERO])
            }
            ProfileCurve::Parabola { .. } => {
                let radius = tip * along;
                // The tangent has the axial part 2 h s for the radial part r, and the normal is at right angles to it.
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
