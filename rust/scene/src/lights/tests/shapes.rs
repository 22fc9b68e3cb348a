//! Surfaces of all kinds as lights, by solid angle: tiny, distant, near and edge-on.

use super::super::{Emission, LightSampleContext, Sides};
use super::{FLOOR, Grid, assert_near, draw, irradiance_at, white};
use crate::fixtures::{scene, shape};
use crate::{Mesh, Scene, SceneDescription, Shape};
use raywright_accel::Primitives;
use raywright_base::math::{Affine, DVec3, Hit, Ray};
use raywright_base::sampling::chi_square::assert_frequencies;
use raywright_shapes::{Cuboid, Disk, Ellipsoid, Placed, Shape as _, Sphere};
use std::f64::consts::PI;
use std::sync::Arc;

fn triangle(corners: [DVec3; 3], radiance: f64) -> Scene {
    let mesh = Mesh { vertices: crate::Vertices::Double(corners.to_vec()), faces: vec![[0, 1, 2]], ..Mesh::default() };
    scene(SceneDescription { shapes: vec![shape(mesh, [0.0; 3], radiance)], ..Default::default() })
}

fn round(surface: Arc<dyn raywright_shapes::Shape>, radiance: f64) -> Scene {
    let shapes = vec![Shape { surface: surface.into(), emission: white(radiance).into(), ..Shape::default() }];
    scene(SceneDescription { shapes, ..Default::default() })
}

/// Irradiance of a triangle of radiance 1 (Lambert, 1760): half the sum over edges of the subtended angle times the
/// unit normal of the plane through edge and receiver, as a vector. The triangle must be above the horizon.
pub(super) fn lambert(corners: [DVec3; 3], receiver: &LightSampleContext) -> f64 {
    let c = corners.map(|corner| (corner - receiver.position).normalize());
    let edge = |a: DVec3, b: DVec3| {
        let cross = a.cross(b);
        cross.normalize() * cross.length().atan2(a.dot(b))
    };
    (0.5 * (edge(c[0], c[1]) + edge(c[1], c[2]) + edge(c[2], c[0])).dot(receiver.normal)).abs()
}

/// A triangle that faces the floor, rotated and stretched.
const LAMP: [DVec3; 3] = [DVec3::new(0.3, -0.2, 0.5), DVec3::new(-0.4, 0.9, 0.8), DVec3::new(1.1, 0.4, 0.3)];

#[test]
fn triangles_give_lamberts_irradiance_at_any_distance() {
    for scale in [1e-2, 0.05, 0.2, 0.5, 1.0, 1.5] {
        // The same size, moved up: near ones by solid angle, distant ones by area.
        let corners = LAMP.map(|c| (c - LAMP[0]) * scale + DVec3::new(0.1, 0.0, 0.4));
        let expected = lambert(corners, &FLOOR);
        assert_near(irradiance_at(&triangle(corners, 1.0), &FLOOR, 20_000), expected, 0.01);
    }
    // At a distance of 10⁷, where its solid angle is 10⁻¹⁴.
    let far = LAMP.map(|c| c + DVec3::new(0.0, 0.0, 1e7));
    let area = 0.5 * (LAMP[1] - LAMP[0]).cross(LAMP[2] - LAMP[0]).z.abs();
    let found = irradiance_at(&triangle(far, 1.0), &FLOOR, 1000).0;
    assert!((found / (area * 1e-14) - 1.0).abs() < 1e-6, "{found}");
    // With an area of 10⁻¹⁴, like a point light.
    let tiny = LAMP.map(|c| (c - LAMP[0]) * 1e-7 + DVec3::Z);
    let found = irradiance_at(&triangle(tiny, 1.0), &FLOOR, 1000).0;
    assert!((found / (area * 1e-14) - 1.0).abs() < 1e-6, "{found}");
}

#[test]
fn next_to_its_plane_a_triangle_keeps_its_digits() {
    // The receiver approaches the triangle's plane until points are sampled by area. The total light equals the solid
    // angle (van Oosterom and Strackee, 1983), where the determinant of the corners is the height.
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    for height in [1e-1, 1e-3, 1e-6, 1e-8, 1e-10, 1e-14] {
        for (x, y) in [(-0.01, 0.5), (0.7, 0.7), (0.25, 0.25), (-0.3, -0.3)] {
            let position = DVec3::new(x, y, height);
            let [a, b, c] = corners.map(|corner| corner - position);
            let sizes = [a, b, c].map(DVec3::length);
            let below =
                sizes[0] * sizes[1] * sizes[2] + a.dot(b) * sizes[2] + b.dot(c) * sizes[0] + c.dot(a) * sizes[1];
            let found = irradiance_at(&triangle(corners, 1.0), &LightSampleContext::free(position), 4000);
            let expected = 2.0 * height.atan2(below);
            assert!(
                (found.0 - expected).abs() <= 5.0 * found.1 + 1e-6 * expected,
                "{height:e} {x} {y}: {found:?} {expected}"
            );
            // With uniform sampling all samples have equal weight.
            assert!(found.1 <= if expected > 1e-8 { 1e-6 } else { 0.2 } * expected, "{height:e} {x} {y}: {found:?}");
            // With a cosine: Lambert's formula keeps enough digits if the height is not too small.
            let towards = LightSampleContext {
                position,
                normal: (DVec3::new(0.3, 0.3, 0.0) - position).normalize(),
                waves: None,
            };
            if height >= 1e-6 && x != 0.25 {
                let expected = lambert(corners, &towards);
                let found = irradiance_at(&triangle(corners, 1.0), &towards, 4000);
                assert!((found.0 - expected).abs() <= 5.0 * found.1 + 1e-6 * expected, "{found:?} {expected}");
            }
        }
    }
    // In the plane itself the triangle is invisible.
    for (x, y) in [(0.25, 0.25), (2.0, 2.0), (0.0, 0.0)] {
        let receiver = LightSampleContext { position: DVec3::new(x, y, 0.0), normal: DVec3::X, waves: None };
        assert_eq!(irradiance_at(&triangle(corners, 1.0), &receiver, 200).0, 0.0);
    }
}

#[test]
fn near_triangles_are_drawn_evenly_by_solid_angle() {
    let lit = triangle(LAMP, 1.0);
    let grid = Grid { rows: 24, columns: 24 };
    let seen = grid.integrals(12, |direction| {
        let mut hits = [Hit::MISS];
        lit.intersect(&[Ray::new(DVec3::ZERO, direction)], &mut hits);
        f64::from(u8::from(hits[0].is_hit()))
    });
    let mut counts = vec![0; seen.len()];
    for number in 0..20_000 {
        counts[grid.cell(draw(&lit, &FLOOR, number).unwrap().direction)] += 1;
    }
    // Cells on the triangle's border are measured roughly and merged into one.
    let whole: f64 = seen.iter().sum();
    let full = 4.0 * PI / seen.len() as f64 * (1.0 - 1e-9);
    let (mut sure, mut expected, mut rest) = (vec![0], vec![0.0], 0);
    for (&count, &angle) in counts.iter().zip(&seen) {
        if angle >= full {
            sure.push(count);
            expected.push(angle / whole);
        } else {
            rest += count;
        }
    }
    (sure[0], expected[0]) = (rest, 1.0 - expected.iter().sum::<f64>());
    assert!(sure.len() > 20, "{}", sure.len());
    assert_frequencies(&sure, &expected);
    let pdf = draw(&lit, &FLOOR, 0).unwrap().pdf;
    assert!((pdf * whole - 1.0).abs() < 0.01, "{pdf} {whole}");
}

#[test]
fn sides_shine_where_they_are_to() {
    let sheet = |sides| {
        let mesh =
            Mesh { vertices: LAMP.map(|c| c.as_vec3()).to_vec().into(), faces: vec![[0, 1, 2]], ..Mesh::default() };
        let emission = Emission { sides, ..white(1.0).into() };
        scene(SceneDescription { shapes: vec![Shape { emission, ..shape(mesh, [0.0; 3], 0.0) }], ..Default::default() })
    };
    let single = LAMP.map(|c| c.as_vec3().as_dvec3());
    let above = LightSampleContext { position: DVec3::new(0.2, 0.3, 2.0), normal: DVec3::NEG_Z, waves: None };
    let faces_up = (LAMP[1] - LAMP[0]).cross(LAMP[2] - LAMP[0]).z > 0.0;
    let (front, back) = if faces_up { (above, FLOOR) } else { (FLOOR, above) };
    for (sides, lit) in [(Sides::Front, [true, false]), (Sides::Back, [false, true]), (Sides::Both, [true, true])] {
        for (receiver, lit) in [&front, &back].into_iter().zip(lit) {
            let found = irradiance_at(&sheet(sides), receiver, 20_000);
            if lit { assert_near(found, lambert(single, receiver), 0.01) } else { assert_eq!(found, (0.0, 0.0)) }
        }
    }
}

#[test]
fn within_what_shines_inwards_there_is_light_from_everywhere() {
    // Irradiance π L everywhere inside, for any orientation, and none outside.
    let map = Affine::from_matrix([[1.5, 0.2, 0.0, 0.1], [-0.4, 0.8, 0.3, -0.2], [0.1, 0.2, 2.0, 0.3]]);
    let closed: [Arc<dyn raywright_shapes::Shape>; 4] = [
        Arc::new(Sphere { center: DVec3::new(0.1, 0.2, 0.0), radius: 1.0 }),
        Arc::new(Ellipsoid { center: DVec3::ZERO, semi_axes: DVec3::new(1.0, 0.7, 3.0) }),
        Arc::new(Cuboid { min: DVec3::splat(-0.8), max: DVec3::splat(1.3) }),
        Arc::new(Placed::new(Arc::new(Sphere::UNIT), map).unwrap()),
    ];
    for surface in closed {
        let of = |sides| {
            let emission = Emission { sides, ..white(2.0).into() };
            let shapes = vec![Shape { surface: surface.clone().into(), emission, ..Shape::default() }];
            scene(SceneDescription { shapes, ..Default::default() })
        };
        let within = [(DVec3::ZERO, DVec3::Z), (DVec3::new(0.4, 0.1, -0.3), DVec3::new(0.6, 0.0, -0.8))];
        for (position, normal) in within {
            let receiver = LightSampleContext { position, normal, waves: None };
            for (sides, expected) in [(Sides::Back, 2.0 * PI), (Sides::Both, 2.0 * PI), (Sides::Front, 0.0)] {
                assert_near(irradiance_at(&of(sides), &receiver, 20_000), expected, 0.03);
            }
        }
        let outside = LightSampleContext { position: DVec3::new(0.5, 0.3, -9.0), normal: DVec3::Z, waves: None };
        assert_eq!(irradiance_at(&of(Sides::Back), &outside, 2000), (0.0, 0.0));
        assert!(irradiance_at(&of(Sides::Front), &outside, 2000).0 > 0.05);
    }
}

#[test]
fn disks_give_the_textbook_irradiance() {
    // E = π L r² / (r² + h²) below the center (Howell, C-41 with one small disk), down to a disk of area 10⁻¹².
    for (radius, height) in
        [(1.0, 1.0), (1.0, 0.3), (1.0, 1e-3), (0.01, 1.0), (5.641_895_835_477_563e-7, 1.0), (2.0, 1e7)]
    {
        let disk = Disk { center: DVec3::Z * height, normal: DVec3::NEG_Z, radius, inner_radius: 0.0 };
        let expected = PI * radius * radius / (radius * radius + height * height);
        assert_near(irradiance_at(&round(Arc::new(disk), 1.0), &FLOOR, 20_000), expected, 0.01);
        let ring = Disk { center: DVec3::Z * height, normal: DVec3::NEG_Z, radius, inner_radius: 0.5 * radius };
        let hole = PI * 0.25 * radius * radius / (0.25 * radius * radius + height * height);
        assert_near(irradiance_at(&round(Arc::new(ring), 1.0), &FLOOR, 100_000), expected - hole, 0.1);
    }
}

#[test]
fn near_a_disk_drawing_by_solid_angle_leaves_a_fraction_of_the_variance() {
    // Beside and above the disk the density is within a small factor of the inverse solid angle, while that of area
    // sampling varies with the squared distance.
    let disk = Disk { center: DVec3::ZERO, normal: DVec3::Z, radius: 1.0, inner_radius: 0.0 };
    for place in [DVec3::new(0.2, 0.1, 0.01), DVec3::new(1.3, 0.0, 0.05), DVec3::new(0.0, 0.9, 0.3)] {
        // Mean and variance of the solid angle over a regular grid of samples, hence deterministic.
        let moments = |side: u32, solid_angle: &dyn Fn([f64; 2]) -> f64| {
            let (mut sum, mut squares, count) = (0.0, 0.0, f64::from(side * side));
            for i in 0..side {
                for j in 0..side {
                    let x = solid_angle([i, j].map(|i| (f64::from(i) + 0.5) / f64::from(side)));
                    sum += x / count;
                    squares += x * x / count;
                }
            }
            (sum, squares - sum * sum)
        };
        let own = moments(100, &|u| disk.sample_from(place, u).map_or(0.0, |drawn| 1.0 / drawn.pdf));
        let area = moments(1000, &|u| {
            let drawn = disk.sample(u).unwrap();
            let way = drawn.point.position - place;
            way.normalize().z.abs() / way.length_squared() / drawn.pdf
        });
        assert!((own.0 / area.0 - 1.0).abs() < 0.01, "{own:?} {area:?}");
        assert!(own.1 < 0.25 * area.1, "{place} {own:?} {area:?}");
    }
}

#[test]
fn spheres_give_the_textbook_irradiance_down_to_points() {
    // E = π L (R/d)² for a sphere directly above; at constant power a radius of 10⁻⁵ is a point light.
    for (radius, distance) in [(0.5, 2.0), (1e-5, 1.0), (1e-5, 1e7), (1e6, 1e6 + 1.0)] {
        let sphere = Sphere { center: DVec3::Z * distance, radius };
        // Intensity 1: π R² L.
        let radiance = 1.0 / (PI * radius * radius);
        let expected = 1.0 / (distance * distance);
        let share = if radius > distance / 2.0 { 0.01 } else { 0.002 };
        assert_near(irradiance_at(&round(Arc::new(sphere), radiance), &FLOOR, 20_000), expected, share);
    }
}

#[test]
fn a_draw_of_any_primitive_has_the_density_that_its_hit_is_told() {
    let shapes: [Arc<dyn raywright_shapes::Shape>; 3] = [
        Arc::new(Sphere { center: DVec3::new(0.5, 0.2, 1.5), radius: 0.7 }),
        Arc::new(Disk {
            center: DVec3::new(0.0, 0.1, 0.6),
            normal: DVec3::new(0.2, 0.0, -1.0),
            radius: 1.0,
            inner_radius: 0.0,
        }),
        Arc::new(Disk {
            center: DVec3::new(9.0, 0.1, 5.0),
            normal: DVec3::new(-1.0, 0.0, -1.0),
            radius: 1.0,
            inner_radius: 0.4,
        }),
    ];
    let scenes = shapes
        .into_iter()
        .map(|s| round(s, 1.0))
        .chain([triangle(LAMP, 1.0), triangle(LAMP.map(|c| 0.1 * c + DVec3::Z), 1.0)]);
    for lit in scenes {
        assert_eq!(lit.geometry().count(), 1);
        let mut found = 0;
        for number in 0..500 {
            let Some(light) = draw(&lit, &FLOOR, number) else { continue };
            let ray = Ray::new(DVec3::ZERO, light.direction);
            let mut hits = [Hit::MISS];
            lit.intersect(&[ray], &mut hits);
            if !hits[0].is_hit() {
                continue;
            }
            found += 1;
            let cosine = -lit.geometry().surface(&ray, &hits[0]).normal.dot(light.direction);
            let pdf = lit.lights().surface_pdf(lit.geometry(), &FLOOR, &ray, &hits[0], cosine);
            // A rounding of the direction moves the point by 1 / cos of it.
            assert!((pdf / light.pdf - 1.0).abs() < 1e-9 / cosine, "{pdf} {}", light.pdf);
        }
        assert!(found > 200, "{found}");
    }
}
