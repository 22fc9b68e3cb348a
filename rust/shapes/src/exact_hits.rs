//! Tests that hits agree with an oracle of 60 digits.

use super::oracle::{Exact, Oracle, Vector, cross, dot, minus, vector};
use super::*;
use proptest::prelude::*;
use raywright_base::math::{Affine, DVec3, Ray};
use std::cmp::Ordering;
use std::sync::Arc;

/// All intersections with an unbounded line.
fn meets(shape: &dyn Shape, ray: &Ray) -> Vec<Candidate> {
    let ray = Ray { t_min: f64::NEG_INFINITY, ..*ray };
    let mut all = Vec::new();
    shape.meet(&ray, &mut |met| {
        all.push(met);
        false
    });
    all
}

/// Fail unless shape and oracle agree, with each `t` within one ulp.
fn check(shape: &dyn Shape, oracle: &Oracle<'_>, ray: &Ray) -> Result<usize, TestCaseError> {
    let found = meets(shape, ray);
    let (wanted, tangent) = oracle.meets(ray);
    if found.len() == 1 && wanted.len() == 2 {
        // Closer together than f64 resolves: reported as one tangent, which is no crossing.
        prop_assert_eq!(found[0].contact, Contact::Touching);
    } else {
        prop_assert_eq!(found.len(), wanted.len(), "{:?} of {:?}: {:?}", ray, shape, found);
    }
    for (f, w) in found.iter().zip(&wanted) {
        prop_assert!(w.ulps_to(f.t) <= 1.0, "{:?} of {:?}: {:?}", ray, shape, found);
        prop_assert!(f.uv.iter().all(|x| (0.0..=1.0).contains(x)), "{:?}", f);
        if tangent && oracle.planes.is_empty() {
            prop_assert_eq!(f.contact, Contact::Touching);
        }
    }
    Ok(found.len())
}

fn check_sphere(center: DVec3, radius: f64, ray: &Ray) -> Result<usize, TestCaseError> {
    let surface = |x: &Vector| {
        let w = minus(x, &vector(center));
        &dot(&w, &w) - &(&Exact::new(radius) * &Exact::new(radius))
    };
    check(&Sphere { center, radius }, &Oracle { surface: &surface, planes: vec![], caps: false }, ray)
}

fn check_ellipsoid(center: DVec3, semi_axes: DVec3, ray: &Ray) -> Result<usize, TestCaseError> {
    let surface = |x: &Vector| {
        let w = minus(x, &vector(center));
        let s = vector(semi_axes).map(|a| &a * &a);
        let square = |i: usize, j: usize, k: usize| &(&(&w[i] * &w[i]) * &s[j]) * &s[k];
        &(&(&square(0, 1, 2) + &square(1, 2, 0)) + &square(2, 0, 1)) - &(&(&s[0] * &s[1]) * &s[2])
    };
    check(&Ellipsoid { center, semi_axes }, &Oracle { surface: &surface, planes: vec![], caps: false }, ray)
}

#[derive(Clone, Copy, Debug)]
enum Turned {
    Cylinder(f64),
    Cone(f64, f64),
    Paraboloid(f64),
}

fn check_turned(kind: Turned, base: DVec3, tip: DVec3, capped: bool, ray: &Ray) -> Result<usize, TestCaseError> {
    let (foot, v) = (vector(base), minus(&vector(tip), &vector(base)));
    let vv = dot(&v, &v);
    let square = |x: &Exact| x * x;
    let surface = |x: &Vector| {
        let w = minus(x, &foot);
        let round = dot(&cross(&w, &v), &cross(&w, &v));
        let height = dot(&w, &v);
        match kind {
            Turned::Cylinder(r) => &round - &(&square(&Exact::new(r)) * &vv),
            Turned::Cone(r0, r1) => {
                let k = &Exact::new(r1) - &Exact::new(r0);
                &(&round * &vv) - &square(&(&(&Exact::new(r0) * &vv) + &(&k * &height)))
            }
            Turned::Paraboloid(r) => &round - &(&square(&Exact::new(r)) * &height),
        }
    };
    let above = |x: &Vector| dot(&minus(x, &foot), &v);
    let below = |x: &Vector| &vv - &dot(&minus(x, &foot), &v);
    let oracle = Oracle { surface: &surface, planes: vec![&above, &below], caps: capped };
    let shape: Box<dyn Shape> = match kind {
        Turned::Cylinder(r) => Box::new(Revolution::cylinder(base, tip, r, capped)),
        Turned::Cone(r0, r1) => Box::new(Revolution::cone(base, tip, [r0, r1], capped)),
        Turned::Paraboloid(r) => Box::new(Revolution::paraboloid(base, tip, r, capped)),
    };
    check(&*shape, &oracle, ray)
}

fn any_point(size: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
}

/// Small integers, for which tangent, coplanar and axis-parallel lines are common.
fn grid_point(size: i32) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..=size).prop_map(|p| DVec3::from_array(p.map(f64::from)))
}

fn point() -> impl Strategy<Value = DVec3> {
    prop_oneof![any_point(4.0), grid_point(4), any_point(1e-3), any_point(1e5)]
}

fn turned() -> impl Strategy<Value = Turned> {
    let r = || prop_oneof![1e-3..3.0, (1i32..4).prop_map(f64::from)];
    prop_oneof![
        r().prop_map(Turned::Cylinder),
        (r(), r()).prop_map(|(a, b)| Turned::Cone(a, b)),
        r().prop_map(|a| Turned::Cone(a, 0.0)),
        r().prop_map(|b| Turned::Cone(0.0, b)),
        r().prop_map(Turned::Paraboloid),
    ]
}

/// A direction of any length.
fn scaled(d: DVec3, power: i32) -> DVec3 {
    d * 2f64.powi(power)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn spheres_and_ellipsoids_are_met_as_the_oracle_says(
        c in point(), axes in prop::array::uniform3(prop_oneof![1e-3..4.0, (1i32..4).prop_map(f64::from)]),
        o in point(), target in prop_oneof![any_point(1.5), grid_point(1)], power in -100i32..100,
    ) {
        let axes = DVec3::from_array(axes);
        let d = c + axes * target - o;
        prop_assume!(d != DVec3::ZERO);
        let ray = Ray::new(o, scaled(d, power));
        check_sphere(c, axes.x, &ray)?;
        check_ellipsoid(c, axes, &ray)?;
    }

    #[test]
    fn surfaces_of_revolution_are_met_as_the_oracle_says(
        kind in turned(), capped: bool, base in point(), axis in prop_oneof![any_point(3.0), grid_point(2)],
        o in point(), at in 0.0..1.0f64, aside in prop_oneof![any_point(3.0), grid_point(2)], power in -100i32..100,
    ) {
        let tip = base + axis;
        prop_assume!(tip != base);
        let d = base + axis * at + aside - o;
        prop_assume!(d != DVec3::ZERO);
        check_turned(kind, base, tip, capped, &Ray::new(o, scaled(d, power)))?;
    }

    #[test]
    fn ties_on_a_grid_are_decided_exactly(
        kind in turned(), capped: bool, base in grid_point(2), axis in grid_point(2),
        o in grid_point(4), d in grid_point(2),
    ) {
        prop_assume!(axis != DVec3::ZERO && d != DVec3::ZERO);
        // A line along a generator lies in the side surface and has no intersection with it.
        check_turned(kind, base, base + axis, capped, &Ray::new(o, d))?;
        check_sphere(base, axis.length_squared().sqrt().floor().max(1.0), &Ray::new(o, d))?;
    }

    #[test]
    fn a_placed_sphere_is_met_as_the_matrix_says(
        rows in prop::array::uniform3(prop_oneof![any_point(3.0), grid_point(2)]),
        shift in point(), o in point(), target in any_point(1.2),
    ) {
        let map = Affine::new(rows, shift);
        prop_assume!(map.determinant().abs() > 1e-9);
        let shape = Placed::new(Arc::new(Sphere::UNIT), map.clone()).unwrap();
        let ray = Ray::new(o, map.point(target) - o);
        prop_assume!(ray.direction != DVec3::ZERO);
        // |adj(L) (x − s)|² = det², by other formulas than the map's own.
        let [a, b, c] = rows.map(vector);
        let columns = [cross(&b, &c), cross(&c, &a), cross(&a, &b)];
        let determinant = dot(&a, &columns[0]);
        let surface = |x: &Vector| {
            let w = minus(x, &vector(shift));
            let image = [0, 1, 2].map(|i| {
                let [x, y, z] = [0, 1, 2].map(|j| &columns[j][i] * &w[j]);
                &(&x + &y) + &z
            });
            &dot(&image, &image) - &(&determinant * &determinant)
        };
        check(&shape, &Oracle { surface: &surface, planes: vec![], caps: false }, &ray)?;
    }

    /// Maps that f64 evaluates exactly leave all results unchanged when applied to both shape and line. They scale by
    /// powers of two, permute axes, mirror, and translate by integers.
    #[test]
    fn exact_maps_change_nothing(
        kind in turned(), capped: bool, base in grid_point(2), axis in grid_point(2), shift in grid_point(50),
        o in grid_point(4), d in grid_point(2), power in -8i32..8,
    ) {
        prop_assume!(axis != DVec3::ZERO && d != DVec3::ZERO);
        let (base, tip, s) = (base, base + axis, 2f64.powi(power));
        let map = Affine::new([DVec3::Y * s, DVec3::X * s, DVec3::Z * -s], shift);
        let own: [Arc<dyn Shape>; 5] = [
            match kind {
                Turned::Cylinder(r) => Arc::new(Revolution::cylinder(base, tip, r, capped)),
                Turned::Cone(a, b) => Arc::new(Revolution::cone(base, tip, [a, b], capped)),
                Turned::Paraboloid(r) => Arc::new(Revolution::paraboloid(base, tip, r, capped)),
            },
            Arc::new(Cuboid { min: base.min(tip), max: base.max(tip) }),
            Arc::new(Ellipsoid { center: base, semi_axes: DVec3::new(1.0, 2.0, 3.0) }),
            Arc::new(Disk { center: base, normal: axis, radius: 2.0, inner_radius: 1.0 }),
            Arc::new(Plane { point: base, normal: axis }),
        ];
        for shape in own {
            let moved = Placed::new(shape.clone(), map.clone()).unwrap();
            let told = |shape: &dyn Shape, ray: &Ray| -> Vec<(f64, [f64; 2], Contact)> {
                meets(shape, ray).iter().map(|met| (met.t, met.uv, met.contact)).collect()
            };
            let here = told(&*shape, &Ray::new(o, d));
            prop_assert_eq!(here, told(&moved, &Ray::new(map.point(o), map.vector(d))), "{:?}", moved);
        }
    }

    #[test]
    fn boxes_planes_and_disks_are_met_as_fractions_say(
        a in point(), b in point(), o in point(), d in prop_oneof![any_point(2.0), grid_point(2)],
        radius in prop_oneof![0.1..5.0, Just(1.0), Just(2.0)],
    ) {
        prop_assume!(d != DVec3::ZERO && b != DVec3::ZERO);
        let ray = Ray::new(o, d);
        let cuboid = Cuboid { min: a.min(b), max: a.max(b) };
        // All distances at which the line crosses a face's plane, kept if they lie within the other slabs.
        let (eo, ed) = (vector(o), vector(d));
        let mut ts: Vec<Exact> = Vec::new();
        for i in (0..3).filter(|&i| d[i] != 0.0) {
            for plane in [cuboid.min[i], cuboid.max[i]] {
                let p = &Exact::new(plane) - &eo[i];
                let inside = (0..3).filter(|&j| j != i).all(|j| {
                    let x = &(&eo[j] * &ed[i]) + &(&p * &ed[j]);
                    let [low, high] = [cuboid.min[j], cuboid.max[j]].map(|m| &x - &(&Exact::new(m) * &ed[i]));
                    let (low, high) = if d[i] > 0.0 { (low, high) } else { (high, low) };
                    low.sign() != Ordering::Less && high.sign() != Ordering::Greater
                });
                if inside {
                    ts.push(p.over(&ed[i]));
                }
            }
        }
        ts.sort_by(|x, y| (x - y).sign());
        let found = meets(&cuboid, &ray);
        prop_assert_eq!(found.is_empty(), ts.is_empty());
        if let (Some(first), Some(last)) = (ts.first(), ts.last()) {
            prop_assert!(first.ulps_to(found[0].t) <= 1.0 && last.ulps_to(found[found.len() - 1].t) <= 1.0);
            prop_assert!(found.len() == 2 || found[0].contact == Contact::Touching);
        }
        // The plane through a normal to b, and the disk in it.
        let n = vector(b);
        let (along, height) = (dot(&n, &ed), dot(&n, &minus(&vector(a), &eo)));
        let plane = Plane { point: a, normal: b };
        let disk = Disk { center: a, normal: b, radius, inner_radius: radius / 4.0 };
        let (on_plane, on_disk) = (meets(&plane, &ray), meets(&disk, &ray));
        prop_assert_eq!(on_plane.len(), usize::from(along.sign() != Ordering::Equal));
        if let Some(met) = on_plane.first() {
            prop_assert!(height.over(&along).ulps_to(met.t) <= 1.0);
            let x: Vector = [0, 1, 2].map(|i| &(&(&eo[i] - &Exact::new(a[i])) * &along) + &(&ed[i] * &height));
            let square = dot(&x, &x);
            let within = |r: f64| (&square - &(&(&Exact::new(r) * &Exact::new(r)) * &(&along * &along))).sign();
            let wanted = within(radius) != Ordering::Greater && within(radius / 4.0) != Ordering::Less;
            prop_assert_eq!(on_disk.len(), usize::from(wanted));
        }
    }
}

/// Directions and positions that have broken intersection routines.
#[test]
fn hard_cases_are_met_as_the_oracle_says() -> Result<(), TestCaseError> {
    let unit = |x: f64, y: f64, z: f64| DVec3::new(x, y, z).normalize();
    let mut met = 0;
    for i in 0..200 {
        let a = f64::from(i) / 200.0;
        let (sin, cos) = (a * 6.3).sin_cos();
        let way = unit(cos, sin, a - 0.5);
        // A sphere of 1 mm at 10 km, aimed very near its rim.
        let side = way.any_orthonormal_vector() * 1e-3 * (1.0 + f64::from(i - 100) * 1e-14);
        met += check_sphere(way * 1e4, 1e-3, &Ray::new(DVec3::ZERO, way * 1e4 + side))?;
        // A sphere of radius 1000 km, from its surface, tangentially and inward.
        let start = way * 1e6;
        met += check_sphere(DVec3::ZERO, 1e6, &Ray::new(start, unit(sin, cos, a)))?;
        met += check_sphere(DVec3::ZERO, 1e6, &Ray::new(start, way.any_orthonormal_vector()))?;
        // A thin cylinder far away.
        let base = way * 1e4;
        let tip = base + unit(sin, a, cos) * 10.0;
        let target = base.lerp(tip, a) + side * 0.1;
        met += check_turned(Turned::Cylinder(1e-4), base, tip, i % 2 == 0, &Ray::new(DVec3::ZERO, target))?;
        // Along the axis, inside and outside, for an axis that no frame represents exactly.
        let axis = DVec3::new(1.0, 3.0, 7.0);
        let foot = DVec3::new(0.1, 0.2, 0.3);
        let from = foot - axis + axis.any_orthonormal_vector() * (2.0 * a);
        for kind in [Turned::Cylinder(1.0), Turned::Cone(1.5, 0.5), Turned::Cone(1.0, 0.0), Turned::Paraboloid(1.0)] {
            met += check_turned(kind, foot, foot + axis, true, &Ray::new(from, axis))?;
            met += check_turned(kind, foot, foot + axis, false, &Ray::new(from, axis))?;
        }
        // Through the apex of a cone.
        let apex = DVec3::new(2.0, 4.0, -8.0);
        let d = DVec3::new(f64::from(i % 7) - 3.0, f64::from(i % 5) - 2.0, f64::from(i % 3) - 1.0);
        if d != DVec3::ZERO {
            for capped in [true, false] {
                let ray = Ray::new(apex - d, d);
                met += check_turned(Turned::Cone(3.0, 0.0), DVec3::ZERO, apex, capped, &ray)?;
            }
        }
        let flat = DVec3::new(1.0, 1e-4, 1e4);
        let target = DVec3::new(cos, sin * 1e-4, (a - 0.5) * 2e4);
        met += check_ellipsoid(
            DVec3::ZERO,
            flat,
            &Ray::new(DVec3::new(3.0, 40.0, 1e3), target - DVec3::new(3.0, 40.0, 1e3)),
        )?;
        met += check_ellipsoid(DVec3::ZERO, flat, &Ray::new(target, way))?;
    }
    assert!(met > 2000, "{met}");
    Ok(())
}

#[test]
fn a_start_on_the_surface_is_at_zero_and_only_there() {
    let starts: [(&dyn Shape, DVec3); 6] = [
        (&Sphere { center: DVec3::ZERO, radius: 5.0 }, DVec3::new(3.0, 0.0, -4.0)),
        (&Revolution::cylinder(DVec3::ZERO, DVec3::Z, 5.0, true), DVec3::new(-3.0, 4.0, 0.5)),
        (&Revolution::cone(DVec3::ZERO, DVec3::Z * 5.0, [5.0, 0.0], true), DVec3::new(-1.5, 2.0, 2.5)),
        (&Revolution::paraboloid(DVec3::ZERO, DVec3::Z * 4.0, 2.0, true), DVec3::new(1.0, 0.0, 1.0)),
        (&Ellipsoid { center: DVec3::X, semi_axes: DVec3::new(5.0, 10.0, 5.0) }, DVec3::new(4.0, 0.0, -4.0)),
        (&Cuboid { min: DVec3::ZERO, max: DVec3::ONE }, DVec3::new(0.25, 0.5, 0.0)),
    ];
    for (shape, start) in starts {
        for d in [DVec3::new(0.3, -0.4, 0.5), DVec3::new(-0.1, 0.2, -0.9), DVec3::new(1e-30, 2e-30, 1e-30)] {
            let ts: Vec<f64> = meets(shape, &Ray::new(start, d)).iter().map(|met| met.t).collect();
            assert!(ts.contains(&0.0), "{shape:?} {d}: {ts:?}");
            let ahead = Ray { t_min: f64::from_bits(1), ..Ray::new(start, d) };
            shape.meet(&ahead, &mut |met| {
                assert!(met.t > 1e-6, "{shape:?} {d}: {met:?}");
                false
            });
        }
    }
}

#[test]
fn the_interval_is_closed_and_bad_rays_meet_nothing() {
    let sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };
    let count = |ray: &Ray| {
        let mut count = 0;
        sphere.meet(ray, &mut |_| {
            count += 1;
            false
        });
        count
    };
    let ray = Ray::new(DVec3::new(-3.0, 0.0, 0.0), DVec3::X);
    assert_eq!(count(&Ray { t_min: 2.0, t_max: 4.0, ..ray }), 2);
    assert_eq!(count(&Ray { t_min: 2f64.next_up(), t_max: 4f64.next_down(), ..ray }), 0);
    for bad in [DVec3::ZERO, DVec3::NAN, DVec3::new(f64::INFINITY, 0.0, 0.0)] {
        assert_eq!(count(&Ray { direction: bad, ..ray }), 0);
    }
    assert_eq!(count(&Ray { origin: DVec3::NAN, ..ray }), 0);
    assert_eq!(count(&Ray { t_max: f64::NAN, ..ray }), 0);
    // Near the largest and smallest f64.
    let large = Sphere { center: DVec3::splat(1e300), radius: 1e299 };
    assert_eq!(meets(&large, &Ray::new(DVec3::ZERO, DVec3::splat(1e-300))).len(), 0);
    assert_eq!(meets(&large, &Ray::new(DVec3::ZERO, DVec3::ONE)).len(), 2);
    let small = Sphere { center: DVec3::splat(1e-300), radius: 1e-301 };
    assert_eq!(meets(&small, &Ray::new(DVec3::ZERO, DVec3::splat(1e-30))).len(), 2);
}
