use super::*;
use crate::math::DoubleDouble;
use proptest::prelude::*;
use std::f64::consts::PI;

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![-1.0..1.0f64, (-3i32..=3).prop_map(f64::from), (-1.0..1.0f64).prop_map(|x| x * 1e-6)]
}

fn point() -> impl Strategy<Value = DVec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array)
}

/// The nearest multiple of 2⁻ᵇⁱᵗˢ.
fn on_grid(p: DVec3, bits: i32) -> DVec3 {
    (p * 2f64.powi(bits)).round() * 2f64.powi(-bits)
}

/// Points anywhere, or thin and diagonal, near the origin or far from it.
fn cloud() -> impl Strategy<Value = Vec<DVec3>> {
    let shift = prop_oneof![Just(DVec3::ZERO), Just(DVec3::new(1e3, -2e6, 5.0)), point()];
    let squeeze = prop_oneof![Just(0.0), Just(1e-9), Just(1.0)];
    (prop::collection::vec(point(), 1..30), shift, point(), squeeze).prop_map(|(points, shift, axis, squeeze)| {
        let axis = axis.try_normalize().unwrap_or(DVec3::X);
        let thin = |p: DVec3| shift + axis * p.dot(axis) + (p - axis * p.dot(axis)) * squeeze;
        points.into_iter().map(|p| on_grid(thin(p), 30)).collect()
    })
}

/// Every volume of the points: whether a ray may meet it, and from where on.
fn tests(points: &[DVec3], ray: &Ray) -> Vec<(&'static str, Option<f64>)> {
    fn test<V: Volume>(points: &[DVec3], line: &Line) -> Option<f64> {
        V::around(points).unwrap().meets(line, &V::ready(line))
    }
    let line = Line::new(ray).unwrap();
    vec![
        ("sphere", test::<BoundingSphere>(points, &line)),
        ("oriented box", test::<OrientedBox>(points, &line)),
        ("3 slabs", test::<Slabs<3>>(points, &line)),
        ("7 slabs", test::<Slabs<7>>(points, &line)),
        ("9 slabs", test::<Slabs<9>>(points, &line)),
        ("13 slabs", test::<Slabs<13>>(points, &line)),
    ]
}

/// The heights of points along normals, in 32 digits: each within the spans.
fn enclosed(points: &[DVec3], centre: DVec3, normals: &[DVec3], spans: &[[f64; 2]]) -> bool {
    points.iter().all(|p| {
        normals.iter().zip(spans).all(|(n, span)| {
            let height = (0..3).fold(DoubleDouble::ZERO, |sum, i| {
                sum + DoubleDouble::difference(p[i], centre[i]) * DoubleDouble::from(n[i])
            });
            DoubleDouble::from(span[0]) <= height && height <= DoubleDouble::from(span[1])
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]
    #[test]
    fn points_are_inside_of_what_is_around_them(points in cloud()) {
        let sphere = BoundingSphere::around(&points).unwrap();
        for p in &points {
            let square = (0..3).fold(DoubleDouble::ZERO, |sum, i| sum + DoubleDouble::difference(p[i], sphere.centre[i]).squared());
            prop_assert!(square <= DoubleDouble::product(sphere.radius, sphere.radius));
        }
        let turned = OrientedBox::around(&points).unwrap();
        prop_assert!(enclosed(&points, turned.centre, &turned.axes, &turned.spans));
        for (i, a) in turned.axes.iter().enumerate() {
            prop_assert!((a.length() - 1.0).abs() < 1e-14 && a.dot(turned.axes[(i + 1) % 3]).abs() < 1e-14);
        }
        let slabs = Slabs::<13>::around(&points).unwrap();
        prop_assert!(enclosed(&points, DVec3::ZERO, &Slabs::<13>::NORMALS, &slabs.spans()));
        prop_assert!(points.iter().all(|&p| sphere.contains(p) && turned.contains(p) && slabs.contains(p)));
    }

    #[test]
    fn no_ray_through_a_point_is_rejected(
        points in cloud(), d in point(), far in prop_oneof![Just(0), Just(1), Just(1 << 10), Just(1 << 19)],
        length in -90i32..90,
    ) {
        // Coordinates of at most 22 bits before the point and 30 behind: nothing is rounded, and the ray goes through
        // the point exactly.
        let d = on_grid(d, 10);
        prop_assume!(d != DVec3::ZERO);
        let scale = 2f64.powi(length);
        let origin = points[0] - d * f64::from(far);
        let ray = Ray { t_min: f64::NEG_INFINITY, ..Ray::new(origin, d * scale) };
        let t = f64::from(far) / scale;
        let window = Ray { t_min: t, t_max: t, ..ray };
        for (name, met) in tests(&points, &ray).into_iter().chain(tests(&points, &window)) {
            prop_assert!(met.is_some_and(|enter| enter <= t), "{name}: {met:?} for {t}");
        }
    }

    #[test]
    fn triangles_that_are_hit_are_never_rejected(
        corners in prop::array::uniform3(point()), shift in prop_oneof![Just(0.0), Just(1e4), Just(1e7)],
        origin in point(), far in prop_oneof![Just(1.0), Just(1e5)], to in prop::array::uniform3(0.0..1.0f64),
    ) {
        let corners = corners.map(|c| c + DVec3::new(1.0, -2.0, 0.5) * shift);
        let origin = origin * far;
        let sum: f64 = to.iter().sum();
        let target = corners.iter().zip(to).map(|(c, w)| *c * (w / sum)).sum::<DVec3>();
        prop_assume!(target != origin);
        let ray = Ray::new(origin, target - origin);
        // The exact decision of the triangle.
        let w = crate::math::exact_edges(ray.origin, ray.direction, corners);
        let hit = w != [0.0; 3] && (w.iter().all(|&x| x >= 0.0) || w.iter().all(|&x| x <= 0.0));
        prop_assume!(hit);
        for (name, met) in tests(&corners, &ray) {
            prop_assert!(met.is_some_and(|enter| enter <= 1.0 + 1e-9), "{name}: {met:?}");
        }
    }

    #[test]
    fn spheres_are_the_smallest(points in prop::collection::vec(point(), 1..9)) {
        let found = BoundingSphere::around(&points).unwrap();
        let mut lower = 0.0f64;
        for a in &points {
            for b in &points {
                lower = lower.max(a.distance(*b) / 2.0);
            }
        }
        prop_assert!(found.radius >= lower);
        // A centre moved by s along w is at r²(1 − 10⁻⁹)² + s² − 2sδr or more from a border point with w · (p − c) ≤
        // δr: where every w has one, no ball of a radius below r(1 − 10⁻⁹ − δ²) holds all.
        let border: Vec<DVec3> = points.iter().copied().filter(|p| p.distance(found.centre) >= found.radius * (1.0 - 1e-9)).collect();
        for i in 0..200 {
            let at = |k: u32| f64::from((i * 7 + k).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24) - 0.5;
            if let Some(way) = DVec3::new(at(1), at(2), at(3)).try_normalize() {
                prop_assert!(border.iter().any(|p| way.dot(*p - found.centre) <= 1e-4 * found.radius), "{found:?}");
            }
        }
    }
}

#[test]
fn a_diagonal_rod_fills_a_turned_box_and_slabs_better_than_a_box() {
    let rod: Vec<DVec3> = (0..40)
        .map(|i| DVec3::ONE * f64::from(i) + DVec3::new(f64::from(i % 3), f64::from(i % 2), 0.0) * 0.1)
        .collect();
    let plain = Slabs::<3>::around(&rod).unwrap();
    let turned = OrientedBox::around(&rod).unwrap();
    assert!(turned.half_area() < 0.02 * plain.half_area() && turned.volume() < 1e-4 * plain.volume());
    let (nine, thirteen) = (Slabs::<9>::around(&rod).unwrap(), Slabs::<13>::around(&rod).unwrap());
    assert!(nine.half_area() < 0.05 * plain.half_area() && thirteen.half_area() <= nine.half_area() * (1.0 + 1e-9));
    assert_eq!(plain.union(&plain), plain);
}

#[test]
fn a_cube_has_its_sizes() {
    let cube: Vec<DVec3> =
        (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 + 3.0).collect();
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
    let sphere = BoundingSphere::around(&cube).unwrap();
    assert!(
        near(sphere.radius, 3f64.sqrt())
            && near(sphere.half_area(), 6.0 * PI)
            && near(sphere.volume(), 4.0 * PI * 3f64.sqrt())
    );
    assert!(
        near(OrientedBox::around(&cube).unwrap().half_area(), 12.0)
            && near(OrientedBox::around(&cube).unwrap().volume(), 8.0)
    );
    assert!(
        near(Slabs::<13>::around(&cube).unwrap().half_area(), 12.0)
            && near(Slabs::<7>::around(&cube).unwrap().volume(), 8.0)
    );
    // Past a corner of the cube's box, but through its sphere.
    let ray = Ray::new(DVec3::new(5.1, 2.9, -9.0), DVec3::Z);
    let met: Vec<bool> = tests(&cube, &ray).iter().map(|t| t.1.is_some()).collect();
    assert_eq!(met, [true, false, false, false, false, false]);
    let behind = Ray::new(DVec3::new(4.0, 4.0, 9.0), DVec3::Z);
    assert!(tests(&cube, &behind).iter().all(|t| t.1.is_none()));
    let short = Ray { t_max: 11.0, ..Ray::new(DVec3::new(4.0, 4.0, -9.0), DVec3::Z) };
    assert!(tests(&cube, &short).iter().all(|t| t.1.is_none()));
}

#[test]
fn one_point_and_none() {
    assert!(
        BoundingSphere::around(&[]).is_none()
            && OrientedBox::around(&[]).is_none()
            && Slabs::<7>::around(&[]).is_none()
    );
    let one = [DVec3::new(1.0, 2.0, 3.0)];
    assert_eq!(BoundingSphere::around(&one).unwrap().radius, 0.0);
    let through = Ray::new(DVec3::new(1.0, 2.0, -4.0), DVec3::Z);
    assert!(tests(&one, &through).iter().all(|t| t.1.is_some()));
    for ray in [Ray::new(DVec3::NAN, DVec3::X), Ray::new(DVec3::X, DVec3::ZERO)] {
        assert!(Line::new(&ray).is_none());
    }
}
