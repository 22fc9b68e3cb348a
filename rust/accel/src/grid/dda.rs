//! The 3D DDA (Amanatides and Woo 1987): step across the nearest of the next planes along the three axes.
//!
//! The `t` of a plane is computed from its index rather than accumulated, which would accumulate rounding errors. So it
//! has the same bits from either side.

use super::lattice::Lattice;
use crate::SlabRay;
use raywright_base::math::robust::{greater, lesser};

/// A ray in a cell of a lattice.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    /// The index of the cell.
    pub cell: usize,
    /// The `t` at which the ray enters it.
    pub enter: f32,
    /// The `t` at which the traversal ends.
    until: f32,
    /// The `t` of the next plane, by axis.
    next: [f32; 3],
    /// The index of that plane.
    plane: [f32; 3],
    /// The increment of the plane index.
    sign: [f32; 3],
    /// The increment of the cell index, in two's complement if negative.
    stride: [usize; 3],
    /// The `t` of a plane is its index times `step`, plus `start`.
    step: [f32; 3],
    start: [f32; 3],
}

impl Walk {
    /// Start where the ray enters the lattice, or at `from` if that is later. None if it leaves, or `until` is, before
    /// that.
    #[inline(always)]
    pub fn new(lattice: &Lattice, ray: &SlabRay, mut from: f32, mut until: f32) -> Option<Self> {
        let (mut step, mut start) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            // The middle between the padded `near` and `far`.
            let shift = 0.5 * (ray.near[axis] + ray.far[axis]);
            step[axis] = lattice.width[axis] * ray.inverse[axis];
            start[axis] = lattice.low[axis] * ray.inverse[axis] + shift;
            let ends = [start[axis], lattice.cells[axis] as f32 * step[axis] + start[axis]];
            from = greater(from, ends[ray.first[axis]]);
            until = lesser(until, ends[1 - ray.first[axis]]);
        }
        if from > until {
            return None;
        }
        let strides = lattice.strides();
        let (mut cell, mut next, mut plane) = (0, [0.0; 3], [0.0; 3]);
        let (mut sign, mut stride) = ([1.0; 3], strides);
        for axis in 0..3 {
            let met = |i: f32| i * step[axis] + start[axis];
            let last = (lattice.cells[axis] - 1) as f32;
            // Rounded down through an integer, since some processors have no rounding instruction.
            let mut i = lesser(greater((from - start[axis]) / step[axis], 0.0), last) as i32 as f32;
            // The estimate may be off; `met` decides which interval contains `from`.
            if ray.first[axis] == 0 {
                while i > 0.0 && met(i) > from {
                    i -= 1.0;
                }
                while i < last && met(i + 1.0) < from {
                    i += 1.0;
                }
                plane[axis] = i + 1.0;
            } else {
                while i < last && met(i + 1.0) > from {
                    i += 1.0;
                }
                while i > 0.0 && met(i) < from {
                    i -= 1.0;
                }
                plane[axis] = i;
                sign[axis] = -1.0;
                stride[axis] = strides[axis].wrapping_neg();
            }
            next[axis] = met(plane[axis]);
            cell += i as usize * strides[axis];
        }
        Some(Self { cell, enter: from, until, next, plane, sign, stride, step, start })
    }

    /// The `t` at which the ray leaves the cell.
    #[inline(always)]
    pub fn leave(&self) -> f32 {
        lesser(lesser(self.next[0], self.next[1]), self.next[2])
    }

    /// Step to the next cell. Return false if it begins beyond `limit` or outside the lattice.
    ///
    /// No outer plane is crossed: `until` is at most the `t` of the first one.
    #[inline(always)]
    pub fn step(&mut self, limit: f32) -> bool {
        let [x, y, z] = self.next;
        // The minimum without branches, which would often be mispredicted.
        let axis = if x <= y {
            if x <= z { 0 } else { 2 }
        } else if y <= z {
            1
        } else {
            2
        };
        let leave = self.next[axis];
        if leave >= lesser(limit, self.until) {
            return false;
        }
        self.enter = leave;
        self.cell = self.cell.wrapping_add(self.stride[axis]);
        self.plane[axis] += self.sign[axis];
        self.next[axis] = self.plane[axis] * self.step[axis] + self.start[axis];
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use raywright_base::math::{Aabb, DVec3, Ray, Region, Vec3};

    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![4 => -1.0..1.0f64, 2 => (-4i32..=4).prop_map(|x| f64::from(x) / 4.0), 1 => -7.9..7.9f64]
    }

    fn part() -> impl Strategy<Value = f64> {
        prop_oneof![4 => -1.0..1.0f64, 1 => Just(0.0), 1 => Just(-0.0), 1 => -1e-7..1e-7f64, 1 => -1e-30..1e-30f64]
    }

    fn vector(of: impl Strategy<Value = f64> + Clone) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(of).prop_map(DVec3::from_array)
    }

    proptest! {
        /// The claim of the module: at every t the ray is in the current cell, or at most PAD outside.
        #[test]
        fn the_ray_is_where_the_walk_is(
            origin in prop::array::uniform3(coordinate()).prop_map(DVec3::from_array),
            direction in vector(part().boxed()),
            cells in prop::array::uniform3(1u32..60),
        ) {
            let region = Region::new(DVec3::NEG_ONE, DVec3::ONE);
            let ray = Ray::new(origin, direction);
            let Some((edges, ray)) = SlabRay::prepare(None, &ray, &region) else { return Ok(()) };
            prop_assert!(crate::grid::can_step(&ray));
            let lattice = Lattice::around(&Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE }, cells);
            let inside = |cell: usize, t: f32| {
                let cell = lattice.cell(cell);
                let at = origin * region.scale + f64::from(t) * edges.direction;
                let widened = lattice.aabb(cell, cell);
                at.cmpge(widened.min.as_dvec3() - 1e-7).all() && at.cmple(widened.max.as_dvec3() + 1e-7).all()
            };
            let Some(mut walk) = Walk::new(&lattice, &ray, ray.t_min, f32::INFINITY) else { return Ok(()) };
            let (mut steps, most) = (0, cells.iter().sum::<u32>());
            loop {
                let (enter, leave) = (walk.enter, lesser(walk.leave(), walk.until));
                prop_assert!(enter <= leave);
                for t in [enter, 0.5 * (enter + leave), leave] {
                    prop_assert!(inside(walk.cell, t), "at {t} of {ray:?} not in {:?}", lattice.cell(walk.cell));
                }
                if !walk.step(f32::INFINITY) {
                    break;
                }
                prop_assert_eq!(walk.enter, leave);
                steps += 1;
                prop_assert!(steps < most);
            }
        }

        /// No point of a lattice's content is outside the traversed interval.
        #[test]
        fn nothing_is_met_before_the_walk_or_after(
            origin in prop::array::uniform3(coordinate()).prop_map(DVec3::from_array),
            target in vector((-1.0..=1.0f64).boxed()),
            cells in prop::array::uniform3(1u32..60),
        ) {
            let region = Region::new(DVec3::NEG_ONE, DVec3::ONE);
            let ray = Ray::new(origin, target - origin);
            let Some((edges, slabs)) = SlabRay::prepare(None, &ray, &region) else { return Ok(()) };
            let lattice = Lattice::around(&Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE }, cells);
            let t = slabs.limit(1.0 / edges.scale);
            let walk = Walk::new(&lattice, &slabs, slabs.t_min, f32::INFINITY);
            let mut walk = walk.expect("it is aimed at what is inside");
            prop_assert!(walk.enter <= t && t <= walk.until);
            while walk.step(t) {}
            let cell = lattice.cell(walk.cell);
            let widened = lattice.aabb(cell, cell);
            let at = target * region.scale;
            // `limit` is rounded up, by up to four f32 roundings.
            let slack = 16.0 * f64::from(f32::EPSILON);
            prop_assert!(at.cmpge(widened.min.as_dvec3() - slack).all(), "{at} before {widened:?}");
            prop_assert!(at.cmple(widened.max.as_dvec3() + slack).all(), "{at} beyond {widened:?}");
        }
    }
}
