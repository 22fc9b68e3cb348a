//! Agreement of all accelerators, at every width and level: hits are bit-identical and correct.

use super::super::cases;
use super::triangles::{Random, Triangles, accelerators, agreed, bits, hits, levels};
use proptest::prelude::*;
use raywright::accel::bvh::{self, Options};
use raywright::math::{DVec3, Hit, Ray, Vec3};
use raywright::scene::{Geometry, Mesh};

#[test]
fn soups() {
    let mut random = Random(1);
    for (count, size) in [(1, 1.0), (4, 1.0), (5, 1.0), (9, 0.5), (300, 0.3), (2000, 0.05)] {
        let soup = random.soup(count, size);
        let mut rays = random.aimed(&soup, 300, 3.0);
        rays.extend((0..300).map(|_| Ray::new(random.point(1.5), random.point(1.0))));
        assert!(hits(&agreed(&soup, &rays)) >= 200);
    }
}

#[test]
fn grids_of_small_integers_with_ties_and_coplanar_rays() {
    let mut random = Random(2);
    for _ in 0..20 {
        let triangles = Triangles((0..150).map(|_| [0; 3].map(|_| random.grid(3).as_vec3())).collect());
        let rays: Vec<_> = (0..300)
            .map(|_| Ray { t_min: random.of(&[0.0, -2.0, 1.0]), ..Ray::new(random.grid(5), random.grid(2)) })
            .collect();
        assert!(hits(&agreed(&triangles, &rays)) > 50);
    }
}

#[test]
fn of_coincident_triangles_the_first_is_hit() {
    let mut random = Random(3);
    let first: Vec<_> = (0..40).map(|_| [0; 3].map(|_| random.grid(6).as_vec3())).collect();
    // Forty copies of each, with rotated corners and both orientations, at distant indices.
    let turn = |k: usize, [a, b, c]: [Vec3; 3]| [[a, b, c], [b, c, a], [c, b, a]][k % 3];
    let triangles = Triangles((0..1600).map(|i| turn(i / 40, first[i % 40])).collect());
    let rays: Vec<_> = (0..500)
        .map(|_| {
            let origin = random.grid(12);
            let vertex = first[random.below(40)][random.below(3)].as_dvec3();
            Ray::new(origin, random.of(&[vertex - origin, DVec3::X, -DVec3::Y, DVec3::Z]))
        })
        .collect();
    let found = agreed(&triangles, &rays);
    assert!(hits(&found) > 100);
    // For small integers all but the last quotient is exact, so all copies are hit at the same t.
    assert!(found.iter().all(|h| !h.is_hit() || h.primitive < 40));
}

#[test]
fn a_million_copies_of_one_triangle() {
    let one = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let triangles = Triangles(vec![one; 1_000_000]);
    let tree = bvh::widest(&triangles, &Options::DEFAULT, levels().last().unwrap());
    tree.validate(&triangles).unwrap();
    let ray = Ray::new(DVec3::new(0.25, 0.25, 1.0), -DVec3::Z);
    let mut hit = [Hit::MISS];
    tree.intersect(&[ray], &mut hit);
    assert_eq!(hit, [Hit { t: 1.0, uv: [0.25, 0.25], primitive: 0, inner: 0 }]);
}

#[test]
fn origins_far_away() {
    let mut random = Random(4);
    let soup = random.soup(80, 0.5);
    // Boxes are given up beyond 2¹⁰⁰ extents, an f32 origin overflows beyond 1e38, and an f64 square beyond 1e154.
    for exponent in [2, 4, 6, 7, 8, 10, 12, 14, 15, 16, 17, 18, 20, 25, 29, 30, 31, 37, 38, 39, 60, 150, 155, 300] {
        let distance = 10f64.powi(exponent);
        let rays: Vec<_> = (0..cases(80))
            .map(|i| {
                let target = random.target(&soup);
                // Along an axis, a ray from any distance hits its target.
                let way = if i % 2 == 0 { random.point(1.0) } else { random.of(&[DVec3::X, -DVec3::Y, DVec3::Z]) };
                let across = if i % 2 == 0 { DVec3::ZERO } else { target * (DVec3::ONE - way.abs()) };
                let origin = across - distance * way;
                let aimed = random.of(&[true, false]);
                Ray::new(origin, if aimed { (target - origin) / distance } else { way })
            })
            .collect();
        assert!(hits(&agreed(&soup, &rays)) > rays.len() / 4, "{distance:e}");
    }
    let end = f64::MAX;
    let rays: Vec<_> = [-1.0, 0.0, 1.0]
        .into_iter()
        .flat_map(|x| [-1.0, 0.0, 1.0].map(|y| DVec3::new(x, y, 1.0)))
        .map(|w| Ray::new(-w * end, w))
        .collect();
    agreed(&soup, &rays);
}

#[test]
fn huge_and_tiny_together() {
    let mut random = Random(5);
    let mut triangles = Triangles(Vec::new());
    for exponent in (-44..=38).step_by(4) {
        let scale = 10f64.powi(exponent);
        let soup = random.soup(8, 0.5);
        triangles.0.extend(soup.0.iter().map(|t| t.map(|c| (c.as_dvec3() * scale).as_vec3())));
    }
    let count = cases(300);
    let rays: Vec<_> = (0..count)
        .map(|_| {
            let origin = random.target(&triangles) * random.of(&[-1.5, 1e-3, 0.5, 3.0]);
            let target = random.target(&triangles);
            Ray::new(origin, (target - origin) / (target - origin).abs().max_element())
        })
        .collect();
    assert!(hits(&agreed(&triangles, &rays)) > count as usize / 2);
}

#[test]
fn coordinates_of_any_size() {
    let mut random = Random(6);
    // Products of coordinates under- and overflow f32 at the ends of its range.
    for exponent in (-148..=126).step_by(2) {
        let scale = 2f64.powi(exponent);
        let soup = random.soup(30, 0.5);
        let scaled = Triangles(soup.0.iter().map(|t| t.map(|c| (c.as_dvec3() * scale).as_vec3())).collect());
        let rays: Vec<_> = (0..60)
            .map(|_| {
                let origin = random.point(2.0) * scale;
                let way = random.target(&scaled) - origin;
                // Nearly along an axis: large coordinates meet small components of the direction.
                let squeezed = random.of(&[DVec3::X, DVec3::Y, DVec3::Z]) + random.of(&[1.0, 1e-3, 1e-6]);
                Ray::new(origin + way * (DVec3::ONE - squeezed), way * squeezed * random.of(&[1.0, 1e-30, 1e30]))
            })
            .collect();
        assert!(hits(&agreed(&scaled, &rays)) > 5, "2^{exponent}");
    }
}

#[test]
fn directions_of_any_length() {
    let mut random = Random(7);
    let soup = random.soup(60, 0.5);
    let rays = random.aimed(&soup, 50, 2.0);
    let wanted = agreed(&soup, &rays);
    for exponent in [-1000, -500, -149, -30, 30, 127, 500, 1000] {
        let scale = 2f64.powi(exponent);
        let found =
            agreed(&soup, &rays.iter().map(|r| Ray { direction: r.direction * scale, ..*r }).collect::<Vec<_>>());
        for (found, wanted) in found.iter().zip(&wanted) {
            // Scaling by a power of two only changes the unit of t.
            assert_eq!(bits(&Hit { t: found.t * scale, ..*found }), bits(wanted));
        }
    }
}

#[test]
fn empty_scenes_miss() {
    let nothing = Triangles(Vec::new());
    let nowhere = Triangles(vec![[Vec3::NAN; 3], [Vec3::INFINITY, Vec3::ZERO, Vec3::ONE]]);
    let mut random = Random(8);
    let rays: Vec<_> = (0..20).map(|_| Ray::new(random.point(1.0), random.point(1.0))).collect();
    for triangles in [nothing, nowhere] {
        assert_eq!(hits(&agreed(&triangles, &rays)), 0);
        assert_eq!(hits(&agreed(&triangles, &[])), 0);
        for (_, accelerator) in accelerators(&triangles) {
            assert_eq!((accelerator.info().primitives, accelerator.info().nodes, accelerator.info().depth), (0, 0, 0));
        }
    }
}

#[test]
fn a_scene_of_one_point_is_never_hit() {
    let point = Triangles(vec![[Vec3::ZERO; 3]; 9]);
    let rays: Vec<_> = [DVec3::X, DVec3::ONE, -DVec3::Z].map(|d| Ray::new(-d, d)).to_vec();
    assert_eq!(hits(&agreed(&point, &rays)), 0);
}

#[test]
fn rays_that_are_not_rays_hit_nothing_and_spoil_nothing() {
    let mut random = Random(9);
    let soup = random.soup(100, 0.5);
    let good = random.aimed(&soup, 120, 2.0);
    let wanted = agreed(&soup, &good);
    let mut rays = Vec::new();
    for (i, ray) in good.iter().enumerate() {
        let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][i % 3];
        let mut broken = *ray;
        match i / 3 % 5 {
            0 => broken.origin[i % 3] = bad,
            1 => broken.direction[i % 3] = bad,
            2 => broken.direction = DVec3::new(0.0, -0.0, 0.0),
            3 => (broken.t_min, broken.t_max) = (1.0, 0.5),
            _ => broken.t_min = f64::NAN,
        }
        rays.extend([broken, *ray]);
    }
    let found = agreed(&soup, &rays);
    for (pair, wanted) in found.chunks(2).zip(&wanted) {
        assert_eq!(bits(&pair[0]), bits(&Hit::MISS));
        assert_eq!(bits(&pair[1]), bits(wanted));
    }
    let forever = |t| Ray { t_min: t, t_max: t, ..good[0] };
    assert_eq!(hits(&agreed(&soup, &[forever(f64::INFINITY), forever(f64::NEG_INFINITY)])), 0);
}

#[test]
fn both_ends_of_the_interval_count() {
    let mut random = Random(10);
    let soup = random.soup(300, 0.3);
    let rays: Vec<_> =
        random.aimed(&soup, 400, 2.0).into_iter().map(|r| Ray { t_min: f64::NEG_INFINITY, ..r }).collect();
    let found = agreed(&soup, &rays);
    let hit: Vec<_> = rays.into_iter().zip(found).filter(|(_, h)| h.is_hit()).collect();
    assert!(hit.len() > 300);
    let again = |t_min: fn(f64) -> f64, t_max: fn(f64) -> f64| {
        let rays: Vec<_> = hit.iter().map(|(r, h)| Ray { t_min: t_min(h.t), t_max: t_max(h.t), ..*r }).collect();
        agreed(&soup, &rays)
    };
    let wanted: Vec<_> = hit.iter().map(|(_, h)| bits(h)).collect();
    let all = |found: Vec<Hit>| found.iter().map(bits).collect::<Vec<_>>();
    // The direction is scaled by a power of two, so neither end is rounded.
    assert_eq!(all(again(|t| t, |t| t)), wanted);
    assert_eq!(all(again(|_| f64::NEG_INFINITY, |t| t)), wanted);
    assert_eq!(all(again(|t| t, |_| f64::INFINITY)), wanted);
    assert_eq!(hits(&again(|_| f64::NEG_INFINITY, f64::next_down)), 0);
    for (found, (_, before)) in again(f64::next_up, |_| f64::INFINITY).iter().zip(&hit) {
        assert!(found.t > before.t);
    }
}

#[test]
fn neither_the_batch_nor_the_order_changes_an_answer() {
    let mut random = Random(11);
    let soup = random.soup(3000, 0.05);
    // Some batches are coherent and some are not, which different kernels process.
    let eye = DVec3::new(0.0, 0.0, 3.0);
    let mut rays: Vec<_> = (0..400).map(|i| Ray::new(eye, DVec3::new(f64::from(i) * 2e-3 - 0.4, 0.01, -1.0))).collect();
    rays.extend(random.aimed(&soup, 600, 2.0));
    for (name, accelerator) in accelerators(&soup) {
        let mut wanted = vec![Hit::MISS; rays.len()];
        accelerator.intersect(&rays, &mut wanted);
        assert!(hits(&wanted) > 500);
        let mut order: Vec<usize> = (0..rays.len()).collect();
        for batch in [1, 2, 7, 8, 9, 63, 64, 65, 200, 1000] {
            // A random order each time (Fisher and Yates 1938).
            for i in (1..order.len()).rev() {
                order.swap(i, random.below(i + 1));
            }
            let shuffled: Vec<_> = order.iter().map(|&i| rays[i]).collect();
            let mut found = vec![Hit::MISS; rays.len()];
            let mut occluded = vec![false; rays.len()];
            for ((rays, hits), occluded) in
                shuffled.chunks(batch).zip(found.chunks_mut(batch)).zip(occluded.chunks_mut(batch))
            {
                accelerator.intersect(rays, hits);
                accelerator.occluded(rays, occluded);
            }
            for (place, &i) in order.iter().enumerate() {
                assert_eq!(bits(&found[place]), bits(&wanted[i]), "{name}, batches of {batch}");
                assert_eq!(occluded[place], wanted[i].is_hit(), "{name}, batches of {batch}");
            }
        }
    }
}

#[test]
fn the_geometry_of_a_scene_is_numbered_through_its_meshes() {
    let mut random = Random(12);
    let soup = random.soup(90, 0.3);
    let mesh = |triangles: &[[Vec3; 3]]| Mesh {
        vertices: triangles.iter().flatten().copied().collect(),
        faces: (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        normals: None,
        ..Mesh::default()
    };
    let geometry = Geometry::new([mesh(&soup.0[..20]), mesh(&[]), mesh(&soup.0[20..])]);
    let rays = random.aimed(&soup, 300, 2.0);
    let wanted = agreed(&soup, &rays);
    for (name, accelerator) in accelerators(&geometry) {
        let mut found = vec![Hit::MISS; rays.len()];
        accelerator.intersect(&rays, &mut found);
        for (i, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
            assert_eq!(bits(found), bits(wanted), "{name}, ray {i}");
        }
    }
    for hit in wanted.iter().filter(|h| h.is_hit()) {
        let p = hit.primitive;
        assert_eq!(geometry.locate(p), if p < 20 { (0, p) } else { (2, p - 20) });
    }
}

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => (-3i32..=3).prop_map(|x| x as f32),
        4 => -1f32..1.0,
        // Close to small integers.
        2 => (-3i32..=3, -2i32..=2).prop_map(|(x, k)| x as f32 * (1.0 + k as f32 * f32::EPSILON)),
        1 => any::<f32>().prop_filter("finite", |x| x.is_finite()),
    ]
}

fn wide_coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => coordinate().prop_map(f64::from),
        1 => prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from_array)
}

fn ray() -> impl Strategy<Value = Ray> {
    let any = || [wide_coordinate(), wide_coordinate(), wide_coordinate()].prop_map(DVec3::from_array);
    let from = prop_oneof![3 => Just(0.0), 1 => Just(f64::NEG_INFINITY), 1 => -2.0..2.0];
    let until = prop_oneof![3 => Just(f64::INFINITY), 1 => 0.0..4.0];
    (any(), any(), from, until).prop_map(|(origin, direction, t_min, t_max)| Ray {
        t_min,
        t_max,
        ..Ray::new(origin, direction)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(200)))]
    #[test]
    fn any_rays_at_any_triangles(
        triangles in prop::collection::vec([point(), point(), point()], 0..40),
        rays in prop::collection::vec(ray(), 1..40),
    ) {
        agreed(&Triangles(triangles), &rays);
    }

    #[test]
    fn rays_aimed_at_corners(
        triangles in prop::collection::vec([point(), point(), point()], 1..40),
        rays in prop::collection::vec((ray(), any::<prop::sample::Index>(), 0usize..3), 1..40),
    ) {
        let rays: Vec<_> = rays
            .into_iter()
            .map(|(ray, which, corner)| {
                let target = which.get(&triangles)[corner].as_dvec3();
                Ray { direction: target - ray.origin, ..ray }
            })
            .collect();
        agreed(&Triangles(triangles), &rays);
    }
}
