//! Properties of the textbook routines for any input: symmetries, shared edges, closed forms.

use proptest::prelude::*;
use raywright::math::Vec3;
use raywright::shapes::triangle::routines::badouel::Badouel;
use raywright::shapes::triangle::routines::edge_f32::EdgeF32;
use raywright::shapes::triangle::routines::edge_f64::EdgeF64;
use raywright::shapes::triangle::routines::moller_trumbore::{MollerTrumbore, MollerTrumboreEdges};
use raywright::shapes::triangle::routines::volumes::SignedVolumes;
use raywright::shapes::triangle::routines::woop::Woop;
use raywright::shapes::triangle::routines::{Contest, Routine, SingleRay, TriangleHit};

fn meet<R: Routine>(ray: SingleRay, corners: [Vec3; 3]) -> Option<TriangleHit> {
    R::meet(&R::ray(ray, corners), &R::triangle(corners))
}

type Meet = fn(SingleRay, [Vec3; 3]) -> Option<TriangleHit>;

const ALL: [(&str, Meet); 7] = [
    (MollerTrumbore::NAME, meet::<MollerTrumbore>),
    (MollerTrumboreEdges::NAME, meet::<MollerTrumboreEdges>),
    (Badouel::NAME, meet::<Badouel>),
    (SignedVolumes::NAME, meet::<SignedVolumes>),
    (Woop::NAME, meet::<Woop>),
    (EdgeF32::NAME, meet::<EdgeF32>),
    (EdgeF64::NAME, meet::<EdgeF64>),
];

/// Routines with a number per edge that is negated if the edge is reversed.
const BY_EDGES: [(&str, Meet); 4] = [ALL[3], ALL[4], ALL[5], ALL[6]];

/// A point in a cube.
fn point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-1.0..1.0f32).prop_map(Vec3::from_array)
}

/// A point with coordinates that are multiples of 1/64, whose sums and differences are exact in f32.
fn lattice() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-64i32..=64).prop_map(|p| Vec3::from_array(p.map(|x| x as f32 / 64.0)))
}

fn triangle() -> impl Strategy<Value = [Vec3; 3]> {
    prop::array::uniform3(point())
}

/// Return a ray from outside the cube to the point of the triangle's plane with these weights.
fn aimed(from: Vec3, [a, b, c]: [Vec3; 3], u: f32, v: f32) -> SingleRay {
    let origin = 3.0 * from.normalize_or(Vec3::X) + from;
    SingleRay { origin, direction: a * (1.0 - u - v) + b * u + c * v - origin }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    #[test]
    fn a_scale_that_is_a_power_of_two_changes_no_bit(
        corners in triangle(), from in point(), u in -0.3..1.0f32, v in -0.3..1.0f32, exponent in -20i32..=20,
    ) {
        let ray = aimed(from, corners, u, v);
        let scale = 2f32.powi(exponent);
        let scaled = SingleRay { origin: ray.origin * scale, ..ray };
        for (name, meet) in ALL {
            let once = meet(ray, corners).map(|m| TriangleHit { t: m.t * f64::from(scale), ..m });
            prop_assert_eq!(meet(scaled, corners.map(|c| c * scale)), once, "{}", name);
        }
    }

    #[test]
    fn a_move_that_is_exact_changes_no_bit_of_what_looks_only_at_differences(
        corners in prop::array::uniform3(lattice()), from in lattice(), direction in point(), by in lattice(),
    ) {
        let ray = SingleRay { origin: 4.0 * from, direction };
        let moved = SingleRay { origin: ray.origin + by, ..ray };
        let there = corners.map(|c| c + by);
        for (name, meet) in ALL {
            let (here, there) = (meet(ray, corners), meet(moved, there));
            if name == EdgeF64::NAME {
                // The bound is larger farther out, where t may come from the exact weights.
                prop_assert_eq!(here.is_some(), there.is_some());
                for (x, y) in here.iter().zip(&there) {
                    prop_assert!((x.t - y.t).abs() <= 1e-7 * (1.0 + x.t));
                }
            } else if name != Badouel::NAME {
                prop_assert_eq!(here, there, "{}", name);
            }
        }
    }

    #[test]
    fn a_triangle_wound_the_other_way_is_hit_as_before(
        corners in triangle(), from in point(), u in -0.3..1.0f32, v in -0.3..1.0f32,
    ) {
        let ray = aimed(from, corners, u, v);
        let [a, b, c] = corners;
        for (name, meet) in BY_EDGES {
            prop_assert_eq!(meet(ray, [a, b, c]).is_some(), meet(ray, [a, c, b]).is_some(), "{}", name);
        }
    }

    #[test]
    fn no_ray_passes_between_triangles_that_share_an_edge(
        a in point(), c in point(), from in point(), share in 0.1..0.9f32, wide in 0.1..1.0f32,
    ) {
        // The other corners lie on opposite sides of the edge from a to c in the ray's view, far from the target.
        let ray = aimed(from, [a, c, c], share, 0.0);
        let side = (c - a).cross(ray.direction);
        prop_assume!(side.length() > 0.2);
        let away = side.normalize() * wide;
        let (b, d) = (a.midpoint(c) + away, a.midpoint(c) - away);
        for (name, meet) in BY_EDGES {
            prop_assert!(meet(ray, [a, b, c]).is_some() || meet(ray, [a, c, d]).is_some(), "{}", name);
        }
    }

    #[test]
    fn edges_stored_or_not_give_the_same_bits(
        corners in triangle(), from in point(), u in -0.3..1.0f32, v in -0.3..1.0f32,
    ) {
        let ray = aimed(from, corners, u, v);
        prop_assert_eq!(meet::<MollerTrumbore>(ray, corners), meet::<MollerTrumboreEdges>(ray, corners));
    }

    #[test]
    fn a_triangle_without_area_is_not_hit(
        a in lattice(), step in lattice(), k in -4i8..=4, from in lattice(), direction in lattice(),
    ) {
        let corners = [a, a + step, a + step * f32::from(k)];
        let ray = SingleRay { origin: 4.0 * from, direction };
        for (name, meet) in ALL {
            prop_assert_eq!(meet(ray, corners), None, "{}", name);
        }
    }
}

const CORNERS: [Vec3; 3] = [Vec3::ZERO, Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)];

#[test]
fn numbers_that_need_no_rounding_give_the_closed_form() {
    let ray = SingleRay { origin: Vec3::new(1.0, 1.0, 8.0), direction: Vec3::new(0.0, 0.5, -2.0) };
    for (name, meet) in ALL {
        // At (1, 3, 0), on the far edge.
        assert_eq!(meet(ray, CORNERS), Some(TriangleHit { t: 4.0, u: 0.25, v: 0.75 }), "{name}");
    }
}

#[test]
fn what_lies_behind_is_not_hit_and_what_lies_at_the_origin_is() {
    let above = Vec3::new(1.0, 1.0, 8.0);
    for (name, meet) in ALL {
        assert_eq!(meet(SingleRay { origin: above, direction: Vec3::Z }, CORNERS), None, "{name}");
        let found = meet(SingleRay { origin: Vec3::new(1.0, 1.0, 0.0), direction: Vec3::Z }, CORNERS);
        assert_eq!(found.map(|m| m.t), Some(0.0), "{name}");
    }
}

#[test]
fn a_ray_that_is_nan_or_goes_nowhere_hits_nothing() {
    for bad in [Vec3::NAN, Vec3::ZERO, Vec3::new(0.0, f32::NAN, 1.0)] {
        for (name, meet) in ALL {
            assert_eq!(meet(SingleRay { origin: Vec3::ONE, direction: bad }, CORNERS), None, "{name}");
        }
    }
}

#[test]
fn a_contest_asks_each_routine_for_each_pair() {
    let origin = Vec3::new(1.0, 1.0, 8.0);
    let rays = [Vec3::NEG_Z, Vec3::Z, Vec3::new(0.0, 0.0, -4.0)].map(|direction| SingleRay { origin, direction });
    let contest = Contest::new(&rays, &[CORNERS; 3]);
    assert_eq!(contest.contenders().map(|c| c.name()).collect::<Vec<_>>(), ALL.map(|(name, _)| name));
    for (contender, (_, meet)) in contest.contenders().zip(ALL) {
        assert_eq!(contender.answers(), rays.map(|ray| meet(ray, CORNERS)));
        let t: Vec<_> = contender.answers().iter().map(|answer| answer.map(|m| m.t)).collect();
        assert_eq!(t, [Some(8.0), None, Some(2.0)]);
    }
    assert_eq!(contest.round().len(), ALL.len());
}
