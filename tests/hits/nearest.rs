//! Nearest points: all accelerators give the same bits, and correct ones.

use super::signs::integer;
use super::triangles::{Random, Triangles, levels};
use num_bigint::{BigInt, Sign};
use proptest::prelude::*;
use raywright::accel::bvh::{self, Options};
use raywright::accel::{Accelerator, BruteForce, Nearest, Primitives};
use raywright::math::{DVec3, Vec3};
use raywright::shapes::triangle::{NearestPoint, nearest_point, point_of};

/// Triangles with f64 corners.
#[derive(Clone, Debug)]
pub struct Doubles(Vec<[DVec3; 3]>);

impl Primitives for Doubles {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.0[primitive as usize]
    }

    fn is_single(&self) -> bool {
        self.0.iter().flatten().all(|c| c.as_vec3().as_dvec3() == *c)
    }
}

impl From<&Triangles> for Doubles {
    fn from(triangles: &Triangles) -> Self {
        Self(triangles.0.iter().map(|t| t.map(Vec3::as_dvec3)).collect())
    }
}

/// The same triangles, always stored as f64.
struct Kept<'a>(&'a Doubles);

impl Primitives for Kept<'_> {
    fn count(&self) -> usize {
        self.0.count()
    }

    fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.0.corners(primitive)
    }

    fn is_single(&self) -> bool {
        false
    }
}

/// Trees of both widths and brute force, at every level and every lossless precision.
fn accelerators(triangles: &Doubles) -> Vec<(String, Box<dyn Accelerator>)> {
    let mut all: Vec<(String, Box<dyn Accelerator>)> = Vec::new();
    for level in levels() {
        for width in [4, 8].into_iter().filter(|&w| w <= level.lanes()) {
            let tree = |primitives: &dyn Primitives| bvh::wide(width, primitives, &Options::DEFAULT, level);
            all.push((format!("{width} wide, {level:?}"), tree(triangles)));
            all.push((format!("{width} wide, double, {level:?}"), tree(&Kept(triangles))));
        }
        all.push((format!("brute force, {level:?}"), BruteForce::over(triangles, level)));
    }
    all
}

fn bits(nearest: &Nearest) -> ([u64; 6], u32) {
    let Nearest { distance, position: p, uv, primitive, .. } = nearest;
    ([*distance, p.x, p.y, p.z, uv[0], uv[1]].map(f64::to_bits), *primitive)
}

/// Return the nearest points after checking that all accelerators give the same bits, in batches and one by one.
pub fn agreed(triangles: &Doubles, points: &[DVec3], max_distances: &[f64]) -> Vec<Nearest> {
    let mut wanted: Option<Vec<Nearest>> = None;
    for (name, accelerator) in accelerators(triangles) {
        let mut found = vec![Nearest::MISS; points.len()];
        accelerator.nearest(points, max_distances, &mut found);
        for (i, point) in points.iter().enumerate() {
            let mut alone = [Nearest::MISS];
            let most = max_distances[i.min(max_distances.len() - 1)];
            accelerator.nearest(&[*point], &[most], &mut alone);
            assert_eq!(bits(&alone[0]), bits(&found[i]), "{name}, {point}");
        }
        let wanted = wanted.get_or_insert_with(|| found.clone());
        for ((found, wanted), point) in found.iter().zip(wanted).zip(points) {
            assert_eq!(bits(found), bits(wanted), "{name}, {point}: {found:?} for {wanted:?}");
        }
    }
    wanted.expect("an accelerator")
}

/// Return the nearest point by testing each triangle, without a tree.
fn one_by_one(triangles: &Doubles, point: DVec3) -> (f64, u32) {
    let mut best = (f64::INFINITY, u32::MAX);
    for p in 0..triangles.count() as u32 {
        let distance = nearest_point(triangles.corners(p), point).distance;
        if distance < best.0 {
            best = (distance, p);
        }
    }
    best
}

pub fn assert_right(triangles: &Doubles, points: &[DVec3]) -> Vec<Nearest> {
    let found = agreed(triangles, points, &[f64::INFINITY]);
    for (nearest, &point) in found.iter().zip(points) {
        assert_eq!((nearest.distance, nearest.primitive), one_by_one(triangles, point), "{point}");
        assert_eq!(nearest.position, point_of(triangles.corners(nearest.primitive), nearest.uv));
    }
    found
}

type Exact = [BigInt; 3];

fn exact(v: DVec3) -> Exact {
    v.to_array().map(integer)
}

fn minus(a: &Exact, b: &Exact) -> Exact {
    [0, 1, 2].map(|i| &a[i] - &b[i])
}

fn dot(a: &Exact, b: &Exact) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn cross(a: &Exact, b: &Exact) -> Exact {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

/// Return the exact squared distance as a fraction in units of 2⁻²¹⁴⁸.
fn exact_square(corners: [DVec3; 3], point: DVec3) -> (BigInt, BigInt) {
    let point = exact(point);
    let [a, b, c] = corners.map(|c| minus(&exact(c), &point));
    let zero = BigInt::ZERO;
    let normal = cross(&minus(&b, &a), &minus(&c, &a));
    let area = dot(&normal, &normal);
    let is_within =
        area > zero && [(&a, &b), (&b, &c), (&c, &a)].iter().all(|(v, w)| dot(&normal, &cross(v, w)) >= zero);
    if is_within {
        let height = dot(&normal, &a);
        return (&height * &height, area);
    }
    let segments = [(&a, &b), (&b, &c), (&c, &a)].map(|(v, w)| {
        let along = minus(w, v);
        let (length, forward) = (dot(&along, &along), -dot(v, &along));
        if forward <= zero {
            (dot(v, v), BigInt::from(1))
        } else if forward >= length {
            (dot(w, w), BigInt::from(1))
        } else {
            let moment = cross(v, &along);
            (dot(&moment, &moment), length)
        }
    });
    segments.into_iter().reduce(|a, b| if &b.0 * &a.1 < &a.0 * &b.1 { b } else { a }).expect("three of them")
}

/// Assert that a distance is correct within `error`.
fn assert_distance(corners: [DVec3; 3], point: DVec3, found: NearestPoint, error: f64) {
    let (square, divisor) = exact_square(corners, point);
    let (distance, error) = (integer(found.distance), integer(error));
    let (low, high) = (&distance - &error, &distance + &error);
    let told = format!("{point} to {corners:?}: {found:?}");
    assert!(&high * &high * &divisor >= square, "too near: {told}");
    assert!(low.sign() != Sign::Plus || &low * &low * &divisor <= square, "too far: {told}");
}

/// Assert the guaranteed accuracy: 2⁻⁴⁹ of the distance to the farthest corner. The weights must be those of a point of
/// the triangle at about that distance.
fn assert_promised(corners: [DVec3; 3], point: DVec3) {
    let found = nearest_point(corners, point);
    let farthest = corners.iter().map(|&c| distance(c, point)).fold(0.0, f64::max);
    let error = (2f64.powi(-49) * farthest).max(5e-324);
    assert_distance(corners, point, found, error);
    let [u, v] = found.uv;
    assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + f64::EPSILON, "{found:?}");
    let position = point_of(corners, found.uv);
    let size = corners.iter().chain([&point]).map(|c| c.abs().max_element()).fold(0.0, f64::max);
    let off = (distance(position, point) - found.distance).abs();
    assert!(off <= 2f64.powi(-46) * farthest + 2f64.powi(-50) * size, "{point} to {corners:?}: off by {off:e}");
}

/// Scaled down, so that nothing overflows.
fn distance(a: DVec3, b: DVec3) -> f64 {
    let d = a / 8.0 - b / 8.0;
    let size = d.abs().max_element();
    if size == 0.0 { 0.0 } else { (d / size).length() * size * 8.0 }
}

#[test]
fn faces_edges_and_corners_of_known_distance() {
    let corners = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];
    for (point, distance, uv) in [
        ((1.0, 1.0, 3.0), 3.0, [0.25, 0.25]),
        ((1.0, 2.0, -0.5), 0.5, [0.25, 0.5]),
        ((0.0, 0.0, 0.0), 0.0, [0.0, 0.0]),
        ((-3.0, -4.0, 12.0), 13.0, [0.0, 0.0]),
        ((7.0, 0.0, 4.0), 5.0, [1.0, 0.0]),
        ((0.0, 10.0, 8.0), 10.0, [0.0, 1.0]),
        ((1.0, -3.0, 4.0), 5.0, [0.25, 0.0]),
        ((-5.0, 3.0, -12.0), 13.0, [0.0, 0.75]),
        ((2.0, 2.0, 7.0), 7.0, [0.5, 0.5]),
        ((1.0, 1.0, 0.0), 0.0, [0.25, 0.25]),
        ((3.0, 1.0, 0.0), 0.0, [0.75, 0.25]),
    ] {
        let (x, y, z) = point;
        let found = nearest_point(corners, DVec3::new(x, y, z));
        assert_eq!(found, NearestPoint { distance, uv }, "{point:?}");
    }
}

#[test]
fn triangles_without_area_are_segments_and_points() {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let point = at(1.0, 2.0, 2.0);
    assert_eq!(nearest_point([point; 3], DVec3::ZERO), NearestPoint { distance: 3.0, uv: [0.0, 0.0] });
    assert_eq!(nearest_point([point; 3], point).distance, 0.0);
    // A segment from −1 to 3 along x, whose third corner is an end or in between.
    for third in [-1.0, 0.0, 0.3, 3.0] {
        for turn in 0..3 {
            let mut corners = [at(-1.0, 0.0, 0.0), at(3.0, 0.0, 0.0), at(third, 0.0, 0.0)];
            corners.rotate_left(turn);
            for (point, distance, x) in
                [(at(2.0, 3.0, 4.0), 5.0, 2.0), (at(7.0, 0.0, 3.0), 5.0, 3.0), (at(-4.0, 4.0, 0.0), 5.0, -1.0)]
            {
                let found = nearest_point(corners, point);
                assert_eq!(found.distance, distance);
                assert!((point_of(corners, found.uv) - at(x, 0.0, 0.0)).length() <= 1e-15);
            }
            assert_eq!(nearest_point(corners, at(0.1, 0.0, 0.0)).distance, 0.0);
        }
    }
}

#[test]
fn points_on_a_triangle_are_at_distance_zero() {
    let mut random = Random(31);
    for _ in 0..2000 {
        let [a, b, c] = [0; 3].map(|_| random.point(1.0).as_vec3().as_dvec3());
        for point in [a, b, c, (a + b) / 2.0, (b + c) / 2.0, a * 0.25 + c * 0.75] {
            assert_eq!(nearest_point([a, b, c], point).distance, 0.0, "{point} on {a}, {b}, {c}");
        }
        let [a, b, c] = [0; 3].map(|_| random.grid(1 << 14));
        for point in [a * 0.25 + b * 0.25 + c * 0.5, a * 0.125 + b * 0.75 + c * 0.125] {
            assert_eq!(nearest_point([a, b, c], point).distance, 0.0, "{point} on {a}, {b}, {c}");
        }
    }
}

#[test]
fn an_edge_is_as_far_for_both_triangles_that_share_it() {
    let mut random = Random(32);
    for _ in 0..5000 {
        let [a, b] = [random.grid(3), random.point(1.0)].map(|p| p * random.of(&[1.0, 1e5, 1e-3]));
        let middle = a / 2.0 + b / 2.0;
        let point = match random.below(3) {
            0 => random.point(3.0),
            1 => middle + random.grid(2),
            _ => random.grid(4),
        };
        // Both are degenerate, with only this edge.
        let one = nearest_point([a, b, b], point).distance;
        for corners in [[b, a, a], [a, a, b], [b, b, a], [b, a, b], [a, b, a]] {
            assert_eq!(nearest_point(corners, point).distance.to_bits(), one.to_bits());
        }
    }
}

#[test]
fn distances_are_right_to_the_last_digits() {
    let mut random = Random(33);
    for i in 0..20_000 {
        let size = random.of(&[1.0, 1e-3, 1e3, 1e7]);
        let offset = random.point(1.0) * random.of(&[0.0, 1.0, 1e4, 1e8]);
        let [a, b, c] = [0; 3].map(|_| random.point(1.0) * size + offset);
        // Slivers of any thinness, and needles.
        let thin = 10f64.powf(-random.between(0.0, 17.0));
        let third = match i % 3 {
            0 => c,
            1 => a + (b - a) * random.between(-0.2, 1.2) + (c - a) * thin,
            _ => b + (c - b) * thin,
        };
        let weights = [random.between(-0.5, 1.5), random.between(-0.5, 1.5)];
        let on = a * (1.0 - weights[0] - weights[1]) + b * weights[0] + third * weights[1];
        let away = random.of(&[0.0, 1e-12, 1e-6, 1.0, 1e3, 1e9]) * size;
        let point = random.of(&[on, a, a * 0.5 + b * 0.5]) + random.point(1.0) * away;
        assert_promised([a, b, third], point);
    }
}

#[test]
fn distances_between_any_finite_coordinates() {
    let mut random = Random(34);
    for _ in 0..3000 {
        let scale = 2f64.powi(random.below(2090) as i32 - 1070);
        let mut any = || {
            let lesser = random.of(&[1.0, 1.0, 1e-5, 1e-40, 1e-150, 1e-300]);
            random.point(0.9) * scale * lesser
        };
        let [a, b, c, point] = [0; 4].map(|_| any());
        let found = nearest_point([a, b, c], point);
        if found.distance.is_finite() {
            assert_promised([a, b, c], point);
        } else {
            assert!(scale > 1e305);
        }
    }
}

#[test]
fn soups() {
    let mut random = Random(35);
    for (count, size) in [(1, 1.0), (4, 1.0), (5, 1.0), (9, 0.5), (300, 0.3), (3000, 0.03)] {
        let soup = random.soup(count, size);
        let mut points: Vec<_> = (0..300).map(|_| random.point(1.5)).collect();
        points.extend((0..300).map(|_| random.target(&soup)));
        points.extend((0..100).map(|i| random.point(1.0) * 10f64.powi(i / 15)));
        // A sequence of neighboring points.
        points.extend((0..300).map(|i| DVec3::splat(f64::from(i) / 150.0 - 1.0)));
        assert_right(&(&soup).into(), &points);
    }
}

#[test]
fn grids_of_small_integers_with_ties() {
    let mut random = Random(36);
    for _ in 0..20 {
        let soup = Triangles((0..200).map(|_| [0; 3].map(|_| random.grid(3).as_vec3())).collect());
        let points: Vec<_> = (0..200).map(|_| random.grid(5) / random.of(&[1.0, 2.0, 3.0])).collect();
        let found = assert_right(&(&soup).into(), &points);
        assert!(found.iter().filter(|n| n.distance == 0.0).count() > 20);
    }
}

#[test]
fn of_coincident_triangles_the_first_is_nearest() {
    let mut random = Random(37);
    let first: Vec<_> = (0..40).map(|_| [0; 3].map(|_| random.grid(6))).collect();
    let triangles = Doubles((0..1600).map(|i| first[i % 40]).collect());
    let points: Vec<_> = (0..300).map(|_| random.point(9.0)).collect();
    let found = assert_right(&triangles, &points);
    assert!(found.iter().all(|n| n.primitive < 40));
}

#[test]
fn scenes_of_any_size_and_place() {
    let mut random = Random(38);
    for exponent in [-300, -200, -44, -20, -5, 0, 7, 30, 100, 200, 300] {
        let scale = 10f64.powi(exponent);
        for offset in [0.0, 1.0, 1e7] {
            let soup = random.soup(200, 0.2);
            let at = DVec3::new(1.0, -0.3, 0.7) * offset;
            let moved = Doubles(soup.0.iter().map(|t| t.map(|c| (c.as_dvec3() + at) * scale)).collect());
            let points: Vec<_> = (0..100).map(|_| (random.point(1.5) + at) * scale).collect();
            assert_right(&moved, &points);
        }
    }
}

#[test]
fn huge_and_tiny_together() {
    let mut random = Random(39);
    let mut triangles = Doubles(Vec::new());
    for exponent in (-300..=300).step_by(50) {
        let soup = random.soup(8, 0.5);
        triangles.0.extend(soup.0.iter().map(|t| t.map(|c| c.as_dvec3() * 10f64.powi(exponent))));
    }
    let points: Vec<_> = (0..400).map(|_| random.point(2.0) * 10f64.powi(random.below(620) as i32 - 310)).collect();
    assert_right(&triangles, &points);
}

#[test]
fn points_far_away() {
    let mut random = Random(40);
    let soup = Doubles::from(&random.soup(300, 0.2));
    let region = soup.region();
    for exponent in [1, 3, 6, 7, 8, 9, 12, 15, 16, 17, 20, 38, 39, 100, 154, 155, 300, 307] {
        let points: Vec<_> = (0..50).map(|_| random.point(1.0) * 10f64.powi(exponent)).collect();
        for (found, &point) in agreed(&soup, &points, &[f64::INFINITY]).iter().zip(&points) {
            // No triangle is nearer except by rounding, though beyond 2²⁶ radii another one may be found.
            let (wanted, _) = one_by_one(&soup, point);
            assert!((found.distance - wanted).abs() <= 4.0 * f64::EPSILON * wanted, "{found:?}, {wanted}");
            // Where rounding still distinguishes them, it is the extreme one in that direction.
            if exponent > 16 {
                let way = (point * 10f64.powi(-exponent)).normalize();
                let reach = soup.0.iter().flatten().map(|c| c.dot(way)).fold(f64::NEG_INFINITY, f64::max);
                assert!(found.position.dot(way) >= reach - 1e-6 * region.radius, "{found:?}");
            }
        }
    }
}

#[test]
fn copies_of_one_triangle_and_of_one_point() {
    let soup = Doubles(vec![[DVec3::ZERO, DVec3::X, DVec3::Y]; 100_000]);
    for (name, accelerator) in accelerators(&soup) {
        let mut found = [Nearest::MISS];
        accelerator.nearest(&[DVec3::new(0.25, 0.25, -2.0)], &[2.0], &mut found);
        let position = DVec3::new(0.25, 0.25, 0.0);
        assert_eq!(found, [Nearest { distance: 2.0, position, uv: [0.25, 0.25], primitive: 0, inner: 0 }], "{name}");
    }
    let point = Doubles(vec![[DVec3::splat(1e7); 3]; 3]);
    let found = agreed(&point, &[DVec3::splat(1e7), DVec3::ZERO, DVec3::splat(1e300)], &[1e8]);
    assert_eq!(found[0], Nearest { distance: 0.0, position: DVec3::splat(1e7), uv: [0.0; 2], primitive: 0, inner: 0 });
    assert_eq!(found[1].distance, 3f64.sqrt() * 1e7);
    assert!(!found[2].is_hit());
}

#[test]
fn the_greatest_distance_is_included() {
    let mut random = Random(41);
    let soup = Doubles::from(&random.soup(500, 0.1));
    let points: Vec<_> = (0..300).map(|_| random.point(2.0)).collect();
    let free = agreed(&soup, &points, &[f64::INFINITY]);
    let distances: Vec<_> = free.iter().map(|n| n.distance).collect();
    assert_eq!(agreed(&soup, &points, &distances), free);
    let less: Vec<_> = distances.iter().map(|d| d.next_down()).collect();
    assert!(agreed(&soup, &points, &less).iter().all(|n| !n.is_hit()));
    let found = agreed(&soup, &points, &[0.3]);
    for (found, free) in found.iter().zip(&free) {
        assert_eq!(found.is_hit(), free.distance <= 0.3);
        assert!(!found.is_hit() || found == free);
    }
    let far = [DVec3::new(1e20, 0.0, 0.0)];
    assert!(!agreed(&soup, &far, &[1e19])[0].is_hit());
    assert!(agreed(&soup, &far, &[2e20])[0].is_hit());
}

#[test]
fn what_has_no_nearest_point() {
    let soup = Doubles(vec![[DVec3::ZERO, DVec3::X, DVec3::Y], [DVec3::NAN, DVec3::X, DVec3::Y]]);
    let points = [DVec3::NAN, DVec3::INFINITY, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO];
    let found = agreed(&soup, &points, &[1.0, 1.0, f64::NAN, -1.0, 0.0]);
    assert_eq!(found.iter().map(Nearest::is_hit).collect::<Vec<_>>(), [false, false, false, false, true]);
    assert!(found[0].distance == f64::INFINITY && found[0].position.is_nan());
    assert!(!agreed(&Doubles(Vec::new()), &[DVec3::ZERO], &[f64::INFINITY])[0].is_hit());
    // Farther than f64 can represent.
    let far = Doubles(vec![[DVec3::splat(-f64::MAX); 3]]);
    assert!(!agreed(&far, &[DVec3::splat(f64::MAX)], &[f64::INFINITY])[0].is_hit());
    let wide = Doubles(vec![[-DVec3::X * f64::MAX, DVec3::X * f64::MAX, DVec3::Y * f64::MAX]]);
    let found = agreed(&wide, &[DVec3::new(0.0, f64::MAX / 4.0, 2.0)], &[f64::INFINITY])[0];
    assert!((found.distance - 2.0).abs() < 1e300 && found.is_hit());
}

#[test]
fn a_tree_that_was_refitted_finds_the_same() {
    let mut random = Random(42);
    let soup = Doubles::from(&random.soup(400, 0.1));
    let moved = Doubles(soup.0.iter().map(|t| t.map(|c| c * DVec3::new(1.0, -3.0, 0.5) + DVec3::Y)).collect());
    let points: Vec<_> = (0..200).map(|_| random.point(3.0)).collect();
    let wanted = agreed(&moved, &points, &[f64::INFINITY]);
    for (name, accelerator) in accelerators(&soup) {
        let Ok(refitted) = accelerator.refitted(&moved) else {
            // f32 leaves cannot store these.
            assert!(!name.contains("double"), "{name}");
            continue;
        };
        let mut found = vec![Nearest::MISS; points.len()];
        refitted.nearest(&points, &[f64::INFINITY], &mut found);
        assert!(found.iter().map(bits).eq(wanted.iter().map(bits)), "{name}");
    }
}

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-3i32..=3).prop_map(f64::from),
        4 => -1f64..1.0,
        2 => (-3i32..=3, -2i32..=2).prop_map(|(x, k)| f64::from(x) * (1.0 + f64::from(k) * f64::EPSILON)),
        1 => prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
    ]
}

fn point() -> impl Strategy<Value = DVec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn any_points_and_any_triangles(
        triangles in prop::collection::vec([point(), point(), point()], 0..40),
        points in prop::collection::vec(point(), 1..40),
        most in prop_oneof![Just(f64::INFINITY), 0f64..2.0],
    ) {
        agreed(&Doubles(triangles), &points, &[most]);
    }

    #[test]
    fn any_point_and_any_triangle(corners in [point(), point(), point()], point in point()) {
        let found = nearest_point(corners, point);
        if found.distance.is_finite() {
            assert_promised(corners, point);
        }
    }
}
