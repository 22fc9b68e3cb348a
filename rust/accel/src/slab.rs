//! A ray made ready for box tests in f32 that never reject a true hit.
//!
//! Boxes are kept in *box units* ([`Region`]), rounded outwards from f64 numbers that err by 2⁻⁵³ of themselves.
//!
//! The interval of `t` in which a ray is between two planes is `(plane − o) / d`, computed as `plane · r + s` with
//! `r ≈ 1/d` and `s ≈ −o/d ∓ pad`, all in f32. With v = 2⁻²⁴, to first order and in units of |r|, this errs by
//! 2v·|plane − o| for r, the same in both terms; v·|plane| for the product (less if fused); v·|o| for rounding o, and
//! as much again for −o·r and for taking the pad off; and v·(|plane| + |o|) for the sum: in all by less than 6v·R,
//! where R ("reach") bounds |plane| + |o|. The pad is 8v·R; what is left, at least v·R since |r| > 1/2, covers the
//! error of a hit's own `t` ([`EdgeRay::T_ERROR`] is a quarter of v). Taking the centre off, moving a far origin up and
//! rounding `t`, all in f64, costs some fourteen 2⁻⁵³ of the distance, for which 2⁻⁴⁶ of it is added.
//!
//! A direction of less than 2⁻⁶⁰ along an axis counts as ±2⁻⁶⁰: within reach, that moves the ray by less than a
//! hundred-millionth of the pad, and no infinity times zero appears.
//!
//! Where boxes lie along axes of a tree's own ([`Axes`]), in f32 each coordinate of the origin and of the direction
//! along these errs by v for what it is made of, v for the axes, and 3v for products and sums, of what adds up to less
//! than √3/2 of the largest: by 4.4v·|o|, and 4.4v times the direction's largest, on which the ray goes no farther than
//! R. That moves the ray by less than 8.8v·R. The slab test itself errs by 6v of less than √3/2·R, since all is half as
//! long there, and a hit's `t` by v/4 of R times a direction of less than √3. In all that is less than 14.5v·R, and the
//! pad is twice what it is otherwise.

use glam::Vec3A;
use raywright_base::math::robust::{greater, lesser};
use raywright_base::math::{Aabb, Axes, Ray, Region};
use raywright_base::simd::Lanes;
use raywright_shapes::triangle::{ALL, Column, EdgeRay, PlainRays, RAYS};

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
    pub clock: Clock,
}

/// From `t` along a scaled direction to box units.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    to_box: f64,
    /// How far along the origin was moved, in box units.
    start: f64,
}

impl Clock {
    /// Of rays that start where they start.
    #[inline(always)]
    pub fn of(region: &Region) -> Self {
        Self { to_box: region.scale, start: 0.0 }
    }

    /// Of a ray of which [`Clock::start`] is this.
    #[inline(always)]
    pub fn started(region: &Region, start: f64) -> Self {
        // What meets every box never loses interest.
        if start == f64::NEG_INFINITY { SlabRay::EVERYWHERE.clock } else { Self { to_box: region.scale, start } }
    }

    /// How far along the origin was moved, in box units; −∞ where the ray is said to meet every box.
    #[inline(always)]
    pub fn start(self) -> f64 {
        if self.to_box == 0.0 { f64::NEG_INFINITY } else { self.start }
    }

    /// A `t` in box units, rounded up, and never NaN: no box that starts beyond it can improve on it.
    #[inline(always)]
    pub fn limit(self, t: f64) -> f32 {
        widened(greater(lesser(t, f64::MAX) * self.to_box - self.start, f64::from(f32::MIN)), ULPS)
    }
}

/// The pad over the reach.
const PAD: f64 = 1.0 / (1u64 << 21) as f64;

/// What is added to it over the distance.
const FAR_PAD: f64 = 1.0 / (1u64 << 46) as f64;

/// So many radii away the pad is many times the scene, and what is added soon more than an f32 can hold.
const FARTHEST: f64 = (1u128 << 100) as f64;

/// How many times as much it is, and what is added to it, along axes of a tree's own.
const TURNED: f64 = 2.0;

/// What a direction counts as along an axis at least.
const SMALLEST: f32 = 1.0 / (1u64 << 60) as f32;

/// At least 2⁻⁶⁰ in magnitude, in every coordinate.
#[inline(always)]
fn away_from_zero(d: Vec3A) -> Vec3A {
    let smallest = Vec3A::splat(SMALLEST);
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

/// A `t_min` in box units, rounded down. One that no f32 can hold counts as the greatest: infinity less a part of it
/// would be NaN, which in a packet is the neighbours' affair as well.
#[inline(always)]
fn earliest(t: f64) -> f32 {
    widened(lesser(t, f64::from(f32::MAX)), -ULPS)
}

impl SlabRay {
    /// Meets every box but an empty one, at any distance.
    pub const EVERYWHERE: Self = Self {
        inverse: [1.0; 3],
        near: [-1e38; 3],
        far: [1e38; 3],
        first: [0; 3],
        origin: [0.0; 3],
        pad: 1e38,
        t_min: -1e38,
        clock: Clock { to_box: 0.0, start: 0.0 },
    };

    /// Makes a ray ready for boxes in box units, which lie along axes of a tree's own if there are any; none if it
    /// passes the scene by for certain.
    #[inline(always)]
    pub fn new(axes: Option<&Axes>, ray: &EdgeRay, region: &Region) -> Option<Self> {
        let mut origin = ray.local * region.scale;
        let mut direction = ray.direction;
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
        let mut pad = PAD * ray.reach * region.scale + FAR_PAD * largest;
        if let Some(axes) = axes {
            (origin, direction, pad) = (axes.to(origin), axes.to(direction), TURNED * pad);
        }
        let pad = pad as f32;
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
            t_min: earliest(ray.t_min * region.scale - start),
            clock: Clock { to_box: region.scale, start },
        })
    }

    /// A `t` along its direction in box units, rounded up, and never NaN: no box that starts beyond it can improve on
    /// it.
    #[inline(always)]
    pub fn limit(&self, t: f64) -> f32 {
        self.clock.limit(t)
    }

    /// Of a box, where the ray may enter it and where it may leave it. None if it does neither for certain between its
    /// `t_min` and `limit`; an empty box is never met.
    #[inline(always)]
    pub fn passes(&self, aabb: &Aabb, limit: f32) -> Option<(f32, f32)> {
        let planes = [aabb.min.to_array(), aabb.max.to_array()];
        let (mut enter, mut leave) = (self.t_min, limit);
        for axis in 0..3 {
            let first = self.first[axis];
            enter = greater(enter, planes[first][axis] * self.inverse[axis] + self.near[axis]);
            leave = lesser(leave, planes[1 - first][axis] * self.inverse[axis] + self.far[axis]);
        }
        (enter <= leave).then_some((enter, leave))
    }

    /// Readies a ray for a scene: for triangles, and for boxes, which lie along axes of a tree's own if there are any.
    /// None if it cannot hit anything, or passes the scene by.
    #[inline(always)]
    pub fn prepare(axes: Option<&Axes>, ray: &Ray, region: &Region) -> Option<(EdgeRay, Self)> {
        let edges = EdgeRay::new(ray, region)?;
        let slabs = Self::new(axes, &edges, region)?;
        Some((edges, slabs))
    }
}

/// Sixteen rays by columns, made ready for box tests as [`SlabRay`] does one.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct SlabRays {
    /// Per axis, the inverse of the direction.
    pub inverse: [Column<f32>; 3],
    /// Per axis, what is added for the plane that is met first.
    pub near: [Column<f32>; 3],
    /// Per axis, what is added for the plane that is met last.
    pub far: [Column<f32>; 3],
    /// How far outside of a box they may pass, in box units, and still be said to meet it.
    pub pad: Column<f32>,
    /// In box units.
    pub t_min: Column<f32>,
    /// Where in box units each loses interest.
    pub limit: Column<f32>,
    /// Where they start along axes of a tree's own, if it has any.
    pub turned: Option<[Column<f32>; 3]>,
}

impl SlabRays {
    /// No rays.
    pub const NONE: Self = Self {
        inverse: [[0.0; RAYS]; 3],
        near: [[0.0; RAYS]; 3],
        far: [[0.0; RAYS]; 3],
        pad: [0.0; RAYS],
        t_min: [0.0; RAYS],
        limit: [0.0; RAYS],
        turned: None,
    };

    /// Makes rays ready for boxes, which lie along axes of a tree's own if there are any; of rays that are not plain
    /// nothing is said.
    #[inline(always)]
    pub fn prepare<S: Lanes<RAYS>>(&mut self, simd: S, rays: &PlainRays, region: &Region, axes: Option<&Axes>) {
        // Rays that are not far have their largest coordinate for reach.
        let per_reach = (PAD + FAR_PAD) * if axes.is_some() { TURNED } else { 1.0 };
        let pad = simd.mul(simd.load(&rays.largest), simd.splat(per_reach as f32));
        simd.store(pad, &mut self.pad);
        // As `earliest` and `Clock::limit` have it.
        let (to_box, most) = (simd.splat(region.scale as f32), simd.splat(f32::MAX));
        let t_min = simd.min(simd.mul(simd.load(&rays.t_min), to_box), most);
        let t_min = simd.sub(t_min, simd.mul(simd.abs(t_min), simd.splat(ULPS)));
        simd.store(t_min, &mut self.t_min);
        let limit = simd.max(simd.mul(simd.load(&rays.t_max), to_box), simd.neg(most));
        let limit = simd.add(limit, simd.mul(simd.abs(limit), simd.splat(ULPS)));
        simd.store(limit, &mut self.limit);
        if let Some(axes) = axes {
            let origin = turn(simd, axes, &rays.local);
            self.slabs(simd, &origin, &turn(simd, axes, &rays.direction), pad);
            self.turned = Some(origin);
        } else {
            self.slabs(simd, &rays.local, &rays.direction, pad);
            self.turned = None;
        }
    }

    #[inline(always)]
    fn slabs<S: Lanes<RAYS>>(&mut self, simd: S, origin: &[Column<f32>; 3], direction: &[Column<f32>; 3], pad: S::F32) {
        let smallest = simd.splat(SMALLEST);
        for axis in 0..3 {
            let d = simd.load(&direction[axis]);
            let away = simd.select(simd.gt(simd.splat(0.0), d), simd.neg(smallest), smallest);
            let d = simd.select(simd.gt(smallest, simd.abs(d)), away, d);
            let inverse = simd.div(simd.splat(1.0), d);
            let shift = simd.neg(simd.mul(simd.load(&origin[axis]), inverse));
            let room = simd.mul(pad, simd.abs(inverse));
            simd.store(inverse, &mut self.inverse[axis]);
            simd.store(simd.sub(shift, room), &mut self.near[axis]);
            simd.store(simd.add(shift, room), &mut self.far[axis]);
        }
    }

    /// Rays that may meet a box, at any `t` from their `t_min` on up to a limit in box units.
    #[inline(always)]
    pub fn meeting<S: Lanes<RAYS>>(&self, simd: S, aabb: &Aabb, limit: S::F32) -> u32 {
        let (min, max) = (aabb.min.to_array(), aabb.max.to_array());
        let (mut nears, mut fars) = (simd.load(&self.t_min), limit);
        for axis in 0..3 {
            let inverse = simd.load(&self.inverse[axis]);
            let (lower, upper) = (simd.splat(min[axis]), simd.splat(max[axis]));
            let down = simd.gt(simd.splat(0.0), inverse);
            let (first, last) = (simd.select(down, upper, lower), simd.select(down, lower, upper));
            nears = simd.max(nears, simd.mul_add(first, inverse, simd.load(&self.near[axis])));
            fars = simd.min(fars, simd.mul_add(last, inverse, simd.load(&self.far[axis])));
        }
        simd.le(nears, fars)
    }

    /// Which plane is met first by axis (0 the lower, 1 the upper), if it is the same for all rays.
    #[inline(always)]
    pub fn first<S: Lanes<RAYS>>(&self, simd: S) -> Option<[usize; 3]> {
        let mut first = [0; 3];
        for axis in 0..3 {
            first[axis] = match simd.gt(simd.splat(0.0), simd.load(&self.inverse[axis])) {
                0 => 0,
                ALL => 1,
                _ => return None,
            };
        }
        Some(first)
    }
}

/// Sixteen vectors along axes of a tree's own.
#[inline(always)]
fn turn<S: Lanes<RAYS>>(simd: S, axes: &Axes, vectors: &[Column<f32>; 3]) -> [Column<f32>; 3] {
    let [x, y, z] = [simd.load(&vectors[0]), simd.load(&vectors[1]), simd.load(&vectors[2])];
    let mut turned = [[0.0; RAYS]; 3];
    for (column, axis) in turned.iter_mut().zip(axes.single()) {
        let [a, b, c] = [simd.splat(axis[0]), simd.splat(axis[1]), simd.splat(axis[2])];
        simd.store(simd.mul_add(c, z, simd.mul_add(b, y, simd.mul(a, x))), column);
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::math::{DVec3, RayBatch};
    use raywright_base::simd::Scalar;

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array)
    }

    /// How much of a direction is along each of three axes: all along one of them.
    fn parts() -> impl Strategy<Value = [f64; 3]> {
        let part = prop_oneof![Just(0.0), -1.0..1.0f64, -1e-7..1e-7f64, -1e-4..1e-4f64];
        (prop::array::uniform3(part), 0..3usize, any::<bool>()).prop_map(|(mut parts, main, down)| {
            parts[main] = if down { -1.0 } else { 1.0 };
            parts
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        #[test]
        fn no_box_with_a_hit_is_passed_by_along_any_axes(
            along in vector(), beside in vector(), turned in any::<bool>(), corners in prop::array::uniform4(vector()),
            parts in parts(), place in 0..4usize, distance in prop_oneof![Just(1.0), Just(1e-3), Just(15.0), Just(1e5)],
            size in prop_oneof![Just(1.0), Just(3e-12), Just(7e9)], shift in prop_oneof![Just(0.0), Just(50.0)],
        ) {
            let axes = Axes::new(along, beside);
            prop_assume!(along.cross(beside).length() > 1e-3);
            let axes = axes.filter(|_| turned);
            let points = corners.map(|c| (c + DVec3::splat(shift)) * size);
            let region = Region::around(points);
            // Towards a point, nearly along what boxes lie along.
            let own = axes.map_or([DVec3::X, DVec3::Y, DVec3::Z], |axes| {
                [0, 1, 2].map(|i| axes.single()[i].map(f64::from)).map(DVec3::from_array)
            });
            let direction = own[0] * parts[0] + own[1] * parts[1] + own[2] * parts[2];
            let ray = Ray::new(points[place] - direction * distance * size, direction);
            // Nothing but the point where the ray is after so long, which rounding moves by less than is allowed for.
            let bounds = region.aabb_along(axes.as_ref(), [points[place]; 3]);
            let Some((_, slabs)) = SlabRay::prepare(axes.as_ref(), &ray, &region) else {
                return Err(TestCaseError::fail("it meets the scene"));
            };
            prop_assert!(slabs.passes(&bounds, f32::INFINITY).is_some(), "{:?}", slabs);
            let (mut plain, mut sixteen) = (PlainRays::NONE, SlabRays::NONE);
            plain.take(Scalar, &RayBatch::Rows(&[ray]), 0, &region);
            if plain.plain == ALL {
                sixteen.prepare(Scalar, &plain, &region, axes.as_ref());
                prop_assert_eq!(sixteen.meeting(Scalar, &bounds, [f32::INFINITY; RAYS]), ALL);
            } else {
                prop_assert!(distance > 2.0);
            }
        }
    }
}
