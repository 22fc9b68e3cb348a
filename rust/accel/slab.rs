//! A ray made ready for box tests in f32 that never reject a true hit.
//!
//! Boxes are kept in *box units* ([`Region`]), rounded outwards from f64 numbers that err by 2⁻⁵³ of themselves.
//!
//! The interval of `t` in which a ray is between two planes is `(plane − o) / d`, computed as `plane · r + s` with
//! `r ≈ 1/d` and `s ≈ −o/d ∓ pad`, all in f32. With v = 2⁻²⁴, to first order and in units of |r|, this errs by
//! 2v·|plane − o| for r, the same in both terms; v·|plane| for the product (less if fused); v·|o| for rounding o, and
//! as much again for −o·r and for taking the pad off; and v·(|plane| + |o|) for the sum: in all by less than 6v·R,
//! where R ("reach") bounds |plane| + |o|. The pad is 8v·R; what is left, at least v·R since |r| > 1/2, covers the error
//! of a hit's own `t` ([`EdgeRay::T_ERROR`] is a quarter of v). Taking the centre off, moving a far origin up and
//! rounding `t`, all in f64, costs some fourteen 2⁻⁵³ of the distance, for which 2⁻⁴⁶ of it is added.
//!
//! A direction of less than 2⁻⁶⁰ along an axis counts as ±2⁻⁶⁰: within reach, that moves the ray by less than a
//! hundred-millionth of the pad, and no infinity times zero appears.

use crate::math::robust::lesser;
use crate::math::{Ray, Region};
use crate::shapes::triangle::EdgeRay;
use glam::Vec3A;

/// What slab tests of a ray need.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay {
    /// Per axis, the inverse of the direction.
    pub inverse: [f32; 3],
    /// Per axis, what is added for the plane that is met first.
    pub near: [f32; 3],
    /// Per axis, what is added for the plane that is met last.
    pub far: [f32; 3],
    /// Per axis, which plane is met first: 0 the lower, 1 the upper.
    pub first: [usize; 3],
    /// Where it starts, in box units: moved up to the scene if that is far.
    pub origin: [f32; 3],
    /// How far outside of a box it may pass, in box units, and still be said to meet it.
    pub pad: f32,
    /// In box units.
    pub t_min: f32,
    /// From `t` along the scaled direction to box units.
    to_box: f64,
    /// How far along the origin was moved, in box units.
    start: f64,
}

/// At least 2⁻⁶⁰ in magnitude, in every coordinate.
#[inline(always)]
fn away_from_zero(d: Vec3A) -> Vec3A {
    let smallest = Vec3A::splat(1.0 / (1u64 << 60) as f32);
    Vec3A::select(d.abs().cmplt(smallest), smallest.copysign(d), d)
}

/// Four times the error of rounding to f32.
const ULPS: f32 = 1.0 / (1u32 << 22) as f32;

/// Rounds to f32, a little up or down for certain; without a branch, unlike exact outward rounding.
#[inline(always)]
fn widened(x: f64, by: f32) -> f32 {
    let x = x as f32;
    x + x.abs() * by
}

impl SlabRay {
    /// Meets every box but an empty one, at any distance.
    const EVERYWHERE: Self = Self {
        inverse: [1.0; 3],
        near: [-1e38; 3],
        far: [1e38; 3],
        first: [0; 3],
        origin: [0.0; 3],
        pad: 1e38,
        t_min: -1e38,
        to_box: 0.0,
        start: 0.0,
    };

    /// Makes a ray ready for boxes in box units; none if it passes the scene by for certain.
    #[inline(always)]
    pub fn new(ray: &EdgeRay, region: &Region) -> Option<Self> {
        const PAD: f64 = 1.0 / (1u64 << 21) as f64;
        // So many radii away the pad is many times the scene, and what is added soon more than an f32 can hold.
        const FARTHEST: f64 = (1u128 << 100) as f64;
        const FAR_PAD: f64 = 1.0 / (1u64 << 46) as f64;

        let mut origin = ray.local * region.scale;
        let direction = ray.direction;
        let largest = ray.largest * region.scale;
        if largest > FARTHEST {
            return Some(Self::EVERYWHERE);
        }
        let mut start = 0.0;
        if ray.is_far {
            let radius = region.radius * region.scale;
            start = -origin.dot(direction) / direction.dot(direction);
            origin += start * direction;
            if origin.abs().max_element() > 2.0 * radius + FAR_PAD * largest {
                return None;
            }
        }
        let pad = (PAD * ray.reach * region.scale + FAR_PAD * largest) as f32;
        // Vectors of four, the last unused: an operation is one instruction, not three.
        let (origin, direction) = (origin.as_vec3a(), direction.as_vec3a());
        let inverse = away_from_zero(direction).recip();
        let (shift, room) = (-origin * inverse, pad * inverse.abs());
        Some(Self {
            inverse: inverse.to_array(),
            near: (shift - room).to_array(),
            far: (shift + room).to_array(),
            origin: origin.to_array(),
            pad,
            first: [usize::from(inverse.x < 0.0), usize::from(inverse.y < 0.0), usize::from(inverse.z < 0.0)],
            t_min: widened(ray.t_min * region.scale - start, -ULPS),
            to_box: region.scale,
            start,
        })
    }

    /// A `t` along the scaled direction in box units, rounded up: no box that starts beyond it can improve on it.
    #[inline(always)]
    pub fn limit(&self, t: f64) -> f32 {
        widened(lesser(t, f64::MAX) * self.to_box - self.start, ULPS)
    }

    /// Readies a ray for a scene: for triangles and for boxes. None if it cannot hit anything, or passes the
    /// scene by.
    #[inline(always)]
    pub fn prepare(ray: &Ray, region: &Region) -> Option<(EdgeRay, Self)> {
        let edges = EdgeRay::new(ray, region)?;
        let slabs = Self::new(&edges, region)?;
        Some((edges, slabs))
    }
}
