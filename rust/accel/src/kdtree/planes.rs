//! A ray as planes across axes need it.

use crate::SlabRay;

/// Along an axis.
#[derive(Clone, Copy, Debug)]
struct Along {
    inverse: f32,
    near: f32,
    far: f32,
    /// The child that the ray comes to first: 0 the one below the plane, 1 the one above.
    first: u32,
}

/// By axis, so that what a plane needs lies together; the fourth is never used, and makes every axis that two bits can
/// say one.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct PlaneRay([Along; 4]);

/// What a ray meets of the two sides of a plane.
#[derive(Clone, Copy, Debug)]
pub struct Sides {
    /// The child that it comes to first, with its parent's first taken for 0.
    pub first: u32,
    /// The ray is not on the other side before.
    pub from: f32,
    /// It is not on this side after.
    pub until: f32,
}

impl PlaneRay {
    /// From a ray as boxes need it.
    pub fn new(ray: &SlabRay) -> Self {
        let along = |axis: usize| Along {
            inverse: ray.inverse[axis],
            near: ray.near[axis],
            far: ray.far[axis],
            first: ray.first[axis] as u32,
        };
        Self([along(0), along(1), along(2), along(2)])
    }

    /// Where it meets a plane: at the earliest, and at the latest.
    #[inline(always)]
    pub fn sides(&self, axis: usize, plane: f32) -> Sides {
        let Along { inverse, near, far, first } = self.0[axis & 3];
        let t = plane * inverse;
        Sides { first, from: t + near, until: t + far }
    }
}
