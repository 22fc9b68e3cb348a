//! Triangles as lamps, drawn from sixteen points at a time in f32.

use super::lamp::LampLanes;
use raywright_base::math::single::{
    choose, choose_vector, greater, mask, sin_cos_quarters, uniform_triangle, upper_angle,
};
use raywright_base::math::{LANES, SingleLanes, Vec3};
use raywright_base::simd::loops;
use std::f32::consts::FRAC_1_PI;

/// A triangle as it is seen from a place, as [`super::SeenTriangle`] is, in f32.
struct TriangleFromPoint {
    edges: [Vec3; 2],
    corner: Vec3,
    /// Along the normal, twice the area long.
    area: Vec3,
    a: Vec3,
    b: Vec3,
    chord: Vec3,
    solid_angle: f32,
    /// Whether directions are drawn by solid angle rather than points by area.
    is_near: u32,
}

impl TriangleFromPoint {
    /// See [`super::SeenTriangle`]. Of a solid angle this small, f32 has three digits.
    const THIN: f32 = 1e-4;
    const DISTANT: f32 = 2.0;

    #[inline(always)]
    fn new(corner: Vec3, edges: [Vec3; 2]) -> Self {
        let area = edges[0].cross(edges[1]);
        let longest = greater(edges[0].dot(edges[0]), edges[1].dot(edges[1]));
        let [ka, kb, kc] = [corner, corner + edges[0], corner + edges[1]];
        let [la, lb, lc] = [ka.dot(ka).sqrt(), kb.dot(kb).sqrt(), kc.dot(kc).sqrt()];
        let [ia, ib, ic] = [1.0 / la, 1.0 / lb, 1.0 / lc];
        let [a, b, c] = [ka * ia, kb * ib, kc * ic];
        let determinant = corner.dot(area).abs() * ia * ib * ic;
        let rest = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
        let solid_angle = 2.0 * upper_angle(determinant, rest);
        let nearer = -edges[0].dot(ka + kb) * ia * ib / (la + lb);
        let chord = edges[0] * ib + corner * nearer;
        let is_near = mask(corner.dot(corner) <= Self::DISTANT * Self::DISTANT * longest)
            & mask(solid_angle >= Self::THIN)
            & mask(solid_angle < 7.0);
        Self { edges, corner, area, a, b, chord, solid_angle, is_near }
    }

    /// A direction of the triangle, drawn evenly.
    #[inline(always)]
    fn direction(&self, u: [f32; 2]) -> Vec3 {
        let Self { edges: [_, edge], a, b, chord, solid_angle, .. } = *self;
        let tangent = edge - a * a.dot(edge);
        let tangent = tangent * (1.0 / tangent.dot(tangent).sqrt());
        let [sin, cos] = sin_cos_quarters(solid_angle * u[0] * FRAC_1_PI);
        let along = sin * (1.0 + a.dot(b));
        let against = cos * a.dot(chord.cross(tangent)).abs() - sin * chord.dot(tangent);
        let length = along * along + against * against;
        let step = (tangent * against - a * along) * (2.0 * along / length);
        let arc = choose_vector(mask(length > 0.0), step - chord, -chord);
        let height = 0.5 * arc.dot(arc) * u[1];
        let side = arc - b * b.dot(arc);
        let square = side.dot(side);
        let side = side * choose(mask(square > 0.0), 1.0 / square.sqrt(), 0.0);
        b * (1.0 - height) + side * greater(height * (2.0 - height), 0.0).sqrt()
    }

    /// A direction that is drawn, the distance of the triangle there, and the inverse of the density.
    #[inline(always)]
    fn sample(&self, u: [f32; 2]) -> (Vec3, f32, f32) {
        let Self { edges: [first, second], corner, area, solid_angle, is_near, .. } = *self;
        let near = self.direction(u);
        let near_distance = corner.dot(area) / near.dot(area);
        let [x, y] = uniform_triangle(u);
        let far = corner + first * x + second * y;
        let square = far.dot(far);
        let inverse = 1.0 / square.sqrt();
        let far = far * inverse;
        let direction = choose_vector(is_near, near, far);
        let distance = choose(is_near, near_distance, square * inverse);
        let spread = choose(is_near, solid_angle, 0.5 * far.dot(area).abs() * (inverse * inverse));
        (direction, distance, spread)
    }
}

loops! {
    /// Draws light of triangles: `way` leads to their first corners.
    pub(super) fn draw_triangles(
        way: &SingleLanes,
        edges: &[SingleLanes; 2],
        lamps: &LampLanes,
        u: &[[f32; LANES]; 2],
        direction: &mut SingleLanes,
        weight: &mut SingleLanes,
        pdf: &mut [f32; LANES],
        distance: &mut [f32; LANES],
    ) {
        for i in 0..LANES {
            let seen = TriangleFromPoint::new(way.get(i), [edges[0].get(i), edges[1].get(i)]);
            let (towards, length, spread) = seen.sample([u[0][i], u[1][i]]);
            let spread = spread * lamps.rarity[i];
            let height = -way.get(i).dot(seen.area);
            let shines = lamps.sides[0][i] & mask(height > 0.0) | lamps.sides[1][i] & mask(height < 0.0);
            // Also false where the distance is 0 and the direction NaN.
            let is_lit = shines & mask(spread > 0.0) & mask(spread < f32::INFINITY) & mask(length > 0.0);
            direction.set(i, towards);
            weight.set(i, lamps.radiance.get(i) * spread);
            pdf[i] = choose(is_lit, 1.0 / spread, 0.0);
            distance[i] = length;
        }
    }
}
