//! Exact decision of the side of a triangle on which a ray arrives.

use raywright_base::math::robust::{UNIT, greater, normalising_scale};
use raywright_base::math::{DVec3, Ray, exact_edges};

/// The power of two that scales the direction's largest coordinate to between 1 and 2, and the scaled direction.
pub(crate) fn scaled(ray: &Ray) -> (f64, DVec3) {
    let size = ray.direction.abs();
    let (scale, _) = normalising_scale(greater(greater(size.x, size.y), size.z));
    (scale, ray.direction * scale)
}

/// Returns whether a ray that hits a triangle arrives on the side of its normal, by the sign of `d · ((b − a) × (c −
/// a))`.
pub(crate) fn is_front_of([a, b, c]: [DVec3; 3], ray: &Ray) -> bool {
    let (d, v, w) = (scaled(ray).1, b - a, c - a);
    let terms = [(0, 1, 2), (1, 2, 0), (2, 0, 1)].map(|(i, j, k)| [d[i] * v[j] * w[k], -(d[i] * v[k] * w[j])]);
    let (mut volume, mut size) = (0.0, 0.0);
    for term in terms.as_flattened() {
        volume += term;
        size += term.abs();
    }
    // Error bound: four roundings in each term and one in each of five sums. Underflow is far below the bound, because
    // nothing is large.
    let largest = v.abs().max(w.abs()).max_element();
    if largest < 1e50 && size > 1e-250 && volume.abs() > 16.0 * UNIT * size {
        return volume < 0.0;
    }
    // The exact volumes of the three edges sum to this determinant. If the triangle is hit, they all have one sign or
    // are zero.
    exact_edges(ray.origin, d, [a, b, c]).iter().any(|&volume| volume < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywright_base::sampling::{Sampler, warp};

    /// Triangles from regular to needle-thin, large and small, near the origin and far from it.
    fn corners(seed: u32) -> [DVec3; 3] {
        let (mut sampler, mut dimension) = (Sampler::new(5, 0, seed), 0);
        let mut next = || {
            dimension += 1;
            warp::uniform_sphere(sampler.two(dimension))
        };
        let middle = next() * [0.0, 1.0, 1e6][seed as usize % 3];
        [0; 3].map(|_| middle + next() * [1e-6, 1.0, 1e3][(seed / 3) as usize % 3])
    }

    #[test]
    fn a_side_is_what_the_exact_volumes_say() {
        let mut seen = [0; 2];
        for seed in 0..3000 {
            let corners = corners(seed);
            let [a, b, c] = corners;
            // The ray is in the triangle's plane up to rounding, so f64 alone cannot decide the side.
            let along = if seed % 2 == 0 { b - a } else { 0.3 * (b - a) + 0.9 * (c - a) };
            let way = along + (b - a).cross(c - a) * [0.0, 1e-18, -1e-14, -1.0, 1.0][seed as usize % 5];
            let ray = Ray::new((a + b + c) / 3.0 - way, way);
            let exact = exact_edges(ray.origin, way, corners);
            if exact.iter().all(|&v| v >= 0.0) != exact.iter().all(|&v| v <= 0.0) {
                let front = is_front_of(corners, &ray);
                assert_eq!(front, exact.iter().all(|&v| v <= 0.0), "triangle {seed}");
                // Reversing the winding reverses the side.
                assert_ne!(front, is_front_of([a, c, b], &ray), "triangle {seed}");
                seen[usize::from(front)] += 1;
            }
        }
        assert!(seen.iter().all(|&count| count > 200), "{seen:?}");
    }
}
