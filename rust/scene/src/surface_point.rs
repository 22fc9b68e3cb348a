//! Points of surfaces, and what is known of them.

use raywright_base::math::{DVec3, Ray};

/// What shading needs to know of a point on a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// The point, to within `error` in each coordinate.
    pub position: DVec3,
    /// Bound on the error of each coordinate of `position`.
    pub error: f64,
    /// Unit normal as the winding gives it.
    pub normal: DVec3,
    /// Unit shading normal, on the same side as `normal`.
    pub shading_normal: DVec3,
    /// Which shape.
    pub shape: u32,
    /// Of an instance of a prototype, which primitive in it, flattened ([`Prototype`](super::Prototype)).
    pub inner: Option<u32>,
}

impl SurfacePoint {
    /// Whether a ray meets it on the side that the normal points to.
    #[inline(always)]
    pub fn is_front(&self, ray: &Ray) -> bool {
        ray.direction.dot(self.normal) <= 0.0
    }
}
