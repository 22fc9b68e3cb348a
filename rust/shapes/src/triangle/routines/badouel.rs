//! Badouel, "An Efficient Ray-Polygon Intersection", in Graphics Gems (1990).
//!
//! First the intersection with the triangle's plane, then a 2D point-in-triangle test along the axes of its largest
//! projection. The point is rounded before it is compared with the edges, which is why this test is not watertight: two
//! triangles that share an edge each use a point of their own.

use super::{Routine, SingleRay, TriangleHit};
use raywright_base::math::Vec3;

/// Plane first, then the projected triangle.
pub struct Badouel;

/// The precomputed data of a triangle.
pub struct Shadow {
    /// The plane `normal · x + offset = 0`.
    normal: Vec3,
    offset: f32,
    /// The axes of the projection.
    axes: [usize; 2],
    /// The first corner, projected.
    a: [f32; 2],
    /// The edges from it, projected.
    ab: [f32; 2],
    ac: [f32; 2],
}

impl Routine for Badouel {
    const NAME: &'static str = "Badouel 1990";
    type Triangle = Shadow;
    type Ray = SingleRay;

    fn triangle([a, b, c]: [Vec3; 3]) -> Shadow {
        let normal = (b - a).cross(c - a);
        let size = normal.abs();
        let axes = if size.x >= size.y && size.x >= size.z {
            [1, 2]
        } else if size.y >= size.z {
            [0, 2]
        } else {
            [0, 1]
        };
        let shadow = |v: Vec3| axes.map(|axis| v[axis]);
        Shadow { normal, offset: -a.dot(normal), axes, a: shadow(a), ab: shadow(b - a), ac: shadow(c - a) }
    }

    fn ray(ray: SingleRay, _: [Vec3; 3]) -> SingleRay {
        ray
    }

    #[inline(always)]
    fn meet(ray: &SingleRay, triangle: &Shadow) -> Option<TriangleHit> {
        let Shadow { normal, offset, axes: [i, j], a, ab, ac } = *triangle;
        let across = normal.dot(ray.direction);
        if across == 0.0 {
            return None;
        }
        let t = -(offset + normal.dot(ray.origin)) / across;
        if t < 0.0 {
            return None;
        }
        // The point relative to the first corner is `alpha · ab + beta · ac`.
        let x = ray.origin[i] + ray.direction[i] * t - a[0];
        let y = ray.origin[j] + ray.direction[j] * t - a[1];
        let (alpha, beta);
        if ab[0] == 0.0 {
            beta = x / ac[0];
            if !(0.0..=1.0).contains(&beta) {
                return None;
            }
            alpha = (y - beta * ac[1]) / ab[1];
        } else {
            beta = (y * ab[0] - x * ab[1]) / (ac[1] * ab[0] - ac[0] * ab[1]);
            if !(0.0..=1.0).contains(&beta) {
                return None;
            }
            alpha = (x - beta * ac[0]) / ab[0];
        }
        if alpha >= 0.0 && alpha + beta <= 1.0 { TriangleHit::new(t, alpha, beta) } else { None }
    }
}
