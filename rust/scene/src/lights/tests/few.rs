//! Scenes with few lights, sampled one by one.

use super::super::{ConstantEnvironment, DirectionalLight, Light, LightSample, LightSampleContext, PointLight};
use super::shapes::lambert;
use super::{FLOOR, assert_near, white};
use crate::fixtures::{rectangle, scene, shape};
use crate::{Mesh, Scene, SceneDescription, Shape};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::sampling::Sampler;
use raywright_shapes::{Disk, Plane, Sphere};
use std::f64::consts::PI;
use std::sync::Arc;

/// A square of side 2 that faces down from height 1 above the point, and its irradiance at radiance 1: four times that
/// of a corner (Lambert, 1760).
fn overhead() -> Mesh {
    rectangle([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0])
}
const OVERHEAD: f64 = 1.740_839_502_734_206;

fn round(surface: impl raywright_shapes::Shape + 'static, radiance: f64) -> Shape {
    let surface: Arc<dyn raywright_shapes::Shape> = Arc::new(surface);
    Shape { surface: surface.into(), emission: white(radiance).into(), ..Shape::default() }
}

fn lit(shapes: Vec<Shape>, lights: Vec<Arc<dyn Light>>) -> Scene {
    scene(SceneDescription { shapes, lights })
}

fn point() -> Arc<dyn Light> {
    Arc::new(PointLight { position: DVec3::new(1.0, 0.0, 1.0), intensity: white(1.0) })
}

fn sky(radiance: f64) -> Arc<dyn Light> {
    Arc::new(ConstantEnvironment { radiance: white(radiance) })
}

fn draw(scene: &Scene, one: u32, receiver: &LightSampleContext, number: u32) -> Option<LightSample> {
    let mut sampler = Sampler::new(1, one, number);
    let u = sampler.two(1);
    scene.lights().sample_one(one, scene.geometry(), receiver, &mut || sampler.one(0), u)
}

/// Mean and standard error of the irradiance of one light.
fn irradiance(scene: &Scene, one: u32, draws: u32) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for number in 0..draws {
        let Some(light) = draw(scene, one, &FLOOR, number) else { continue };
        let x = light.weight[1] * light.direction.z.max(0.0);
        sum += x;
        squares += x * x;
    }
    let (mean, draws) = (sum / f64::from(draws), f64::from(draws));
    (mean, ((squares / draws - mean * mean).max(0.0) / draws).sqrt())
}

#[test]
fn each_gives_its_own_irradiance() {
    let dark = || shape(rectangle([5.0, 5.0, 1.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]), [0.5; 3], 0.0);
    let sphere = Sphere { center: DVec3::new(0.0, 0.0, 4.0), radius: 0.5 };
    let shapes = vec![dark(), shape(overhead(), [0.0; 3], 1.0), dark(), round(sphere, 3.0)];
    let all = lit(shapes, vec![point(), sky(0.2)]);
    assert_eq!(all.lights().few(), 4);
    // A panel of two triangles counts as one light, and a sphere directly above gives π L (R/d)².
    let expected = [OVERHEAD, PI * 3.0 / 64.0, 0.353_553_390_593_273_73, 0.2 * PI];
    for (one, expected) in (0..4).zip(expected) {
        assert_near(irradiance(&all, one, 60_000), expected, 0.02);
    }
}

#[test]
fn a_panel_of_unequal_halves_is_drawn_in_whole() {
    // One triangle fifty times as large as the other, and two triangles in different planes.
    for corner in [DVec3::new(0.02, -0.02, 1.0), DVec3::new(0.9, -0.8, 1.5), DVec3::new(0.5, -0.9, 0.8)] {
        let mut mesh = overhead();
        let mut corners: Vec<_> = (0..4).map(|i| mesh.vertices.get(i)).collect();
        corners[3] = corner;
        mesh.vertices = crate::Vertices::Double(corners.clone());
        let expected: f64 = mesh.faces.iter().map(|face| lambert(face.map(|i| corners[i as usize]), &FLOOR)).sum();
        let whole = lit(vec![shape(mesh, [0.0; 3], 1.0)], vec![sky(1.0)]);
        assert_eq!(whole.lights().few(), 2);
        assert_near(irradiance(&whole, 0, 60_000), expected, 0.02);
    }
}

#[test]
fn a_draw_has_the_density_that_a_hit_is_told() {
    let disk = Disk { center: DVec3::new(3.0, 0.1, 1.6), normal: DVec3::NEG_Z, radius: 1.0, inner_radius: 0.2 };
    let shapes = vec![
        round(disk, 2.0),
        shape(overhead(), [0.0; 3], 1.0),
        shape(rectangle([-9.0, -9.0, 2.0], [0.0, 1.0, 0.0], [1.5, 0.0, 1.0]), [0.0; 3], 7.0),
    ];
    let lit = lit(shapes, vec![sky(1.0), sky(0.5)]);
    let (lights, mut found) = (lit.lights(), [0; 5]);
    for (one, number) in (0..5).flat_map(|one| (0..500).map(move |number| (one, number))) {
        let Some(light) = draw(&lit, one, &FLOOR, number) else { continue };
        found[one as usize] += 1;
        if light.source.is_none() {
            // Each of two skies has its own weight.
            let both = lights.outside_weighed(&FLOOR, light.direction, |pdf| pdf / light.pdf);
            assert!((both - white(1.5)).abs().max() < 1e-12, "{both}");
            continue;
        }
        let ray = Ray::new(DVec3::ZERO, light.direction);
        let mut hits = [Hit::MISS];
        lit.intersect(&[ray], &mut hits);
        let cosine = -lit.geometry().surface(&ray, &hits[0]).normal.dot(light.direction);
        let pdf = lights.own_pdf(lit.geometry(), &FLOOR, &ray, &hits[0], cosine);
        assert!((pdf / light.pdf - 1.0).abs() < 1e-9, "{pdf} {}", light.pdf);
    }
    // Beside lamps, skies are sampled with probability 0.1.
    assert!(found[..3].iter().all(|&n| n > 400) && found[3..].iter().all(|&n| (20..90).contains(&n)), "{found:?}");
}

#[test]
fn few_are_two_to_sixteen_that_can_be_drawn() {
    let panel = |i: usize| shape(rectangle([i as f32, 0.0, 1.0], [0.0, 0.5, 0.0], [0.5, 0.0, 0.0]), [0.0; 3], 1.0);
    let panels = |n: usize| (0..n).map(panel).collect::<Vec<_>>();
    let few = |shapes, lights| lit(shapes, lights).lights().few();
    let sun: Arc<dyn Light> = Arc::new(DirectionalLight::new(DVec3::NEG_Z, white(1.0)));
    assert_eq!(few(panels(0), vec![]), 0);
    assert_eq!(few(panels(1), vec![]), 0);
    assert_eq!(few(panels(0), vec![sky(1.0)]), 0);
    assert_eq!(few(panels(0), vec![sky(1.0), sun]), 2);
    assert_eq!(few(panels(2), vec![]), 2);
    assert_eq!(few(panels(1), vec![sky(1.0)]), 2);
    assert_eq!(few(panels(16), vec![]), 16);
    assert_eq!(few(panels(16), vec![point()]), 0);
    assert_eq!(few(panels(17), vec![]), 0);
    // An emitter that cannot be sampled is not counted and has no density.
    let endless = Plane { point: DVec3::Z, normal: DVec3::NEG_Z };
    let shapes = vec![panel(0), round(endless, 1.0), panel(1)];
    let lit = lit(shapes, vec![]);
    assert_eq!(lit.lights().few(), 2);
    let ray = Ray::new(DVec3::ZERO, DVec3::new(-0.6, 0.0, 0.8));
    let mut hits = [Hit::MISS];
    lit.intersect(&[ray], &mut hits);
    assert_eq!(lit.lights().own_pdf(lit.geometry(), &FLOOR, &ray, &hits[0], 0.8), 0.0);
}

#[test]
fn power_beyond_numbers_is_shared() {
    let bright = lit(vec![shape(overhead(), [0.0; 3], 1e308)], vec![sky(1.0)]);
    for number in 0..100 {
        let light = draw(&bright, 0, &FLOOR, number).unwrap();
        assert!(light.pdf > 0.0 && light.pdf.is_finite() && light.weight.min() > 0.0);
    }
}
