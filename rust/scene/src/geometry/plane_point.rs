//! Points of planes in double-double arithmetic, from error-free sums.

use raywright_base::math::{DVec3, Ray, two_product, two_sum};

/// An unevaluated sum of two f64; the second is the rounding error of the first.
#[derive(Clone, Copy, Default)]
struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    #[inline]
    fn add(self, x: f64) -> Self {
        let (high, rest) = two_sum(self.high, x);
        Self { high, low: self.low + rest }
    }

    #[inline]
    fn add_product(self, x: f64, y: f64) -> Self {
        let (product, rest) = two_product(x, y);
        let sum = self.add(product);
        Self { low: sum.low + rest, ..sum }
    }
}

/// A point of a triangle's plane in double-double precision, and a normal of any length.
#[derive(Clone, Copy)]
pub struct PlanePoint {
    point: [Sum; 3],
    normal: DVec3,
}

impl PlanePoint {
    /// The point of a triangle with these barycentric coordinates of its second and third corner.
    pub fn of([a, b, c]: [DVec3; 3], [v, w]: [f64; 2]) -> Self {
        let point = [0, 1, 2].map(|i| {
            let ((e, e_low), (f, f_low)) = (two_sum(b[i], -a[i]), two_sum(c[i], -a[i]));
            let sum = Sum::default().add(a[i]).add_product(e, v).add_product(f, w);
            Sum { low: sum.low + (e_low * v + f_low * w), ..sum }
        });
        Self { point, normal: (b - a).cross(c - a) }
    }

    /// The point under a map, given with the inverse of its linear part.
    pub fn under(&self, linear: &[DVec3; 3], inverse: &[DVec3; 3], shift: DVec3) -> Self {
        let [x, y, z] = self.point;
        let point = [0, 1, 2].map(|i| {
            let row = linear[i];
            let sum = Sum::default().add(shift[i]).add_product(row.x, x.high).add_product(row.y, y.high);
            let sum = sum.add_product(row.z, z.high);
            Sum { low: sum.low + (row.x * x.low + row.y * y.low + row.z * z.low), ..sum }
        });
        let n = self.normal;
        Self { point, normal: inverse[0] * n.x + inverse[1] * n.y + inverse[2] * n.z }
    }

    /// Difference between the ray's `t` at the plane and `t`.
    pub fn beyond(&self, ray: &Ray, t: f64) -> f64 {
        let from = [0, 1, 2].map(|i| {
            let sum = self.point[i].add(-ray.origin[i]).add_product(-t, ray.direction[i]);
            sum.high + sum.low
        });
        self.normal.dot(DVec3::from_array(from)) / self.normal.dot(ray.direction)
    }
}
