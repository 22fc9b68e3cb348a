//! Emission sampling and light sampling give the same irradiance.

use super::super::{
    ConstantEnvironment, DirectionalLight, Emission, EmissionNumbers, EmissionSample, Emitters, EnvironmentMap, Light,
    LightSampleContext, Picture, PointLight, Profile, Projector, Sides, SpotLight, SunSky,
};
use super::instances::{MOVED, STRETCHED};
use super::white;
use crate::fixtures::{rectangle, scene, shape};
use crate::textures::Value;
use crate::{Instances, Prototype, Scene, SceneDescription, Shape};
use raywright_accel::BruteForce;
use raywright_base::math::{Affine, DVec3};
use raywright_base::sampling::Sampler;
use raywright_base::simd::Level;
use raywright_optics::Rgb;
use raywright_shapes::{Disk, Ellipsoid, Placed, Plane, Sphere};
use std::f64::consts::PI;
use std::sync::Arc;

/// A dark square from −1 to 1 in the plane z = 0, beside other shapes and lights.
fn over_a_patch(shapes: Vec<Shape>, lights: Vec<Arc<dyn Light>>) -> Scene {
    let patch = shape(rectangle([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]), [0.5; 3], 0.0);
    let shapes = std::iter::once(patch).chain(shapes).collect();
    scene(SceneDescription { shapes, lights })
}

fn emit(emitters: &Emitters, number: u32) -> Option<EmissionSample> {
    let mut sampler = Sampler::new(7, 1, number);
    let [choice, outside] = [sampler.one(0), sampler.one(2)];
    let (place, direction) = (sampler.two(1), sampler.two(3));
    emitters.sample(&EmissionNumbers { choice, outside, place, direction }, None)
}

/// Mean and standard error of the unoccluded flux onto the patch from both sides, by emission sampling.
fn sent(scene: &Scene, draws: u32) -> (f64, f64) {
    let emitters = scene.emitters().expect("something shines");
    let (mut sum, mut squares) = (0.0, 0.0);
    for number in 0..draws {
        let Some(drawn) = emit(&emitters, number) else { continue };
        assert!((drawn.ray.direction.length() - 1.0).abs() < 1e-12 && drawn.pdf.place > 0.0);
        let t = -drawn.ray.origin.z / drawn.ray.direction.z;
        let at = drawn.ray.at(t);
        if t > 0.0 && at.x.abs() <= 1.0 && at.y.abs() <= 1.0 {
            sum += drawn.weight.mean();
            squares += drawn.weight.mean().powi(2);
        }
    }
    let mean = sum / f64::from(draws);
    (mean, ((squares / f64::from(draws) - mean * mean).max(0.0) / f64::from(draws)).sqrt())
}

/// Mean and standard error of the same flux, by light sampling at points of the patch.
fn asked(scene: &Scene, draws: u32) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for number in 0..draws {
        let mut sampler = Sampler::new(8, 2, number);
        let [x, y] = sampler.two(3).map(|u| 2.0 * u - 1.0);
        let receiver = LightSampleContext::free(DVec3::new(x, y, 0.0));
        if let Some(light) = scene.lights().sample(scene.geometry(), &receiver, sampler.one(0), sampler.two(1)) {
            let flux = 4.0 * light.weight.mean() * light.direction.z.abs();
            sum += flux;
            squares += flux * flux;
        }
    }
    let mean = sum / f64::from(draws);
    (mean, ((squares / f64::from(draws) - mean * mean).max(0.0) / f64::from(draws)).sqrt())
}

/// Within five standard errors; the probability of exceeding them is one in two million.
fn assert_alike(name: &str, scene: &Scene) {
    let (sent, asked) = (sent(scene, 60_000), asked(scene, 60_000));
    let error = sent.1.hypot(asked.1);
    assert!((sent.0 - asked.0).abs() <= 5.0 * error + 1e-9 * asked.0, "{name}: {sent:?}, {asked:?}");
    assert!(error <= 0.03 * asked.0 && asked.0 > 0.0, "{name}: {error} of {asked:?}");
}

fn glowing(surface: Arc<dyn raywright_shapes::Shape>, sides: Sides) -> Shape {
    let emission = Emission { sides, ..white(2.0).into() };
    Shape { surface: surface.into(), emission, ..Shape::default() }
}

#[test]
fn surfaces_send_what_is_asked_of_them() {
    let lamp = |sides| {
        let mut lamp = shape(rectangle([-0.5, -0.7, 0.8], [1.2, 0.1, 0.3], [0.0, 0.9, -0.2]), [0.0; 3], 0.0);
        lamp.emission = Emission { sides, ..white(3.0).into() };
        lamp
    };
    for sides in [Sides::Back, Sides::Both] {
        assert_alike("triangles", &over_a_patch(vec![lamp(sides)], vec![]));
    }
    let ball = Arc::new(Sphere { center: DVec3::new(0.2, 0.5, 1.0), radius: 0.4 });
    let egg = Ellipsoid { center: DVec3::new(0.1, -0.4, 1.0), semi_axes: DVec3::new(0.6, 0.2, 0.3) };
    let map = Affine::from_matrix([[1.5, 0.2, 0.0, 0.3], [-0.4, 0.8, 0.3, -0.2], [0.1, 0.2, -0.5, 1.4]]);
    let placed = Placed::new(Arc::new(Sphere { center: DVec3::ZERO, radius: 0.5 }), map).unwrap();
    let disk =
        Disk { center: DVec3::new(0.0, 0.3, 0.7), normal: DVec3::new(0.2, 0.1, -1.0), radius: 0.5, inner_radius: 0.1 };
    assert_alike("a sphere", &over_a_patch(vec![glowing(ball.clone(), Sides::Front)], vec![]));
    assert_alike("an ellipsoid", &over_a_patch(vec![glowing(Arc::new(egg), Sides::Front)], vec![]));
    assert_alike("a sphere that is placed", &over_a_patch(vec![glowing(Arc::new(placed), Sides::Front)], vec![]));
    assert_alike("a disk", &over_a_patch(vec![glowing(Arc::new(disk), Sides::Both)], vec![]));
    assert_alike("both", &over_a_patch(vec![lamp(Sides::Both), glowing(ball, Sides::Front)], vec![]));
}

#[test]
fn so_do_instances() {
    let ball = Arc::new(Sphere { center: DVec3::new(0.2, 0.5, 0.1), radius: 0.3 });
    let mut panel = shape(rectangle([-0.5, -0.5, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]), [0.0; 3], 0.0);
    panel.emission = Emission { sides: Sides::Both, ..white(2.0).into() };
    let inner = vec![panel, glowing(ball, Sides::Front)];
    let prototype = Prototype::new(inner, |geometry| BruteForce::over(geometry, Level::Scalar)).unwrap();
    let instances = Instances::new(Arc::new(prototype), &[STRETCHED, MOVED]).unwrap();
    let instances = Shape { surface: instances.into(), ..Shape::default() };
    let scene = over_a_patch(vec![instances], vec![]);
    assert_eq!(scene.not_drawn(), None);
    assert_alike("instances", &scene);
}

#[test]
fn so_do_points_and_what_is_outside() {
    let at = DVec3::new(0.3, -0.2, 0.9);
    let rgb = Rgb::new(1.0, 2.0, 3.0);
    let spot = |angle: f64, falloff: f64| {
        SpotLight::new(at, DVec3::new(0.1, 0.2, -1.0), rgb, angle.to_radians(), falloff.to_radians())
    };
    let texels = |width: usize, height: usize| -> Vec<[f32; 3]> {
        (0..width * height).map(|i| [(i * i % 5) as f32, (i % 3) as f32, 1.0]).collect()
    };
    let slide = Arc::new(Picture::new(5, texels(5, 3)).unwrap());
    let around = Arc::new(Picture::new(8, texels(8, 4)).unwrap());
    let upright = [DVec3::X, DVec3::NEG_Z, DVec3::Y];
    let projector = Projector::new(slide, [at, DVec3::new(-0.2, 0.1, 0.0), DVec3::Y], 1.0, rgb).unwrap();
    let up_and_sun = |height: f64| SunSky::new([DVec3::new(1.0, 0.5, height), DVec3::Z], 3.0, rgb / 6.0, [0.01, 1.0]);
    let lights: Vec<(&str, Arc<dyn Light>)> = vec![
        ("a point", Arc::new(PointLight { position: at, intensity: rgb })),
        ("a spot", Arc::new(spot(50.0, 20.0))),
        ("a wide spot", Arc::new(spot(90.0, 30.0).with_profile(Profile::Linear))),
        ("a projector", Arc::new(projector)),
        ("a distant light", Arc::new(DirectionalLight::new(DVec3::new(0.3, 0.2, -1.0), rgb))),
        ("an even sky", Arc::new(ConstantEnvironment { radiance: rgb })),
        ("a picture", Arc::new(EnvironmentMap::new(around, upright, 2.0))),
        ("a sky", Arc::new(up_and_sun(0.7))),
        ("dusk", Arc::new(up_and_sun(-0.1))),
    ];
    for (name, light) in &lights {
        assert_alike(name, &over_a_patch(vec![], vec![light.clone()]));
    }
    assert_alike("all", &over_a_patch(vec![], lights.into_iter().map(|(_, light)| light).collect()));
}

#[test]
fn light_of_all_kinds_adds_up_to_its_power() {
    let rgb = Rgb::new(1.0, 2.0, 3.0);
    let ball = glowing(Arc::new(Sphere { center: DVec3::Z, radius: 0.5 }), Sides::Front);
    let point = PointLight { position: DVec3::Z, intensity: rgb };
    let scene = over_a_patch(vec![ball], vec![Arc::new(point)]);
    let emitters = scene.emitters().unwrap();
    // Lights are selected by power, so each sample represents the total power.
    for number in 0..100 {
        let weight = emit(&emitters, number).unwrap().weight.mean();
        assert!((weight - (PI * PI * 2.0 + 4.0 * PI * 2.0)).abs() < 1e-9 * weight, "{weight}");
    }
}

#[test]
fn what_cannot_be_drawn_is_named() {
    let dark = over_a_patch(vec![], vec![]);
    assert!(dark.emitters().is_none() && dark.not_drawn().is_none());
    let plane = || Plane { point: DVec3::NEG_Z, normal: DVec3::Z };
    let endless = |radiance: f64| Shape {
        surface: (Arc::new(plane()) as Arc<dyn raywright_shapes::Shape>).into(),
        emission: Emission { radiance: Value::from(white(radiance)), sides: Sides::Front },
        ..Shape::default()
    };
    let why = |scene: &Scene| scene.not_drawn().expect("a reason");
    assert!(why(&over_a_patch(vec![endless(1.0)], vec![])).contains("shape 1 is emissive and unbounded"));
    let sky = || Arc::new(ConstantEnvironment { radiance: white(1.0) });
    assert!(why(&over_a_patch(vec![endless(0.0)], vec![sky()])).contains("falls on shape 1"));
    assert_eq!(over_a_patch(vec![endless(0.0)], vec![]).not_drawn(), None);
}
