//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (2013).
//!
//! The ray is sheared and scaled to be the z axis from the origin. An edge function is then a 2 × 2 determinant, and
//! reversing the edge negates it exactly, so shared edges are watertight. If an edge function is zero, all three are
//! recomputed in f64, which is exact for products of two f32.
//!
//! The shear rounds the corners. So the decision is exact for a slightly perturbed triangle: neighbors agree with each
//! other, but not with exact arithmetic on the given triangle.

use super::{Routine, SingleRay, TriangleHit, relative, signs_differ};
use raywright_base::math::Vec3;

/// Sheared to the ray, in f32, with a fallback to f64.
pub struct Woop;

/// A ray with the shear that makes it the z axis.
pub struct ShearedRay {
    origin: Vec3,
    /// The axis along which the direction is largest comes last; the others keep the winding.
    axes: [usize; 3],
    shear: Vec3,
}

impl Routine for Woop {
    const NAME: &'static str = "Woop, Benthin, Wald 2013";
    type Triangle = [Vec3; 3];
    type Ray = ShearedRay;

    fn triangle(corners: [Vec3; 3]) -> [Vec3; 3] {
        corners
    }

    fn ray(SingleRay { origin, direction: d }: SingleRay, _: [Vec3; 3]) -> ShearedRay {
        let size = d.abs();
        let kz = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (mut kx, mut ky) = ((kz + 1) % 3, (kz + 2) % 3);
        if d[kz] < 0.0 {
            (kx, ky) = (ky, kx);
        }
        ShearedRay { origin, axes: [kx, ky, kz], shear: Vec3::new(d[kx] / d[kz], d[ky] / d[kz], 1.0 / d[kz]) }
    }

    #[inline(always)]
    fn meet(ray: &ShearedRay, corners: &[Vec3; 3]) -> Option<TriangleHit> {
        let [kx, ky, kz] = ray.axes;
        let [a, b, c] = relative(corners, ray.origin);
        let (ax, ay) = (a[kx] - ray.shear.x * a[kz], a[ky] - ray.shear.y * a[kz]);
        let (bx, by) = (b[kx] - ray.shear.x * b[kz], b[ky] - ray.shear.y * b[kz]);
        let (cx, cy) = (c[kx] - ray.shear.x * c[kz], c[ky] - ray.shear.y * c[kz]);

        let mut u = cx * by - cy * bx;
        let mut v = ax * cy - ay * cx;
        let mut w = bx * ay - by * ax;
        if u == 0.0 || v == 0.0 || w == 0.0 {
            u = determinant(cx, by, cy, bx);
            v = determinant(ax, cy, ay, cx);
            w = determinant(bx, ay, by, ax);
        }
        if signs_differ(u, v, w) {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            return None;
        }
        let (az, bz, cz) = (ray.shear.z * a[kz], ray.shear.z * b[kz], ray.shear.z * c[kz]);
        let t = u * az + v * bz + w * cz;
        let inverse = 1.0 / sum;
        TriangleHit::new(t * inverse, v * inverse, w * inverse)
    }
}

/// `p · q − r · s` with exact products and one rounding of their difference, then one to f32.
#[inline(always)]
fn determinant(p: f32, q: f32, r: f32, s: f32) -> f32 {
    (f64::from(p) * f64::from(q) - f64::from(r) * f64::from(s)) as f32
}
