//! Möller and Trumbore, "Fast, Minimum Storage Ray-Triangle Intersection" (1997).
//!
//! `origin + t · direction = a + u · (b − a) + v · (c − a)` is three linear equations in t, u and v; Cramer's rule
//! solves them with two cross products. The triangle's plane is never needed, and a miss is often detected after the
//! first weight.
//!
//! The paper also rejects every determinant below 10⁻⁶, and with it every triangle of a small scene; here only zero is
//! rejected.

use super::{Routine, SingleRay, TriangleHit};
use raywright_base::math::Vec3;

/// With the corners as given.
pub struct MollerTrumbore;

/// With precomputed edges: the same storage and the same results.
pub struct MollerTrumboreEdges;

/// One corner and its two edges.
pub struct CornerEdges {
    a: Vec3,
    ab: Vec3,
    ac: Vec3,
}

impl CornerEdges {
    #[inline(always)]
    fn new([a, b, c]: [Vec3; 3]) -> Self {
        Self { a, ab: b - a, ac: c - a }
    }

    #[inline(always)]
    fn meet(&self, ray: &SingleRay) -> Option<TriangleHit> {
        let p = ray.direction.cross(self.ac);
        let determinant = self.ab.dot(p);
        if determinant == 0.0 {
            return None;
        }
        let inverse = 1.0 / determinant;
        let s = ray.origin - self.a;
        let u = s.dot(p) * inverse;
        if !(0.0..=1.0).contains(&u) {
            return None;
        }
        let q = s.cross(self.ab);
        let v = ray.direction.dot(q) * inverse;
        if v >= 0.0 && u + v <= 1.0 { TriangleHit::new(self.ac.dot(q) * inverse, u, v) } else { None }
    }
}

impl Routine for MollerTrumbore {
    const NAME: &'static str = "Möller, Trumbore 1997";
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
        CornerEdges::new(*corners).meet(ray)
    }
}

impl Routine for MollerTrumboreEdges {
    const NAME: &'static str = "the same, edges stored";
    type Triangle = CornerEdges;
    type Ray = SingleRay;

    fn triangle(corners: [Vec3; 3]) -> CornerEdges {
        CornerEdges::new(corners)
    }

    fn ray(ray: SingleRay, _: [Vec3; 3]) -> SingleRay {
        ray
    }

    #[inline(always)]
    fn meet(ray: &SingleRay, edges: &CornerEdges) -> Option<TriangleHit> {
        edges.meet(ray)
    }
}
