//! Cone queries: every accelerator agrees with a test of each triangle, and the results are correct.

use super::triangles::{Random, Triangles, accelerators};
use proptest::prelude::*;
use raywright::accel::Primitives;
use raywright::math::{DVec3, Hit, Vec3};
use raywright::shapes::triangle::SolidCone;

/// Narrow and wide cones from around a scene into it.
pub fn cones(random: &mut Random, triangles: &Triangles, count: usize, reach: f64) -> Vec<Option<SolidCone>> {
    let mut one = || {
        let apex = random.point(reach);
        let way = random.target(triangles) - apex;
        let angle = random.of(&[0.0, 1e-6, 0.3, 5.0, 30.0, 60.0, 89.9]);
        SolidCone::new(apex, way, angle, random.of(&[f64::INFINITY, f64::INFINITY, 1.0, 0.2]))
    };
    (0..count).map(|_| one()).collect()
}

/// Return the distances and primitives of each cone after checking that all accelerators agree bit for bit.
pub fn agreed(triangles: &Triangles, cones: &[Option<SolidCone>]) -> Vec<Vec<(u64, u32)>> {
    let wanted: Vec<Vec<_>> = cones
        .iter()
        .map(|cone| {
            let touch = |p| Some((cone.as_ref()?.nearest(triangles.corners(p))?.to_bits(), p));
            let finite = (0..triangles.count() as u32).filter(|&p| triangles.is_finite(p));
            // Distances are nonnegative, so their bits sort like numbers.
            let mut touches: Vec<_> = finite.filter_map(touch).collect();
            touches.sort_unstable();
            touches
        })
        .collect();
    for (name, accelerator) in accelerators(triangles) {
        let found = accelerator.touched(cones);
        for (i, wanted) in wanted.iter().enumerate() {
            let found: Vec<_> = found.of(i).iter().map(|t| (t.distance.to_bits(), t.primitive)).collect();
            assert_eq!(&found, wanted, "{name}, {:?}", cones[i]);
        }
    }
    wanted
}

#[test]
fn all_accelerators_agree() {
    let mut random = Random(11);
    for (count, size, reach) in [(0, 1.0, 1.0), (1, 1.0, 2.0), (9, 0.5, 2.0), (300, 0.3, 3.0), (1500, 0.05, 2.0)] {
        let mut soup = random.soup(count, size);
        // Points, segments, and triangles that cannot be hit.
        for i in (0..count).step_by(7) {
            soup.0[i][2] = soup.0[i][0];
            soup.0[i][1] = if i % 2 == 0 { soup.0[i][0] } else { soup.0[i][1] };
        }
        if count > 100 {
            soup.0[50][1].y = f32::NAN;
            soup.0[51][1].y = f32::INFINITY;
        }
        let cones = if count == 0 {
            vec![SolidCone::new(DVec3::ZERO, DVec3::X, 80.0, 9.0)]
        } else {
            cones(&mut random, &soup, 120, reach)
        };
        let touched = agreed(&soup, &cones);
        assert!(count < 300 || touched.iter().map(Vec::len).sum::<usize>() > 1000);
    }
}

#[test]
fn wherever_the_apex_and_of_any_size() {
    let mut random = Random(12);
    for exponent in [-38, -20, 0, 20, 37] {
        let scale = 10f64.powi(exponent);
        let soup = random.soup(60, 0.5);
        let soup = Triangles(soup.0.iter().map(|t| t.map(|c| (c.as_dvec3() * scale).as_vec3())).collect());
        for away in [1e3, 1e9, 1e20, 1e200] {
            let cones: Vec<_> = (0..30)
                .map(|_| {
                    let apex = random.point(1.0) * scale * away;
                    let way = random.target(&soup) - apex;
                    SolidCone::new(apex, way, random.of(&[0.0, 1e-9, 1e-3, 20.0]), f64::INFINITY)
                })
                .collect();
            let touched = agreed(&soup, &cones);
            assert!(touched.iter().filter(|t| !t.is_empty()).count() > 15, "{scale:e} {away:e}");
        }
    }
}

#[test]
fn a_cone_of_no_angle_touches_all_that_its_ray_meets() {
    let mut random = Random(13);
    let soup = random.soup(200, 0.4);
    let rays: Vec<_> = random.aimed(&soup, 300, 3.0);
    let cones: Vec<_> = rays.iter().map(|r| SolidCone::new(r.origin, r.direction, 0.0, f64::INFINITY)).collect();
    let (_, brute) = accelerators(&soup).into_iter().next().unwrap();
    let (touched, crossed) = (brute.touched(&cones), brute.crossings(&rays));
    for (i, ray) in rays.iter().enumerate() {
        let hits: &[Hit] = &crossed.hits[crossed.splits[i]..crossed.splits[i + 1]];
        for hit in hits {
            let touch = touched.of(i).iter().find(|t| t.primitive == hit.primitive).expect("what is hit is touched");
            let distance = hit.t * ray.direction.length();
            assert!((touch.distance - distance).abs() < 1e-6 * (1.0 + distance), "{touch:?} {distance}");
        }
    }
}

#[test]
fn no_cone_touches_nothing() {
    let (o, x) = (DVec3::ZERO, DVec3::X);
    for (apex, way, angle, most) in [
        (o, o, 5.0, 1.0),
        (DVec3::NAN, x, 5.0, 1.0),
        (o, x * f64::INFINITY, 5.0, 1.0),
        (o, x, -1.0, 1.0),
        (o, x, 90.0, 1.0),
        (o, x, f64::NAN, 1.0),
        (o, x, 5.0, -1.0),
        (o, x, 5.0, f64::NAN),
    ] {
        assert_eq!(SolidCone::new(apex, way, angle, most), None);
    }
    let one = Triangles(vec![[Vec3::X, Vec3::Y, Vec3::Z]]);
    for (_, accelerator) in accelerators(&one) {
        assert_eq!(accelerator.touched(&[None, None]).splits, [0, 0, 0]);
    }
}

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        -2.0..2.0f64,
        (-3i32..=3).prop_map(f64::from),
        (-1f64..1.0, 0i32..30).prop_map(|(x, e)| x * 2f64.powi(-e))
    ]
}

fn point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(coordinate()).prop_map(DVec3::from_array)
}

/// Return the distance of a point outside a cone, from the angle alone.
fn outside(cone: &SolidCone, angle: f64, p: DVec3) -> f64 {
    let q = p - cone.apex;
    let turned = q.cross(cone.axis).length().atan2(q.dot(cone.axis)) - angle.to_radians();
    if turned > std::f64::consts::FRAC_PI_2 { q.length() } else { q.length() * turned.sin() }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]
    #[test]
    fn no_point_of_a_triangle_in_the_cone_is_nearer(
        corners in [point(), point(), point()], apex in point(), way in point(),
        angle in prop_oneof![Just(0.0), 0.0..89.9f64, Just(45.0), 1e-9..1e-3f64],
        weights in prop::collection::vec((0.0..=1.0f64, 0.0..=1.0f64), 60),
    ) {
        prop_assume!(way.length() > 1e-6);
        let cone = SolidCone::new(apex, way, angle, f64::INFINITY).unwrap();
        let found = cone.nearest(corners);
        let edges = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
        for (i, &(s, t)) in weights.iter().chain(&edges).enumerate() {
            let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
            // Some on edges.
            let t = if i % 3 == 0 { 0.0 } else { t };
            let p = corners[0] * (1.0 - s - t) + corners[1] * s + corners[2] * t;
            if outside(&cone, angle, p) <= 0.0 {
                let distance = found.unwrap_or(f64::INFINITY);
                prop_assert!(distance <= (p - apex).length() + 1e-14, "{distance} {:?} {p}", (p - apex).length());
            }
        }
    }

    /// An independent method: the minimum squared distance over the part of the triangle in the cone, by branch and
    /// bound. The triangle is subdivided, and parts are kept that may contain a nearer point in the cone.
    #[test]
    fn distances_are_those_of_branch_and_bound(
        corners in [point(), point(), point()], apex in point(), way in point(),
        angle in prop_oneof![0.5..80.0f64, Just(45.0)],
    ) {
        prop_assume!(way.length() > 1e-6);
        let cone = SolidCone::new(apex, way, angle, f64::INFINITY).unwrap();
        let size = corners.iter().map(|c| (*c - apex).length()).fold(0.0, f64::max);
        // Bounds over points slightly outside the cone, and over points inside.
        let (mut low, mut high) = (f64::INFINITY, f64::INFINITY);
        let mut queue = vec![(corners, 0)];
        while let Some((t, depth)) = queue.pop() {
            let middle = (t[0] + t[1] + t[2]) / 3.0;
            let radius = t.iter().map(|c| (*c - middle).length()).fold(0.0, f64::max);
            let nearest = (middle - apex).length() - radius;
            if outside(&cone, angle, middle) > radius + 1e-12 * size || nearest > high || nearest > low {
                continue;
            }
            for p in t {
                if outside(&cone, angle, p) <= 0.0 {
                    high = high.min((p - apex).length());
                }
            }
            if radius < 1e-3 * size || depth > 24 {
                low = low.min(nearest.max(0.0));
                continue;
            }
            // The longest edge is halved.
            let k = (0..3).max_by(|&i, &j| {
                let length = |i: usize| (t[(i + 1) % 3] - t[i]).length();
                length(i).total_cmp(&length(j))
            }).unwrap();
            let half = 0.5 * (t[k] + t[(k + 1) % 3]);
            for end in [k, (k + 1) % 3] {
                let mut part = t;
                part[end] = half;
                queue.push((part, depth + 1));
            }
        }
        let found = cone.nearest(corners);
        match found {
            Some(distance) => {
                prop_assert!(distance <= high + 1e-14 * size);
                prop_assert!(distance >= low - 1e-12 * size, "{distance} {low} {high}");
            }
            None => prop_assert!(high == f64::INFINITY),
        }
        prop_assert!(low < f64::INFINITY || found.is_none());
    }
}
