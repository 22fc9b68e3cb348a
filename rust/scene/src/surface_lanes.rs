//! Surface points in structure-of-arrays form.

use super::SurfacePoint;
use raywright_base::math::{LANES, VectorLanes};

/// Surface points, one per lane.
#[derive(Clone, Debug)]
pub struct SurfaceLanes {
    pub(super) position: VectorLanes,
    pub(super) error: [f64; LANES],
    pub(super) normal: VectorLanes,
    pub(super) shading_normal: VectorLanes,
    pub(super) shape: [u32; LANES],
    pub(super) inner: [Option<u32>; LANES],
}

impl SurfaceLanes {
    /// Sixteen undefined points.
    pub const NONE: Self = Self {
        position: VectorLanes::ZERO,
        error: [0.0; LANES],
        normal: VectorLanes::ZERO,
        shading_normal: VectorLanes::ZERO,
        shape: [0; LANES],
        inner: [None; LANES],
    };

    /// The surface point of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> SurfacePoint {
        SurfacePoint {
            position: self.position.get(lane),
            error: self.error[lane],
            normal: self.normal.get(lane),
            shading_normal: self.shading_normal.get(lane),
            shape: self.shape[lane],
            inner: self.inner[lane],
        }
    }

    /// The points.
    pub fn position(&self) -> &VectorLanes {
        &self.position
    }

    /// Bounds on the errors of coordinates of the points.
    pub fn error(&self) -> &[f64; LANES] {
        &self.error
    }

    /// Unit normals as the winding gives them.
    pub fn normal(&self) -> &VectorLanes {
        &self.normal
    }

    /// Of which shape that of a lane is.
    #[inline(always)]
    pub fn shape(&self, lane: usize) -> u32 {
        self.shape[lane]
    }

    /// Sets the surface point of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, point: &SurfacePoint) {
        self.position.set(lane, point.position);
        self.error[lane] = point.error;
        self.normal.set(lane, point.normal);
        self.shading_normal.set(lane, point.shading_normal);
        self.shape[lane] = point.shape;
        self.inner[lane] = point.inner;
    }
}
