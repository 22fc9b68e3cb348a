//! Surfaces `f(x, y, z) = 0` within a box.

mod closed;
mod closest;
mod functions;
mod jet;
mod line;
mod number;
mod parse;
mod roots;
mod surface;
mod tape;
#[cfg(test)]
mod tests;

use super::{Bounds, Candidate, Closest, Drawn, Point, Shape};
use jet::Jet;
use line::{Along, moved};
use raywright_base::math::robust::{UNIT, normalising_scale};
use raywright_base::math::{Affine, DVec3, Interval, Ray};
use std::sync::OnceLock;
use surface::Surface;
use tape::Tape;

/// The zero set of an expression in x, y and z within a box. Positive values are outside.
///
/// No root within the box is skipped: interval arithmetic with outward rounding isolates all roots along a ray
/// (`roots.rs`). Values that f64 cannot distinguish from zero count as zero, so two roots closer than rounding are one
/// tangent. A stretch of zeros is hit once, at its start. Poles and jumps are not roots. After 4096 intervals the
/// remaining ones are accepted as they are, which bounds the time of any expression. The surface has a boundary where
/// the box cuts it.
///
/// `u` and `v` are the position in the box, each from 0 to 1, along the two axes that follow the normal's main axis: x
/// and y for z, y and z for x, z and x for y. They are smooth wherever that axis does not change.
#[derive(Clone, Debug)]
pub struct Implicit {
    tape: Tape,
    bounds: Bounds,
    /// Bound on every coordinate.
    extent: f64,
    /// The measured surface, computed on first use.
    surface: OnceLock<Surface>,
    /// True if the surface is closed within the box, computed on first use.
    closed: OnceLock<bool>,
}

impl Implicit {
    /// Create the surface of an expression in Python's notation, in the box from `min` to `max`.
    ///
    /// The expression may use x, y, z, numbers, `+ - * / **`, parentheses, pi, e, abs, sqrt, exp, log, sin, cos, tan,
    /// asin, acos, atan, atan2, sinh, cosh, tanh, pow, min and max. A power other than an integer literal requires a
    /// nonnegative base.
    ///
    /// # Errors
    ///
    /// A one-line message if the expression does not parse or uses an unknown name (with the column), or if the box is
    /// not finite or has no volume.
    pub fn new(expression: &str, min: DVec3, max: DVec3) -> Result<Self, String> {
        let tape = parse::parse(expression).map_err(|e| format!("expression {expression:?}: {e}"))?;
        let extent = min.abs().max(max.abs()).max_element();
        let side = (max - min).min_element();
        if !(min.is_finite() && max.is_finite() && extent <= 1e150 && side > 1e-150) {
            return Err(format!(
                "min is {min} and max is {max}, expected finite numbers with min below max on each axis"
            ));
        }
        if side <= 64.0 * f64::EPSILON * extent {
            return Err(format!("min is {min} and max is {max}, expected a box wider than 64 ulps"));
        }
        Ok(Self { tape, bounds: Bounds { min, max }, extent, surface: OnceLock::new(), closed: OnceLock::new() })
    }

    /// The expression's value at a point; NaN if undefined.
    pub fn value(&self, at: DVec3) -> f64 {
        self.tape.value(&at.to_array(), &mut Vec::new())
    }

    /// An enclosure of the value at a point.
    fn enclosed(&self, at: DVec3) -> Interval {
        self.tape.value(&at.to_array().map(Interval::point), &mut Vec::new())
    }

    /// Integrate a function of the unit normal over the surface, with the accuracy of the area. The area under a linear
    /// map is the integral of |cofactor matrix · normal|.
    pub fn integral(&self, of: &(dyn Fn(DVec3) -> f64 + Sync)) -> f64 {
        self.surface().integral(self, of)
    }

    /// Shorter steps do not change the coordinates.
    fn shortest(&self) -> f64 {
        2.0 * f64::EPSILON * self.extent
    }

    /// First and second derivative along a direction.
    fn along(&self, at: DVec3, direction: DVec3) -> (f64, f64) {
        let line = std::array::from_fn(|i| Jet::new(at[i], direction[i]));
        let jet = self.tape.value(&line, &mut Vec::new());
        (jet.slope, jet.bend)
    }

    /// The gradient, and the unmixed second derivatives.
    fn gradient(&self, at: DVec3) -> (DVec3, DVec3) {
        let all = DVec3::AXES.map(|axis| self.along(at, axis));
        (DVec3::from_array(all.map(|d| d.0)), DVec3::from_array(all.map(|d| d.1)))
    }

    fn surface(&self) -> &Surface {
        self.surface.get_or_init(|| Surface::new(self))
    }

    /// The axis closest to a direction.
    fn main_axis(direction: DVec3) -> usize {
        let size = direction.abs();
        if size.z >= size.x && size.z >= size.y { 2 } else { usize::from(size.y >= size.x) }
    }

    fn uv(&self, at: DVec3, axis: usize) -> [f64; 2] {
        [(axis + 1) % 3, (axis + 2) % 3]
            .map(|k| ((at[k] - self.bounds.min[k]) / (self.bounds.max[k] - self.bounds.min[k])).clamp(0.0, 1.0))
    }

    /// The surface point near a position; `towards` replaces the normal where the gradient vanishes.
    fn point_near(&self, place: DVec3, towards: DVec3) -> Point {
        let mut position = place;
        // Two Newton steps along the gradient, while they decrease the value.
        for _ in 0..2 {
            let (gradient, _) = self.gradient(position);
            let next = position - gradient * (self.value(position) / gradient.length_squared());
            let near = (next - place).abs().max_element() <= 1e-6 * self.extent;
            if !(near && self.value(next).abs() < self.value(position).abs()) {
                break;
            }
            position = next.clamp(self.bounds.min, self.bounds.max);
        }
        let (gradient, pure) = self.gradient(position);
        let normal = gradient.try_normalize().or_else(|| towards.try_normalize()).unwrap_or(DVec3::Z);
        let axis = Self::main_axis(normal);
        let kept = [(axis + 1) % 3, (axis + 2) % 3];
        let size = self.bounds.max - self.bounds.min;
        let dp = kept.map(|k| {
            // Tangents of the surface as a graph over the two axes.
            let mut tangent = DVec3::AXES[k];
            tangent[axis] = -normal[k] / normal[axis];
            tangent * size[k]
        });
        // Mixed derivatives from second derivatives along diagonals.
        let mixed = |i: usize, j: usize| {
            let (_, bend) = self.along(position, DVec3::AXES[i] + DVec3::AXES[j]);
            0.5 * (bend - pure[i] - pure[j])
        };
        let (xy, yz, zx) = (mixed(0, 1), mixed(1, 2), mixed(2, 0));
        let length = gradient.length();
        let dn = dp.map(|way| {
            let change = DVec3::new(
                pure.x * way.x + xy * way.y + zx * way.z,
                xy * way.x + pure.y * way.y + yz * way.z,
                zx * way.x + yz * way.y + pure.z * way.z,
            );
            let turned = (change - normal * normal.dot(change)) / length;
            if turned.is_finite() { turned } else { DVec3::ZERO }
        });
        let off = self.enclosed(position).magnitude() / length;
        let room = 4.0 * UNIT * self.extent;
        Point {
            position,
            // The value's error to first order; without a gradient, the shortest bisection step.
            error: room + if off.is_finite() { 2.0 * off } else { self.shortest() },
            normal,
            uv: self.uv(position, axis),
            dp,
            dn,
        }
    }
}

impl Shape for Implicit {
    fn is_closed(&self) -> bool {
        *self.closed.get_or_init(|| closed::is_closed(&self.tape, &self.bounds))
    }

    fn closest(&self, place: DVec3) -> Option<Closest> {
        let own = closest::closest(self, &Affine::translation(DVec3::ZERO), place)?;
        Some(Closest { position: own, uv: self.uv(own, Self::main_axis(self.gradient(own).0)) })
    }

    fn closest_stretched(&self, to_world: &Affine, _: &Affine, place: DVec3) -> Option<Closest> {
        let own = closest::closest(self, to_world, place)?;
        let uv = self.uv(own, Self::main_axis(self.gradient(own).0));
        Some(Closest { position: to_world.point(own), uv })
    }

    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn meet(&self, ray: &Ray, met: &mut dyn FnMut(Candidate) -> bool) -> bool {
        let longest = ray.direction.abs().max_element();
        let finite = ray.origin.is_finite() && ray.direction.is_finite();
        if !(finite && longest >= f64::MIN_POSITIVE && ray.t_min <= ray.t_max) {
            return false;
        }
        let (scale, inverse) = normalising_scale(longest);
        let direction = ray.direction * scale;
        // Clip twice: near the box, then from there, so that the origin's distance costs no digits.
        let Some(far) = self.clip(ray.origin.to_array().map(Interval::point), direction) else { return false };
        let mut along = Along::new(&self.tape, moved(ray.origin, far.low, direction), direction);
        let Some(span) = self.clip([0, 1, 2].map(|k| along.origin(k)), direction) else { return false };
        let wanted = Interval::new(ray.t_min * inverse - far.low, ray.t_max * inverse - far.low);
        let room = 4.0 * UNIT * far.low.abs() + self.shortest();
        let wanted = Interval::new(wanted.low - room, wanted.high + room);
        let mut stopped = false;
        roots::roots(&mut along, span, wanted, self.shortest(), &mut |root| {
            let along = far.low + root.place;
            // A ray that starts on the surface to f64 precision hits it at 0.
            let start = along.abs() <= 2.0 * self.shortest() && self.enclosed(ray.origin).contains(0.0);
            let t = if start { 0.0 } else { along * scale };
            if t >= ray.t_min && t <= ray.t_max && t.is_finite() {
                let at = self.place(ray, t);
                let axis = Self::main_axis(self.gradient(at).0);
                stopped = met(Candidate { t, uv: self.uv(at, axis), contact: root.contact, inner: 0 });
            }
            stopped
        });
        stopped
    }

    fn point(&self, ray: &Ray, t: f64, _uv: [f64; 2]) -> Point {
        self.point_near(self.place(ray, t), -ray.direction)
    }

    /// Computed on first use; refined until two line grids agree to a thousandth, or to 256 lines per side.
    fn area_under(&self, map: &Affine) -> f64 {
        self.integral(&|n| map.cofactors(n).length())
    }

    fn area(&self) -> f64 {
        self.surface().area
    }

    /// By rejection, from random numbers that the two seed. Uniform by area, but nearby numbers do not give nearby
    /// points.
    fn sample(&self, u: [f64; 2]) -> Option<Drawn> {
        let surface = self.surface();
        let position = surface.sample(self, u)?;
        Some(Drawn { point: self.point_near(position, DVec3::Z), pdf: 1.0 / surface.area })
    }
}

impl Implicit {
    /// Clip a line to the box, enlarged by a few ulps.
    fn clip(&self, origin: [Interval; 3], direction: DVec3) -> Option<Interval> {
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for k in 0..3 {
            let (low, high) = (self.bounds.min[k] - origin[k].high, self.bounds.max[k] - origin[k].low);
            if direction[k] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = (low / direction[k], high / direction[k]);
            let (near, far) = if a < b { (a, b) } else { (b, a) };
            enter = enter.max(near - 4.0 * UNIT * near.abs());
            leave = leave.min(far + 4.0 * UNIT * far.abs());
        }
        (enter <= leave && enter.is_finite() && leave.is_finite()).then(|| Interval::new(enter, leave))
    }

    /// The ray's point at `t`, clamped to the box.
    fn place(&self, ray: &Ray, t: f64) -> DVec3 {
        let at = moved(ray.origin, t, ray.direction).map(|x| 0.5 * (x.low + x.high));
        DVec3::from_array(at).clamp(self.bounds.min, self.bounds.max)
    }
}
