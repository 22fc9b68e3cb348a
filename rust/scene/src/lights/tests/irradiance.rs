//! Irradiances with closed forms, and densities of samples.

use super::super::{ConstantEnvironment, Light, LightSampleContext, PointLight};
use super::{FLOOR, assert_near, irradiance_at};
use crate::fixtures::{rectangle, scene, shape};
use crate::{Mesh, Scene, SceneDescription, Shape};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::sampling::Sampler;
use raywright_optics::Rgb;
use std::f64::consts::PI;
use std::sync::Arc;

const DRAWS: u32 = 20_000;

fn sky(radiance: f64) -> Arc<dyn Light> {
    Arc::new(ConstantEnvironment { radiance: Rgb::splat(radiance) })
}

/// Asserts the irradiance of the floor to within a percent.
fn assert_irradiance(scene: &Scene, expected: f64) {
    assert_near(irradiance_at(scene, &FLOOR, DRAWS), expected, 0.01);
}

fn lit_by(shapes: Vec<Shape>) -> Scene {
    scene(SceneDescription { shapes, ..Default::default() })
}

/// A square of side 2 that faces down from height 1 above the point.
fn overhead() -> Mesh {
    rectangle([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0])
}

/// Its irradiance at radiance 1: four times that of a corner (Lambert, 1760).
const OVERHEAD: f64 = 1.740_839_502_734_206;

#[test]
fn rectangle_gives_lamberts_irradiance() {
    assert_irradiance(&lit_by(vec![shape(overhead(), [0.0; 3], 1.0)]), OVERHEAD);
    let up = rectangle([-1.0, -1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    assert_eq!(irradiance_at(&lit_by(vec![shape(up, [0.0; 3], 1.0)]), &FLOOR, DRAWS), (0.0, 0.0));
}

#[test]
fn triangle_gives_lamberts_irradiance() {
    let mut mesh = rectangle([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
    mesh.faces = vec![[0, 1, 3]];
    assert_irradiance(&lit_by(vec![shape(mesh, [0.0; 3], 1.0)]), 0.302_299_894_039_036_34);
}

#[test]
fn point_gives_the_inverse_square() {
    let point = PointLight { position: DVec3::new(1.0, 0.0, 1.0), intensity: Rgb::ONE };
    let lit = scene(SceneDescription { lights: vec![Arc::new(point)], ..Default::default() });
    assert_irradiance(&lit, 0.353_553_390_593_273_73);
}

#[test]
fn environment_gives_pi() {
    assert_irradiance(&scene(SceneDescription { lights: vec![sky(1.0)], ..Default::default() }), PI);
}

#[test]
fn lights_add_up() {
    let dark = rectangle([5.0, 5.0, 1.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]);
    let point = PointLight { position: DVec3::new(1.0, 0.0, 1.0), intensity: Rgb::ONE };
    let all = SceneDescription {
        shapes: vec![shape(dark.clone(), [0.5; 3], 0.0), shape(overhead(), [0.0; 3], 1.0), shape(dark, [0.5; 3], 0.0)],
        lights: vec![Arc::new(point), sky(0.01)],
    };
    assert_irradiance(&scene(all), OVERHEAD + 0.353_553_390_593_273_73 + 0.01 * PI);
}

#[test]
fn a_draw_has_the_density_that_a_hit_is_told() {
    let shapes = vec![
        shape(overhead(), [0.0; 3], 1.0),
        shape(rectangle([3.0, 3.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]), [0.5; 3], 0.0),
        shape(rectangle([-9.0, -9.0, 2.0], [0.0, 1.0, 0.0], [1.5, 0.0, 1.0]), [0.0; 3], 7.0),
    ];
    let lit = scene(SceneDescription { shapes, lights: vec![sky(1.0)] });
    let (mut from_surfaces, mut from_outside) = (0, 0);
    for number in 0..1000 {
        let mut sampler = Sampler::new(2, 0, number);
        let (choice, u) = (sampler.one(0), sampler.two(1));
        let Some(light) = lit.lights().sample(lit.geometry(), &FLOOR, choice, u) else {
            continue;
        };
        if light.source.is_none() {
            from_outside += 1;
            assert_eq!(light.pdf, lit.lights().infinite_pdf(&FLOOR, light.direction));
            continue;
        }
        from_surfaces += 1;
        let mut hits = [Hit::MISS];
        let ray = Ray::new(DVec3::ZERO, light.direction);
        lit.intersect(&[ray], &mut hits);
        let surface = lit.geometry().surface(&ray, &hits[0]);
        let cosine = -surface.normal.dot(light.direction);
        let pdf = lit.lights().surface_pdf(lit.geometry(), &FLOOR, &ray, &hits[0], cosine);
        assert!((pdf / light.pdf - 1.0).abs() < 1e-9);
    }
    assert!(from_surfaces > 100 && from_outside > 50);
}

#[test]
fn the_dark_stays_dark() {
    let lit = lit_by(vec![shape(rectangle([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.5; 3], 0.0)]);
    assert!(lit.lights().is_dark());
    assert!(
        lit.lights()
            .sample(
                lit.geometry(),
                &LightSampleContext { position: DVec3::Z, normal: DVec3::Z, waves: None },
                0.5,
                [0.5; 2]
            )
            .is_none()
    );
}

#[test]
fn what_cannot_be_hit_does_not_shine() {
    let mut mesh = overhead();
    let more = [DVec3::NAN, DVec3::splat(2.0)];
    mesh.vertices = (0..4).map(|i| mesh.vertices.get(i)).chain(more).map(|v| v.as_vec3()).collect();
    mesh.faces.extend([[0, 1, 4], [0, 5, 5], [0, 0, 1]]);
    assert_irradiance(&lit_by(vec![shape(mesh, [0.0; 3], 1.0)]), OVERHEAD);
}

#[test]
fn extreme_lights_give_their_irradiance() {
    // A sheet of area 10⁻¹² and radiance 10¹² directly above is a point light of intensity 1.
    let tiny = rectangle([-5e-7, -5e-7, 1.0], [0.0, 1e-6, 0.0], [1e-6, 0.0, 0.0]);
    let (mean, _) = irradiance_at(&lit_by(vec![shape(tiny, [0.0; 3], 1e12)]), &FLOOR, DRAWS);
    assert!((mean - 1.0).abs() < 1e-5, "{mean}");
    for strength in [1e-30, 1e30] {
        assert_irradiance(&lit_by(vec![shape(overhead(), [0.0; 3], strength)]), strength * OVERHEAD);
    }
    // Its power overflows.
    assert!(!lit_by(vec![shape(overhead(), [0.0; 3], 1e308); 3]).lights().is_dark());
}
