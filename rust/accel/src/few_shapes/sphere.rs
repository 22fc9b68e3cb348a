//! Spheres, tested against sixteen rays in f32.

use super::{Best, Rays, accept, unit};
use raywright_base::math::single::{choose, greater, mask};
use raywright_base::math::{DVec3, LANES, Ray};

/// A sphere of few shapes.
#[derive(Clone, Debug)]
pub(super) struct Sphere {
    pub primitive: u32,
    center: [f32; 3],
    radius: f32,
    /// Its part of all error bounds.
    unit: f32,
    /// In f64.
    exact: (DVec3, f64),
}

impl Sphere {
    pub fn new(primitive: u32, center: DVec3, radius: f64) -> Self {
        let unit = unit((center.abs().max_element() + radius) as f32);
        Self { primitive, center: center.as_vec3().to_array(), radius: radius as f32, unit, exact: (center, radius) }
    }

    /// Tests the sphere, whose number among all shapes is `index`. With `ANY`, every hit is noted as shape 0.
    ///
    /// Let w be the vector from the center to the origin, b = w·d, and p = w − b d, whose length is the distance of
    /// the line from the center. With ε and S as in [`super::test`], the coordinates of w err by 4εS and b by 14εS. As
    /// d has length 1 to within 4ε, p errs by less than 48εS in all. So a line with |p| < r − 64εS meets the sphere, at
    /// −b ± s with s² = (r − |p|)(r + |p|). As s² errs by 64εS(2r), s errs by 64εS(2r/s), and −b and the sum by 32εS
    /// more.
    ///
    /// A ray that leaves the sphere starts at one of the two, up to rounding: the other is at −2b.
    #[inline(always)]
    pub fn test<const ANY: bool>(&self, index: u32, rays: &Rays, best: &mut Best) {
        let (mut t, mut error, mut off) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let ([ox, oy, oz], [dx, dy, dz]) = (&rays.origin, &rays.direction);
        for i in 0..LANES {
            let (x, y, z) = (ox[i] - self.center[0], oy[i] - self.center[1], oz[i] - self.center[2]);
            let (dx, dy, dz) = (dx[i], dy[i], dz[i]);
            let b = x * dx + y * dy + z * dz;
            let (px, py, pz) = (x - b * dx, y - b * dy, z - b * dz);
            let (distance, unit) = ((px * px + py * py + pz * pz).sqrt(), self.unit + rays.unit[i]);
            let leaves = mask(index == rays.misses[0][i]);
            let inside = self.radius - distance;
            let half = (greater(inside, 0.0) * (self.radius + distance)).sqrt();
            // Great where the line grazes the sphere, and then the test is undecided.
            let own = unit + unit * (2.0 * self.radius) / greater(half, f32::MIN_POSITIVE);
            let near = -b - half;
            let first = choose(mask(near > -own), near, half - b);
            let misses = mask(inside < -unit) & !leaves;
            t[i] = choose(leaves, -2.0 * b, first);
            error[i] = choose(leaves | misses, unit, own);
            // A line that certainly misses is far off, one that certainly meets the sphere is not off at all.
            let meets = mask(inside > unit) | leaves;
            off[i] = choose(misses, f32::MAX, greater(choose(meets, f32::MIN, 0.0), -t[i]));
        }
        for i in 0..LANES {
            let is_known = mask(index == rays.misses[1][i]);
            accept::<ANY>(index, i, (t[i], error[i], off[i]), is_known, best);
        }
    }

    /// Where a ray hits the sphere first, in f64. A ray that leaves the sphere starts off it by more than a rounding.
    /// So it hits the other side or nothing.
    pub fn meet(&self, ray: &Ray) -> Option<f64> {
        let (center, radius) = self.exact;
        let (from, d) = (ray.origin - center, ray.direction);
        let (square, distance) = (d.dot(d), from.length());
        let b = from.dot(d) / square;
        let across = from - d * b;
        let inside = (radius - across.length()) * (radius + across.length());
        if inside < 0.0 || b >= 0.0 && distance > radius {
            return None;
        }
        let half = (inside / square).sqrt();
        // The product of both roots, without a difference of squares.
        let product = (distance - radius) * (distance + radius) / square;
        let t = if distance > radius {
            product / (half - b)
        } else if b > 0.0 {
            -product / (half + b)
        } else {
            half - b
        };
        (t <= ray.t_max).then_some(t)
    }
}
