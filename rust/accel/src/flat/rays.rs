//! Rays in box units and f32 for kernels over flat arrays.

use raywright_base::math::robust::{greater, lesser};
use raywright_base::math::{Ray, Region};
use raywright_shapes::triangle::EdgeRay;

/// A ray: origin, `t_min`, direction, `t_max`.
///
/// `t` is in box units along the direction, which is scaled so that its largest coordinate lies in [1, 2). A ray that
/// certainly misses has a `t_max` below its `t_min`. A ray unsuitable for f32 has a zero direction.
pub type FlatRay = [f32; 8];

/// A certain miss.
const PASSED: FlatRay = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, -1.0];

/// A ray for the CPU.
const OPEN: FlatRay = [0.0; 8];

/// Radii beyond which a ray's origin is moved in f64 to its closest point to the center, since errors grow with the
/// distance.
const FAR: f64 = 2.0;

/// Bound on the error of a move relative to the distance. Subtracting the center and adding a multiple of the direction
/// round by 2⁻⁵³ of the distance each.
const FAR_ERROR: f64 = 1.0 / (1u64 << 51) as f64;

/// Beyond this, in box units, a move errs by more than 2⁻²⁵, the most that kernels allow for.
const FARTHEST: f64 = (1u64 << 26) as f64;

/// Replaces larger numbers.
const FOREVER: f64 = (1u128 << 100) as f64;

/// Four times the error of rounding to f32.
const ULPS: f32 = 1.0 / (1u32 << 22) as f32;

/// Round to f32, strictly outward.
fn widened(t: f64, by: f32) -> f32 {
    let t = greater(lesser(t, FOREVER), -FOREVER) as f32;
    t + t.abs() * by
}

/// Prepare a ray for the flat arrays of a region.
///
/// The origin errs by less than 2⁻²⁴ of its own coordinates and 2⁻²⁵, the direction by 2⁻²⁴ of its coordinates and
/// 2⁻¹⁴⁹. `t_min` is rounded down, and `t_max` up, by 2⁻²¹ of themselves at most.
#[inline]
pub fn flat_ray(ray: &Ray, region: &Region) -> FlatRay {
    let Some(edges) = EdgeRay::new(ray, region) else { return PASSED };
    let largest = edges.largest * region.scale;
    // Also unsuitable if t along a short direction may overflow an f64.
    let told = edges.largest * edges.scale * 8.0;
    if largest.is_nan() || largest > FARTHEST || !told.is_finite() {
        return OPEN;
    }
    let (mut origin, direction) = (edges.local * region.scale, edges.direction);
    let radius = region.radius * region.scale;
    let mut start = 0.0;
    if origin.abs().max_element() > FAR * radius {
        start = -origin.dot(direction) / direction.dot(direction);
        origin += start * direction;
        // Points inside the scene's box are within √3 radii.
        if origin.abs().max_element() > 2.0 * radius + FAR_ERROR * largest {
            return PASSED;
        }
    }
    let (o, d) = (origin.as_vec3(), direction.as_vec3());
    let near = widened(edges.t_min * region.scale - start, -ULPS);
    let far = widened(edges.t_max * region.scale - start, ULPS);
    [o.x, o.y, o.z, near, d.x, d.y, d.z, far]
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::math::DVec3;

    #[test]
    fn rays_are_moved_up_to_what_they_may_hit() {
        let region = Region::new(DVec3::splat(999.0), DVec3::splat(1001.0));
        let (radius, scale) = (region.radius, region.scale);
        assert!(radius * scale >= 1.0 && radius * scale < 2.0);
        let aim = DVec3::new(1000.5, 1000.25, 999.5);
        for (distance, length) in [(1.0, 1.0), (100.0, 3.0), (1e6, 1e-20)] {
            let way = DVec3::new(0.3, -1.0, 0.4);
            let ray = Ray { t_max: 2.0 * distance / length, ..Ray::new(aim - distance * way, way * length) };
            let [x, y, z, near, dx, dy, dz, far] = flat_ray(&ray, &region).map(f64::from);
            let (o, d) = (DVec3::new(x, y, z), DVec3::new(dx, dy, dz));
            assert!(o.abs().max_element() <= 2.0 * FAR * radius * scale);
            assert!((1.0..2.0).contains(&d.abs().max_element()));
            // The target point is on the ray, between both ends.
            let aim = region.to_box(aim);
            let t = (aim - o).dot(d) / d.dot(d);
            assert!((o + t * d - aim).length() < 1e-6, "{}", (o + t * d - aim).length());
            assert!(near <= t && t <= far);
        }
        let passes = Ray::new(DVec3::new(0.0, 0.0, 0.0), DVec3::X);
        let nothing = Ray { t_max: -1.0, ..Ray::new(aim, DVec3::X) };
        for ray in [passes, nothing, Ray::new(DVec3::NAN, DVec3::X)] {
            assert_eq!(flat_ray(&ray, &region), PASSED);
        }
        assert_eq!(flat_ray(&Ray::new(DVec3::splat(-1e9), DVec3::ONE), &region), OPEN);
    }
}
