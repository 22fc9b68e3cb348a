//! Volumes around points, which a ray that misses them misses for certain: spheres, turned boxes and k-slabs, beside
//! the axis-aligned boxes of `math/aabb.rs`.
//!
//! Each holds the points that it was made around, in exact arithmetic on its numbers, and its test of a ray never fails
//! where the ray meets any point inside: what rounding may have done is allowed for, with a bound derived in its file.

mod oriented_box;
mod polytope;
mod slabs;
mod sphere;
#[cfg(test)]
mod tests;

pub use oriented_box::OrientedBox;
pub use slabs::{SlabRay, Slabs};
pub use sphere::BoundingSphere;

use crate::math::robust::{UNIT, normalising_scale};
use crate::math::{DVec3, Ray};

/// A volume around points.
pub trait Volume: Sized {
    /// What a ray is made into before it is tested against many volumes.
    type Ready;

    /// A small volume around some finite points; None around none.
    fn around(points: &[DVec3]) -> Option<Self>;

    /// Makes a ray ready.
    fn ready(line: &Line) -> Self::Ready;

    /// Where a ray may enter the volume, in the ray's own `t` and not before its `t_min`: no point of the volume lies
    /// on it before, to within rounding. None where it certainly meets none from `t_min` to `t_max`.
    fn meets(&self, line: &Line, ready: &Self::Ready) -> Option<f64>;

    /// Whether a point is certainly or possibly inside.
    fn contains(&self, point: DVec3) -> bool;

    /// Half the surface, to which the chance that a random ray meets it is proportional.
    fn half_area(&self) -> f64;

    /// Its volume.
    fn volume(&self) -> f64;
}

/// A ray as volumes are tested with it: its direction scaled by a power of two so that the largest coordinate lies in
/// [1, 2).
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// As given.
    pub origin: DVec3,
    /// Scaled.
    pub direction: DVec3,
    /// Of the scaled direction.
    pub t_min: f64,
    /// Of the scaled direction.
    pub t_max: f64,
    /// `t` as given over `t` along the scaled direction.
    pub scale: f64,
}

impl Line {
    /// None where the ray can hit nothing: something is NaN or infinite, the direction is zero, or `t_min > t_max`.
    pub fn new(ray: &Ray) -> Option<Self> {
        let longest = ray.direction.abs().max_element();
        let finite = ray.origin.is_finite() && ray.direction.is_finite();
        if !(finite && longest >= f64::MIN_POSITIVE && ray.t_min <= ray.t_max) {
            return None;
        }
        let (scale, inverse) = normalising_scale(longest);
        let (t_min, t_max) = (ray.t_min * inverse, ray.t_max * inverse);
        Some(Self { origin: ray.origin, direction: ray.direction * scale, t_min, t_max, scale })
    }

    /// Where the part of the line from `enter` to `leave` begins to count, if it does.
    fn window(&self, enter: f64, leave: f64) -> Option<f64> {
        // What is NaN, as where something overflowed, rejects nothing.
        if enter > leave || enter > self.t_max || leave < self.t_min {
            return None;
        }
        Some(enter.max(self.t_min) * self.scale)
    }
}

/// A line's way through the space between two parallel planes.
#[derive(Clone, Copy, Debug)]
struct Across {
    /// The origin's height over the middle of everything, along the normal.
    height: f64,
    /// How it changes with `t`.
    rise: f64,
    /// What either may be off by.
    doubt: [f64; 2],
}

impl Across {
    /// With a normal of which the magnitudes of the coordinates add up to at most `sum`, for an origin relative to some
    /// centre.
    ///
    /// The relative origin errs by uM, M bounding its coordinates, each product by 2u of itself and each of the two
    /// sums by u of what the products may be: 5uM · sum, to first order. The rise errs by 4u · 2 · sum. 8uM · sum and
    /// 16u · sum are allowed.
    fn new(relative: DVec3, direction: DVec3, normal: DVec3, sum: f64) -> Self {
        let size = relative.abs().max_element();
        Self {
            height: normal.dot(relative),
            rise: normal.dot(direction),
            doubt: [8.0 * UNIT * size * sum, 16.0 * UNIT * sum],
        }
    }

    /// The part of the line that may be between heights `low` and `high`, if it is there at all for no larger |t| than
    /// `reach`.
    ///
    /// Where `height + t · rise = low` exactly, the quotient of the computed numbers is off by (doubt₀ + |t| doubt₁) /
    /// |rise|, and by 3u of itself.
    fn between(&self, low: f64, high: f64, reach: f64) -> (f64, f64) {
        let doubt = self.doubt[0] + reach * self.doubt[1];
        if self.rise.abs() <= self.doubt[1] {
            let room = doubt + reach * self.rise.abs();
            let apart = self.height - room > high || self.height + room < low;
            return if apart { (f64::INFINITY, f64::NEG_INFINITY) } else { (f64::NEG_INFINITY, f64::INFINITY) };
        }
        let inverse = 1.0 / self.rise;
        let (a, b) = ((low - self.height) * inverse, (high - self.height) * inverse);
        let (near, far) = if a < b { (a, b) } else { (b, a) };
        let room = doubt * inverse.abs();
        (near - room - 4.0 * UNIT * near.abs(), far + room + 4.0 * UNIT * far.abs())
    }
}
