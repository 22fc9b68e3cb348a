//! Exact signs: a triangle is hit if and only if big integers say so, and the f64 error bound holds.

use super::triangles::Random;
use num_bigint::{BigInt, Sign};
use proptest::prelude::*;
use raywright::math::{DVec3, Ray, Region, Vec3};
use raywright::shapes::triangle::EdgeRay;

/// `x · 2^1074` as an integer.
pub fn integer(x: f64) -> BigInt {
    let bits = x.abs().to_bits();
    let (fraction, biased) = (bits & ((1 << 52) - 1), bits >> 52);
    let magnitude = match biased {
        0 => BigInt::from(fraction),
        _ => BigInt::from(fraction | 1 << 52) << (biased - 1),
    };
    if x < 0.0 { -magnitude } else { magnitude }
}

type Exact = [BigInt; 3];

fn exact(p: DVec3) -> Exact {
    p.to_array().map(integer)
}

fn minus(p: &Exact, q: &Exact) -> Exact {
    std::array::from_fn(|i| &p[i] - &q[i])
}

/// `d · (v × w)`.
fn volume(d: &Exact, v: &Exact, w: &Exact) -> BigInt {
    (0..3).map(|i| &d[i] * (&v[(i + 1) % 3] * &w[(i + 2) % 3] - &v[(i + 2) % 3] * &w[(i + 1) % 3])).sum()
}

/// The weights of the three corners, times 2^(3 · 1074).
fn weights(origin: DVec3, direction: DVec3, corners: [DVec3; 3]) -> [BigInt; 3] {
    let o = exact(origin);
    let [a, b, c] = corners.map(|p| minus(&exact(p), &o));
    let d = exact(direction);
    [volume(&d, &b, &c), volume(&d, &c, &a), volume(&d, &a, &b)]
}

/// Return whether the ray's line hits the triangle, if they are not coplanar.
fn is_met(weights: &[BigInt; 3]) -> bool {
    let has = |sign| weights.iter().any(|w| w.sign() == sign);
    has(Sign::Plus) != has(Sign::Minus)
}

/// The region of a scene of one triangle.
fn region(corners: [Vec3; 3]) -> Region {
    Region::around(corners.map(Vec3::as_dvec3))
}

fn check(origin: DVec3, direction: DVec3, corners: [Vec3; 3]) -> Result<(), TestCaseError> {
    let ray = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(origin, direction) };
    let wide = corners.map(|c| c.as_dvec3());
    let met = is_met(&weights(origin, direction, wide));
    match EdgeRay::new(&ray, &region(corners)) {
        // A t that overflows f64 is no hit; a length of 2⁻⁶⁰⁰ and coordinates below 2³⁰⁰ avoid that.
        Some(edges) => prop_assert_eq!(edges.meet(wide).is_some(), met, "{:?} {:?}", ray, corners),
        None => prop_assert!(direction.abs().max_element() < f64::MIN_POSITIVE),
    }
    Ok(())
}

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        (-4i32..=4).prop_map(|x| x as f32),
        -1f32..1.0,
        (-3i32..=3, -2i32..=2).prop_map(|(x, k)| x as f32 * (1.0 + k as f32 * f32::EPSILON)),
        any::<f32>().prop_filter("finite", |x| x.is_finite()),
    ]
}

fn wide_coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        coordinate().prop_map(f64::from),
        -1.0..1.0f64,
        (-1.0..1.0f64, -250i32..250).prop_map(|(x, e)| x * 2f64.powi(e)),
        // Close to small integers.
        (-3i32..=3, -2i32..=2).prop_map(|(x, k)| f64::from(x) * (1.0 + f64::from(k) * f64::EPSILON)),
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from_array)
}

fn wide_point() -> impl Strategy<Value = DVec3> {
    [wide_coordinate(), wide_coordinate(), wide_coordinate()].prop_map(DVec3::from_array)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30_000))]
    #[test]
    fn any_ray_and_triangle(origin in wide_point(), direction in wide_point(), corners in [point(), point(), point()]) {
        prop_assume!(direction.abs().max_element() > 2f64.powi(-600));
        check(origin, direction, corners)?;
    }

    #[test]
    fn rays_aimed_at_edges(
        origin in wide_point(), corners in [point(), point(), point()], k in -4i32..=12, side in -4i32..=4,
    ) {
        let [a, b, c] = corners.map(|p| p.as_dvec3() / 2f64.powi(20));
        let along = a + (b - a) * (f64::from(k) / 8.0);
        let target = along + (c - along) * (f64::from(side) * f64::EPSILON);
        let direction = target - origin / 2f64.powi(20);
        prop_assume!(direction.is_finite() && direction.abs().max_element() > 2f64.powi(-600));
        check(origin, direction, corners)?;
    }
}

#[test]
fn nearly_coplanar_and_nearly_on_an_edge() {
    // Targets on an edge or plane, exactly or off by an ulp, where the last bits decide signs.
    let mut random = Random(1);
    let (mut met, mut passed) = (0, 0);
    for _ in 0..60_000 {
        let size = random.of(&[1.0, 1e-3, 1e-6, 1e3, 1e8]);
        let corners = [0; 3].map(|_| (random.point(1.0) * size + random.of(&[0.0, 1.0])).as_vec3());
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let anywhere = random.between(-0.2, 1.2);
        let (s, t) = (random.of(&[0.0, 0.5, 1.0, anywhere]), random.of(&[0.0, 1e-16, -1e-16, 1e-12, 0.3]));
        let (near, far) = (random.point(4.0), random.point(1e8));
        let origin = random.of(&[a + (b - a) * 3.0, near, far, c + (a - b) * 0.7]);
        let direction = a + (b - a) * s + (c - a) * t - origin;
        if direction == DVec3::ZERO {
            continue;
        }
        check(origin, direction, corners).unwrap();
        if is_met(&weights(origin, direction, [a, b, c])) { met += 1 } else { passed += 1 }
    }
    assert!(met > 5000 && passed > 5000, "{met} {passed}");
}

/// Return the error of the f64 weights in units of the bound: 2⁻⁵³ · 2 · largest².
///
/// `rust/shapes/triangle/edge.rs` proves 208 of these units, to first order, and allows 256.
fn error(origin: DVec3, direction: DVec3, corners: [Vec3; 3]) -> f64 {
    let edges = EdgeRay::new(&Ray::new(origin, direction), &region(corners)).unwrap();
    let wide = corners.map(|c| c.as_dvec3());
    // Of the scaled direction, which is exact for these moderate sizes. Twice, because of the edge form.
    let wanted = weights(origin, edges.direction, wide);
    let [a, b, c] = wide.map(|p| p - origin);
    let found = [(b, c), (c, a), (a, b)].map(|(v, w)| edges.direction.dot((v - w).cross(v + w)));
    let worst = found.iter().zip(&wanted).map(|(f, w)| {
        let off: BigInt = (integer(*f) << (2 * 1074usize)) - w * 2;
        // Converted to f64 by the top bits; the truncation is far below the precision needed.
        let off = off.magnitude();
        let cut = off.bits().saturating_sub(64);
        let top: u64 = (off >> cut).try_into().unwrap();
        top as f64 * 2f64.powi(cut as i32 - 3 * 1074)
    });
    worst.fold(0.0, f64::max) / (f64::EPSILON * edges.largest * edges.largest)
}

#[test]
fn the_bound_on_rounding_withstands_a_hunt() {
    // Hill climbing from random starts to larger errors, by changing one number at a time.
    let mut random = Random(2);
    let mut worst = 0f64;
    for _ in 0..40 {
        let far = random.of(&[0.0, 0.5, 1.0, 3.0]);
        let mut state: [f64; 15] = std::array::from_fn(|i| match i {
            0..3 => random.between(-1.0, 1.0) * far,
            3..6 => random.of(&[1.0, -1.0]) * random.between(1.0, 2.0),
            _ => random.of(&[1.0, -1.0]) * random.between(0.5, 1.0),
        });
        let measure = |s: &[f64; 15]| {
            let v = |i: usize| DVec3::new(s[i], s[i + 1], s[i + 2]);
            error(v(0), v(3), [v(6), v(9), v(12)].map(|p| p.as_vec3()))
        };
        let mut best = measure(&state);
        for _ in 0..1500 {
            let mut other = state;
            let i = random.below(15);
            other[i] = match random.below(3) {
                0 => -other[i],
                1 => other[i] * (1.0 + random.between(-1.0, 1.0) * random.of(&[1e-1, 1e-4, 1e-8, 1e-15])),
                _ => random.between(-1.0, 1.0),
            };
            if other[3..6].iter().all(|x| *x == 0.0) {
                continue;
            }
            let found = measure(&other);
            if found > best {
                (best, state) = (found, other);
            }
        }
        worst = worst.max(best);
    }
    println!("the largest error found is {worst} units");
    assert!(worst <= 208.0, "an error of {worst} units");
    // Checks that the search works: random inputs alone have errors of a few units.
    assert!(worst > 8.0, "no more than {worst} units found");
}

/// Small integers times a power of two, up to the ends of the range, where products under- and overflow.
fn scaled() -> impl Strategy<Value = ([DVec3; 3], DVec3, DVec3)> {
    let point = || prop::array::uniform3(-9i32..=9).prop_map(|p| DVec3::from_array(p.map(f64::from)));
    let bit = || prop::array::uniform3(-1e-15..1e-15f64).prop_map(DVec3::from_array);
    (prop::array::uniform3(point()), point(), point(), prop::array::uniform3(bit()), -1060i32..1000, prop::bool::ANY)
        .prop_map(|(corners, at, from, bits, exponent, aimed)| {
            let target = if aimed { (corners[0] + corners[1]) / 2.0 } else { at };
            // In two steps: 2^exponent alone may be subnormal, or its inverse infinite.
            let scale = |p: DVec3| p * 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
            let corners = [0, 1, 2].map(|i| scale(corners[i] * (1.0 + bits[i])));
            (corners, scale(from), target - from)
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]
    #[test]
    fn doubles_of_any_size_are_decided_exactly((corners, origin, direction) in scaled()) {
        let ray = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(origin, direction) };
        let met = is_met(&weights(origin, direction, corners));
        if let Some(edges) = EdgeRay::new(&ray, &Region::around(corners)) {
            prop_assert_eq!(edges.meet(corners).is_some(), met, "{:?} {:?}", ray, corners);
        }
    }
}
