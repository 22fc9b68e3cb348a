//! Rays prepared for conservative f32 box tests, which never reject a true hit.
//!
//! Boxes are stored in *box units* ([`Region`]), rounded outward from f64 numbers that err by 2⁻⁵³ of themselves.
//!
//! The interval of `t` in which a ray is between two planes is `(plane − o) / d`, computed as `plane · r + s` with `r ≈
//! 1/d` and `s ≈ −o/d ∓ pad`, all in f32. With v = 2⁻²⁴, to first order and in units of |r|, this errs by 2v·|plane −
//! o| for r, the same in both terms; v·|plane| for the product (less if fused); v·|o| for rounding o, and as much again
//! for −o·r and for subtracting the pad; and v·(|plane| + |o|) for the sum. In all that is less than 6v·R, where R
//! ("reach") bounds |plane| + |o|. The pad is 8v·R. What remains, at least v·R since |r| > 1/2, covers the error of a
//! hit's own `t` ([`EdgeRay::T_ERROR`] is a quarter of v). Subtracting the center, moving a distant origin and rounding
//! `t`, all in f64, cost some fourteen 2⁻⁵³ of the distance, for which 2⁻⁴⁶ of it is added.
//!
//! A direction component of less than 2⁻⁶⁰ is replaced by ±2⁻⁶⁰. Within reach, that moves the ray by less than a
//! hundred-millionth of the pad, and it avoids infinity times zero.
//!
//! The bound for boxes along a tree's own axes ([`Axes`]). In f32 each coordinate of origin and direction along them
//! errs by v for its inputs, v for the axes, and 3v for products and sums of terms that add up to less than √3/2 of the
//! largest. That is 4.4v·|o|, and 4.4v times the direction's largest coordinate, along which the ray covers at most R.
//! That moves the ray by less than 8.8v·R. The slab test itself errs by 6v of less than √3/2·R, since all lengths are
//! halved there, and a hit's `t` by v/4 of R times a direction of less than √3. In all that is less than 14.5v·R, and
//! the pad is doubled.

use glam::Vec3A;
use raywright_base::math::robust::{greater, lesser};
use raywright_base::math::{Aabb, Axes, Ray, Region};
use raywright_base::simd::Lanes;
use raywright_shapes::triangle::{ALL, Column, EdgeRay, PlainRays, RAYS};

/// A ray prepared for slab tests.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay {
    /// The inverse of the direction, per axis.
    pub inverse: [f32; 3],
    /// The offset for the near plane, per axis.
    pub near: [f32; 3],
    /// The offset for the far plane, per axis.
    pub far: [f32; 3],
    /// The near plane, per axis: 0 the lower, 1 the upper.
    pub first: [usize; 3],
    /// The origin in box units, moved to the scene if that is distant.
    pub origin: [f32; 3],
    /// Distance from a box, in box units, within which the test may accept the ray.
    pub pad: f32,
    /// In box units.
    pub t_min: f32,
    /// Conversion of `t` along the scaled direction to box units.
    pub clock: Clock,
}

/// Conversion of `t` along a scaled direction to box units.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    to_box: f64,
    /// The distance by which the origin was moved, in box units.
    start: f64,
}

impl Clock {
    /// For rays whose origin was not moved.
    #[inline(always)]
    pub fn of(region: &Region) -> Self {
        Self { to_box: region.scale, start: 0.0 }
    }

    /// For a ray with the given [`Clock::start`].
    #[inline(always)]
    pub fn started(region: &Region, start: f64) -> Self {
        // A ray that hits every box has no limit.
        if start == f64::NEG_INFINITY { SlabRay::EVERYWHERE.clock } else { Self { to_box: region.scale, start } }
    }

    /// The distance by which the origin was moved, in box units; −∞ if the ray counts as hitting every box.
    #[inline(always)]
    pub fn start(self) -> f64 {
        if self.to_box == 0.0 { f64::NEG_INFINITY } else { self.start }
    }

    /// Convert `t` to box units, rounded up and never NaN: no box that starts beyond it can contain a closer hit.
    #[inline(always)]
    pub fn limit(self, t: f64) -> f32 {
        widened(greater(lesser(t, f64::MAX) * self.to_box - self.start, f64::from(f32::MIN)), ULPS)
    }
}

/// The pad over the reach.
const PAD: f64 = 1.0 / (1u64 << 21) as f64;

/// The additional pad over the distance.
const FAR_PAD: f64 = 1.0 / (1u64 << 46) as f64;

/// Radii beyond which the pad is many times the scene, and the offsets may soon overflow an f32.
const FARTHEST: f64 = (1u128 << 100) as f64;

/// The factor on the pad for trees with their own axes.
const TURNED: f64 = 2.0;

/// Minimum magnitude of a direction component.
const SMALLEST: f32 = 1.0 / (1u64 << 60) as f32;

/// Clamp every component to a magnitude of at least 2⁻⁶⁰.
#[inline(always)]
fn away_from_zero(d: Vec3A) -> Vec3A {
    let smallest = Vec3A::splat(SMALLEST);
    Vec3A::select(d.abs().cmplt(smallest), smallest.copysign(d), d)
}

/// Four times the error of rounding to f32.
const ULPS: f32 = 1.0 / (1u32 << 22) as f32;

/// Round to f32, strictly up or down by a small amount. Unlike exact outward rounding it needs no branch.
#[inline(always)]
fn widened(x: f64, by: f32) -> f32 {
    let x = x as f32;
    x + x.abs() * by
}

/// Convert `t_min` in box units, rounded down. Overflow is clamped to the greatest f32: infinity minus a part of it
/// would be NaN, which would affect other rays of a packet.
#[inline(always)]
fn earliest(t: f64) -> f32 {
    widened(lesser(t, f64::from(f32::MAX)), -ULPS)
}

impl SlabRay {
    /// A ray that hits every nonempty box, at any distance.
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

    /// Prepare a ray for boxes in box units, along a tree's own axes if given. None if it certainly misses the scene.
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
        // Four-lane vectors with an unused lane: an operation is one instruction instead of three.
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

    /// Convert `t` along its direction to box units, rounded up and never NaN: no box that starts beyond it can contain
    /// a closer hit.
    #[inline(always)]
    pub fn limit(&self, t: f64) -> f32 {
        self.clock.limit(t)
    }

    /// The interval in which the ray may be inside a box. None on a certain miss between `t_min` and `limit`; an empty
    /// box is never hit.
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

    /// Prepare a ray for a scene, for triangles and for boxes along a tree's own axes if given. None if it cannot hit
    /// anything or misses the scene.
    #[inline(always)]
    pub fn prepare(axes: Option<&Axes>, ray: &Ray, region: &Region) -> Option<(EdgeRay, Self)> {
        let edges = EdgeRay::new(ray, region)?;
        let slabs = Self::new(axes, &edges, region)?;
        Some((edges, slabs))
    }
}

/// Sixteen rays in SoA layout, prepared for box tests like [`SlabRay`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct SlabRays {
    /// The inverse of the directions, per axis.
    pub inverse: [Column<f32>; 3],
    /// The offset for the near plane, per axis.
    pub near: [Column<f32>; 3],
    /// The offset for the far plane, per axis.
    pub far: [Column<f32>; 3],
    /// Distance from a box, in box units, within which the test may accept the ray.
    pub pad: Column<f32>,
    /// In box units.
    pub t_min: Column<f32>,
    /// The end of each ray in box units.
    pub limit: Column<f32>,
    /// The origins along a tree's own axes, if any.
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

    /// Prepare rays for boxes, along a tree's own axes if given. The results of rays that are not plain are undefined.
    #[inline(always)]
    pub fn prepare<S: Lanes<RAYS>>(&mut self, simd: S, rays: &PlainRays, region: &Region, axes: Option<&Axes>) {
        // The reach of rays that are not distant is their largest coordinate.
        let per_reach = (PAD + FAR_PAD) * if axes.is_some() { TURNED } else { 1.0 };
        let pad = simd.mul(simd.load(&rays.largest), simd.splat(per_reach as f32));
        simd.store(pad, &mut self.pad);
        // As in `earliest` and `Clock::limit`.
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

    /// The rays that may hit a box between their `t_min` and a limit in box units.
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

    /// The near plane of a ray by axis: 0 the lower, 1 the upper.
    #[inline(always)]
    pub fn first(&self, i: usize) -> [usize; 3] {
        let i = i & (RAYS - 1);
        let [x, y, z] = &self.inverse;
        [usize::from(x[i] < 0.0), usize::from(y[i] < 0.0), usize::from(z[i] < 0.0)]
    }

    /// The mask of rays with these near planes.
    #[inline(always)]
    pub fn like<S: Lanes<RAYS>>(&self, simd: S, first: [usize; 3]) -> u32 {
        let mut like = ALL;
        for axis in 0..3 {
            let down = simd.gt(simd.splat(0.0), simd.load(&self.inverse[axis]));
            like &= if first[axis] == 1 { down } else { !down };
        }
        like
    }
}

/// Express sixteen vectors along a tree's own axes.
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

    /// The components of a direction along three axes; along one of them it is ±1.
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
            // Toward a point, nearly parallel to one of the boxes' axes.
            let own = axes.map_or([DVec3::X, DVec3::Y, DVec3::Z], |axes| {
                [0, 1, 2].map(|i| axes.single()[i].map(f64::from)).map(DVec3::from_array)
            });
            let direction = own[0] * parts[0] + own[1] * parts[1] + own[2] * parts[2];
            let ray = Ray::new(points[place] - direction * distance * size, direction);
            // A box of the target point alone, which rounding moves by less than is allowed for.
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
