//! A ray prepared for axis-aligned planes.

use crate::SlabRay;

/// The data for one axis.
#[derive(Clone, Copy, Debug)]
struct AxisPlane {
    inverse: f32,
    near: f32,
    far: f32,
    /// The near child: 0 below the plane, 1 above.
    first: u32,
}

/// By axis, so that the data for a plane are contiguous. The fourth is padding, which makes every two-bit axis valid.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct PlaneRay([AxisPlane; 4]);

/// The intervals of a ray on the two sides of a plane.
#[derive(Clone, Copy, Debug)]
pub struct SideIntervals {
    /// The near child, as 0 or 1.
    pub first: u32,
    /// The ray is not on the far side before this.
    pub from: f32,
    /// The ray is not on the near side after this.
    pub until: f32,
}

impl PlaneRay {
    /// Convert from a ray prepared for boxes.
    pub fn new(ray: &SlabRay) -> Self {
        let along = |axis: usize| AxisPlane {
            inverse: ray.inverse[axis],
            near: ray.near[axis],
            far: ray.far[axis],
            first: ray.first[axis] as u32,
        };
        Self([along(0), along(1), along(2), along(2)])
    }

    /// The earliest and the latest `t` of a plane.
    #[inline(always)]
    pub fn sides(&self, axis: usize, plane: f32) -> SideIntervals {
        let AxisPlane { inverse, near, far, first } = self.0[axis & 3];
        let t = plane * inverse;
        SideIntervals { first, from: t + near, until: t + far }
    }
}
