//! The edge test in f32: as [`crate::triangle::EdgeRay`], with half the digits and no exact fallback.
//!
//! The doubled weight of a corner is `d · ((b − c) × (b + c))` with corners relative to the ray's origin. It is the
//! signed volume of [`super::volumes`], with less cancellation far from the origin. Reversing the edge negates it
//! exactly, too, so shared edges are watertight. t is the mean of the corners' depths along the direction's largest
//! axis with these weights.

use super::{Routine, SingleRay, TriangleHit, relative, signs_differ};
use raywright_base::math::Vec3;

/// The edge test in f32.
pub struct EdgeF32;

/// A ray with its largest axis.
pub struct AxisRay {
    origin: Vec3,
    direction: Vec3,
    axis: usize,
}

impl Routine for EdgeF32 {
    const NAME: &'static str = "edge form, f32";
    type Triangle = [Vec3; 3];
    type Ray = AxisRay;

    fn triangle(corners: [Vec3; 3]) -> [Vec3; 3] {
        corners
    }

    fn ray(SingleRay { origin, direction }: SingleRay, _: [Vec3; 3]) -> AxisRay {
        let size = direction.abs();
        let longest = size.max_element();
        let axis = if size.x == longest { 0 } else { 2 - usize::from(size.y == longest) };
        AxisRay { origin, direction, axis }
    }

    #[inline(always)]
    fn meet(ray: &AxisRay, corners: &[Vec3; 3]) -> Option<TriangleHit> {
        let [a, b, c] = relative(corners, ray.origin);
        let weight = |v: Vec3, w: Vec3| ray.direction.dot((v - w).cross(v + w));
        let (of_a, of_b, of_c) = (weight(b, c), weight(c, a), weight(a, b));
        if signs_differ(of_a, of_b, of_c) {
            return None;
        }
        let sum = of_a + of_b + of_c;
        if sum == 0.0 {
            return None;
        }
        let k = ray.axis;
        let t = (of_a * a[k] + of_b * b[k] + of_c * c[k]) / (sum * ray.direction[k]);
        TriangleHit::new(t, of_b / sum, of_c / sum)
    }
}
