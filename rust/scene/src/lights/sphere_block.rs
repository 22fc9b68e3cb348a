//! Spheres as lamps, drawn from sixteen points at a time in f32.

use super::lamp::LampLanes;
use raywright_base::math::single::{choose, greater, mask, sin_cos_quarters, to_world};
use raywright_base::math::{LANES, SingleLanes, Vec3, VectorLanes};
use raywright_base::simd::loops;
use std::f32::consts::TAU;

loops! {
    /// Draws light of spheres from points outside them, uniformly in the cone that each subtends ([`raywright_shapes`]
    /// has the formulas in f64). `outside` is all bits where a point is outside; other lanes are undefined.
    pub(super) fn draw_spheres(
        position: &VectorLanes,
        lamps: &LampLanes,
        u: &[[f32; LANES]; 2],
        direction: &mut SingleLanes,
        weight: &mut SingleLanes,
        pdf: &mut [f32; LANES],
        distance: &mut [f32; LANES],
        outside: &mut [u32; LANES],
    ) {
        for i in 0..LANES {
            let way = lamps.place.get(i) - position.get(i);
            let (length, radius) = (way.dot(way).sqrt(), lamps.radius[i]);
            // In f64, for points next to the sphere.
            let gap = (length - radius) as f32;
            let (far, radius) = (length as f32, radius as f32);
            let inverse = 1.0 / far;
            let (axis, sine) = (way.as_vec3() * inverse, radius * inverse);
            let cosine = (greater(gap, 0.0) * (far + radius)).sqrt() * inverse;
            let part = 1.0 / (1.0 + cosine);
            // 1 − cos of the half-angle, and of the angle to the direction.
            let height = sine * sine * part;
            let x = u[0][i] * height;
            let square = u[0][i] * part * (2.0 - x);
            let facing = greater(1.0 - square, 0.0).sqrt();
            let across = (x * (2.0 - x)).sqrt();
            let [sin, cos] = sin_cos_quarters(4.0 * u[1][i]);
            let towards = to_world(axis, Vec3::new(across * cos, across * sin, 1.0 - x));
            // The nearer root, without a difference of numbers that are alike.
            let reach = gap * (far + radius) / (far * (1.0 - x) + radius * facing);
            let spread = TAU * height * lamps.rarity[i];
            let is_lit = lamps.sides[0][i] & mask(spread > 0.0) & mask(spread < f32::INFINITY) & mask(reach > 0.0);
            direction.set(i, towards);
            weight.set(i, lamps.radiance.get(i) * spread);
            pdf[i] = choose(is_lit, 1.0 / spread, 0.0);
            distance[i] = reach;
            outside[i] = mask(gap > 1e-6 * radius);
        }
    }
}
