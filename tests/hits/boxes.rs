//! Box tests never reject a true hit: triangles that fill their flat boxes, and grazing rays.

use super::super::cases;
use super::triangles::{Random, Triangles, agreed, hits};
use proptest::prelude::*;
use raywright::math::{DVec3, Ray, Vec3};

/// Right triangles in axis-aligned planes, each half of its box, so that each leaf's box has no volume.
fn flat(random: &mut Random, count: usize, size: f64) -> Triangles {
    let triangle = |_| {
        let corner = random.point(1.0);
        let (mut along, mut up) = (DVec3::ZERO, DVec3::ZERO);
        let axis = random.below(3);
        along[(axis + 1) % 3] = random.between(-size, size);
        up[(axis + 2) % 3] = random.between(-size, size);
        [corner, corner + along, corner + up].map(|c| c.as_vec3())
    };
    Triangles((0..count).map(triangle).collect())
}

/// An exact point on the border of a triangle: a corner, or a point of an edge at a fraction of a power of two.
fn on_border(random: &mut Random, triangles: &Triangles) -> DVec3 {
    let triangle = triangles.0[random.below(triangles.0.len())].map(|c| c.as_dvec3());
    let (i, k) = (random.below(3), random.below(9));
    triangle[i] + (triangle[(i + 1) % 3] - triangle[i]) * (k as f64 / 8.0)
}

/// Direction components from zero through tiny to large.
const PARTS: [f64; 16] =
    [0.0, -0.0, 5e-324, -5e-324, 1e-310, 1e-300, -1e-100, 1e-40, -1e-30, 1e-19, 1e-18, -1e-12, 1e-8, -1e-7, 1e-3, 1.0];

#[test]
fn rays_along_the_axes_and_nearly_so() {
    let mut random = Random(1);
    let mut met = 0;
    for _ in 0..40 {
        let triangles = flat(&mut random, 120, 0.3);
        let rays: Vec<_> = (0..300)
            .map(|_| {
                let target = on_border(&mut random, &triangles);
                let axis = random.below(3);
                let mut direction = DVec3::new(random.of(&PARTS), random.of(&PARTS), random.of(&PARTS));
                direction[axis] = random.of(&[1.0, -1.0]);
                // Whole steps back, whose components across the axis often round to zero.
                Ray::new(target - direction * random.of(&[0.0, 1.0, 2.0, 7.0, 1000.0]), direction)
            })
            .collect();
        met += hits(&agreed(&triangles, &rays));
    }
    assert!(met > 3000, "{met}");
}

#[test]
fn rays_within_the_planes_of_boxes() {
    let mut random = Random(2);
    let mut met = 0;
    for _ in 0..40 {
        // On a grid of eighths, planes of many boxes coincide and contain rays exactly.
        let mut triangles = flat(&mut random, 150, 0.5);
        for corner in triangles.0.iter_mut().flatten() {
            *corner = (*corner * 8.0).round() / 8.0;
        }
        let rays: Vec<_> = (0..300)
            .map(|_| {
                let ways = [0.0, -0.0, 1.0, -1.0, 2.0, 1e-310, -1e-25];
                let way = DVec3::new(random.of(&ways), random.of(&ways), random.of(&ways));
                Ray::new(random.grid(12) / 8.0, way)
            })
            .collect();
        met += hits(&agreed(&triangles, &rays));
    }
    assert!(met > 1000, "{met}");
}

#[test]
fn rays_that_graze_flat_boxes() {
    let mut random = Random(3);
    let mut met = 0;
    for slope in [1e-1, 1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-15] {
        for distance in [1.0, 5.0, 20.0, 1e3, 1e6] {
            let triangles = flat(&mut random, 60, 1.0);
            let rays: Vec<_> = (0..200)
                .map(|_| {
                    let target = on_border(&mut random, &triangles);
                    let mut way = random.point(1.0);
                    way[random.below(3)] *= slope;
                    Ray::new(target - way * distance, way)
                })
                .collect();
            met += hits(&agreed(&triangles, &rays));
        }
    }
    assert!(met > 3000, "{met}");
}

#[test]
fn rays_from_far_that_only_just_arrive() {
    let mut random = Random(4);
    // Large triangles, so that distant rounded origins still hit near their borders, and a box that is the whole scene.
    for exponent in (0..=110).step_by(2) {
        let triangles = flat(&mut random, 40, 2.0);
        let distance = 2f64.powi(exponent);
        let rays: Vec<_> = (0..cases(60))
            .map(|_| {
                let target = on_border(&mut random, &triangles);
                let way = random.point(1.0);
                let origin = target - way * distance;
                // The direction to the target, rounded to f64.
                Ray::new(origin, (target - origin) / distance)
            })
            .collect();
        agreed(&triangles, &rays);
    }
}

#[test]
fn intervals_that_end_at_the_hit() {
    let mut random = Random(5);
    let mut met = 0;
    for exponent in [0, 3, 4, 10, 20, 30, 40, 45] {
        let triangles = flat(&mut random, 150, 0.5);
        let distance = 2f64.powi(exponent);
        let rays: Vec<_> = (0..300)
            .map(|_| {
                let target = random.target(&triangles);
                let way = random.point(1.0) * random.of(&[1e-20, 1.0, 1e20]);
                let origin = target - way / way.abs().max_element() * distance;
                Ray::new(origin, (target - origin) * (way.abs().max_element() / distance))
            })
            .collect();
        let found = agreed(&triangles, &rays);
        // The box of the triangle that was hit must not begin after t or end before it.
        let exactly: Vec<_> = rays
            .iter()
            .zip(&found)
            .filter(|(_, h)| h.is_hit())
            .map(|(r, h)| Ray { t_min: h.t, t_max: h.t, ..*r })
            .collect();
        let again = agreed(&triangles, &exactly);
        assert_eq!(hits(&again), exactly.len());
        met += exactly.len();
    }
    assert!(met > 1000, "{met}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(100)))]
    #[test]
    fn boxes_without_volume_of_any_size(
        seed in any::<u64>(),
        count in 1usize..60,
        exponents in [-60i32..60, -60i32..60, -60i32..60],
    ) {
        // Scaled by powers of two, with a different size per axis; flat triangles stay flat.
        let mut random = Random(seed);
        let stretch = DVec3::from_array(exponents.map(|e| 2f64.powi(e)));
        let triangles = flat(&mut random, count, 0.5);
        let stretched = |c: Vec3| (c.as_dvec3() * stretch).as_vec3();
        let triangles = Triangles(triangles.0.iter().map(|t| t.map(stretched)).collect());
        let rays: Vec<_> = (0..60)
            .map(|_| {
                let target = on_border(&mut random, &triangles);
                let origin = random.point(2.0);
                let origin = origin * if random.below(2) == 0 { stretch } else { stretch.min_element() * DVec3::ONE };
                Ray::new(origin, target - origin)
            })
            .collect();
        agreed(&triangles, &rays);
    }
}
