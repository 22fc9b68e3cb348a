//! Points on surfaces.

use raywright_base::math::{DVec3, Ray};

/// A point on a surface, with the data that every shading step needs.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// The point, to within `error` in each coordinate.
    pub position: DVec3,
    /// Bound on the error of each coordinate of `position`.
    pub error: f64,
    /// Unit normal by the winding.
    pub normal: DVec3,
    /// Unit shading normal, on the same side as `normal`.
    pub shading_normal: DVec3,
    /// Shape number.
    pub shape: u32,
    /// For an instance of a prototype, the flattened primitive number in it ([`Prototype`](super::Prototype)).
    pub inner: Option<u32>,
}

impl SurfacePoint {
    /// Returns whether a ray hits it on the side of its normal.
    #[inline(always)]
    pub fn is_front(&self, ray: &Ray) -> bool {
        ray.direction.dot(self.normal) <= 0.0
    }
}
