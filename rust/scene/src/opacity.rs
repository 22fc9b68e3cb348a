//! The opacity of a surface where a ray meets it.

use super::materials::Material;
use super::{Geometry, ShadingPoint, SurfacePoint};
use raywright_base::math::{Hit, Ray};

/// Returns the share of rays like this one that the surface stops where it is hit.
pub fn opacity_at(material: &dyn Material, geometry: &Geometry, ray: &Ray, hit: &Hit, surface: &SurfacePoint) -> f64 {
    if material.is_opaque() {
        return 1.0;
    }
    let here = ShadingPoint::new(geometry, ray, hit, *surface, material.needs(), 0.0).texture;
    material.opacity(&here).clamp(0.0, 1.0)
}
