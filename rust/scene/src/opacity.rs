//! Opacity of a surface at a hit.

use super::materials::Material;
use super::{Geometry, ShadingPoint, SurfacePoint};
use raywright_base::math::{Hit, Ray};

/// Returns the probability that the surface stops a ray at a hit.
pub fn opacity_at(material: &dyn Material, geometry: &Geometry, ray: &Ray, hit: &Hit, surface: &SurfacePoint) -> f64 {
    if material.is_opaque() {
        return 1.0;
    }
    let here = ShadingPoint::new(geometry, ray, hit, *surface, material.needs(), 0.0).texture;
    material.opacity(&here).clamp(0.0, 1.0)
}
