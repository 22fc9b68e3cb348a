//! Signed volumes: Amanatides and Choi, "Ray Tracing Triangular Meshes" (1997); Segura and Feito, "Algorithms to Test
//! Ray-Triangle Intersection. Comparative Study" (2001).
//!
//! With corners relative to the ray's origin, `d · (b × c)` is six times the volume of a tetrahedron between the ray
//! and the edge from b to c. Its sign says on which side of the edge the ray passes. In Plücker coordinates the same
//! number is the side product of two lines. The three volumes are also the weights of the corners, and with the volume
//! under the whole triangle, `a · (b × c)`, they give t.
//!
//! An edge shared by two triangles has the same volume in both, except for its sign, so shared edges are watertight.
//! Far from the origin b and c are nearly equal, and their cross product is mostly rounding error.

use super::{Routine, SingleRay, TriangleHit, relative, signs_differ};
use raywright_base::math::Vec3;

/// Signed volumes in f32.
pub struct SignedVolumes;

impl Routine for SignedVolumes {
    const NAME: &'static str = "signed volumes";
    type Triangle = [Vec3; 3];
    type Ray = SingleRay;

    fn triangle(corners: [Vec3; 3]) -> [Vec3; 3] {
        corners
    }

    fn ray(ray: SingleRay, _: [Vec3; 3]) -> SingleRay {
        ray
    }

    #[inline(always)]
    fn meet(ray: &SingleRay, corners: &[Vec3; 3]) -> Option<TriangleHit> {
        let [a, b, c] = relative(corners, ray.origin);
        let bc = b.cross(c);
        let of_a = ray.direction.dot(bc);
        let of_b = ray.direction.dot(c.cross(a));
        let of_c = ray.direction.dot(a.cross(b));
        if signs_differ(of_a, of_b, of_c) {
            return None;
        }
        let sum = of_a + of_b + of_c;
        if sum == 0.0 {
            return None;
        }
        let inverse = 1.0 / sum;
        TriangleHit::new(a.dot(bc) * inverse, of_b * inverse, of_c * inverse)
    }
}
