//! The library's own edge test: in f64 with an error bound, and exact where the bound leaves a sign open.
//!
//! [`EdgeRay`] has the formulas and the proof. Corners are stored in f32 and widened for the test.

use super::{Routine, SingleRay, TriangleHit};
use crate::triangle::EdgeRay;
use raywright_base::math::{Ray, Region, Vec3};

/// The edge test in f64, exact in case of doubt.
pub struct EdgeF64;

impl Routine for EdgeF64 {
    const NAME: &'static str = "edge form, f64, exact";
    type Triangle = [Vec3; 3];
    /// None for a ray that cannot hit anything.
    type Ray = Option<EdgeRay>;

    fn triangle(corners: [Vec3; 3]) -> [Vec3; 3] {
        corners
    }

    fn ray(ray: SingleRay, corners: [Vec3; 3]) -> Option<EdgeRay> {
        let region = Region::around(corners.map(|c| c.as_dvec3()));
        EdgeRay::new(&Ray::new(ray.origin.as_dvec3(), ray.direction.as_dvec3()), &region)
    }

    #[inline(always)]
    fn meet(ray: &Option<EdgeRay>, corners: &[Vec3; 3]) -> Option<TriangleHit> {
        let ray = ray.as_ref()?;
        let found = ray.meet(corners.map(|c| c.as_dvec3()))?;
        Some(TriangleHit { t: found.t * ray.scale, u: found.uv[0], v: found.uv[1] })
    }
}
