//! Densities computed from both ends of a light segment agree.

use super::super::{
    Aim, ConstantEnvironment, DirectionalLight, Emission, EmissionDensity, EmissionNumbers, Emitters, Light,
    LightSampleContext, PointLight, Sides, Source, SpotLight,
};
use super::white;
use crate::fixtures::{rectangle, scene, shape};
use crate::{Scene, SceneDescription, Shape};
use raywright_base::math::{DVec3, Hit, Ray};
use raywright_base::sampling::{Sampler, warp};
use raywright_optics::Rgb;
use raywright_shapes::{Disk, Sphere};
use std::sync::Arc;

/// Lights of every kind.
fn lit() -> Scene {
    let mut lamp = shape(rectangle([-0.5, -0.7, 0.8], [1.2, 0.1, 0.3], [0.0, 0.9, -0.2]), [0.0; 3], 0.0);
    lamp.emission = Emission { sides: Sides::Both, ..white(3.0).into() };
    let ball = Arc::new(Sphere { center: DVec3::new(2.2, 0.5, 1.0), radius: 0.4 }) as Arc<dyn raywright_shapes::Shape>;
    let disk =
        Disk { center: DVec3::new(0.0, 2.3, 0.7), normal: DVec3::new(0.2, 0.1, -1.0), radius: 0.5, inner_radius: 0.1 };
    let disk = Arc::new(disk) as Arc<dyn raywright_shapes::Shape>;
    let glowing = |surface: Arc<dyn raywright_shapes::Shape>| Shape {
        surface: surface.into(),
        emission: white(2.0).into(),
        ..Shape::default()
    };
    let rgb = Rgb::splat(2.0);
    let spot = SpotLight::new(DVec3::new(0.0, 0.0, 3.0), DVec3::new(0.1, 0.2, -1.0), rgb, 0.7, 0.2);
    let lights: Vec<Arc<dyn Light>> = vec![
        Arc::new(PointLight { position: DVec3::new(-1.0, 0.0, 2.0), intensity: rgb }),
        Arc::new(spot),
        Arc::new(ConstantEnvironment { radiance: Rgb::splat(0.3) }),
        Arc::new(DirectionalLight::new(DVec3::new(0.1, 0.2, -1.0), rgb)),
    ];
    scene(SceneDescription { shapes: vec![lamp, glowing(ball), glowing(disk)], lights })
}

/// Two guiding spheres; one contains a lamp.
fn balls() -> Aim {
    Aim::at(vec![(DVec3::new(0.6, 0.3, 0.1), 0.3), (DVec3::new(2.2, 0.4, 1.0), 0.6)])
}

/// Emission without and with guiding.
fn each_aim(scene: &Scene) -> [Emitters<'_>; 2] {
    [Aim::default(), balls()].map(|aim| scene.emitters().unwrap().aimed(aim))
}

fn assert_same(a: f64, b: f64, what: &dyn std::fmt::Debug) {
    assert!((a - b).abs() <= 1e-7 * a.abs() && a > 0.0, "{a} {b}: {what:?}");
}

#[test]
fn light_that_was_drawn_is_as_likely_as_is_told() {
    let scene = lit();
    for emitters in each_aim(&scene) {
        drawn_as_told(&emitters);
    }
}

fn drawn_as_told(emitters: &Emitters<'_>) {
    let mut kinds = [0; 4];
    for number in 0..5000 {
        let mut sampler = Sampler::new(3, 0, number);
        let numbers = EmissionNumbers {
            choice: sampler.one(0),
            outside: sampler.one(2),
            place: sampler.two(1),
            direction: sampler.two(3),
        };
        let Some(drawn) = emitters.sample(&numbers, None) else { continue };
        let EmissionDensity { source, density, .. } = emitters.of_sample(&drawn);
        kinds[match source {
            Source::Surface(_) => 0,
            Source::Point(_) => 1,
            Source::Infinite => 2,
            Source::Direction(_) => 3,
        }] += 1;
        if let Source::Direction(_) = source {
            assert_eq!(drawn.pdf.direction, f64::INFINITY);
        } else {
            assert_same(drawn.pdf.place * drawn.pdf.direction, density, &drawn);
        }
    }
    assert!(kinds.iter().all(|&count| count > 20), "{kinds:?}");
}

#[test]
fn light_that_is_asked_for_is_as_likely_from_its_other_end() {
    let scene = lit();
    for emitters in each_aim(&scene) {
        asked_as_told(&scene, &emitters);
    }
}

fn asked_as_told(scene: &Scene, emitters: &Emitters<'_>) {
    let (mut single, mut met) = (0, 0);
    for number in 0..5000 {
        let mut sampler = Sampler::new(4, 0, number);
        let position = DVec3::new(sampler.one(4), sampler.one(6), -sampler.one(8));
        let normal = if number % 2 == 0 { DVec3::ZERO } else { warp::uniform_sphere(sampler.two(5)) };
        let receiver = LightSampleContext { position, normal, waves: None };
        let Some((light, departure, density)) = emitters.sample_direct(&receiver, sampler.one(0), sampler.two(1))
        else {
            continue;
        };
        let distance = light.source.map_or(1.0, |source| source.position().distance(position));
        let told = emitters.asked_from(&receiver, &departure, -light.direction, distance);
        assert_same(density, told, &departure);
        assert_eq!(departure.is_single(), light.pdf == f64::INFINITY);
        single += u32::from(departure.is_single());
        let ray = Ray::new(position, light.direction);
        let mut hits = [Hit::MISS];
        scene.intersect(&[ray], &mut hits);
        match departure.source {
            Source::Infinite => {
                assert_same(departure.density, emitters.of_environment(light.direction).density, &departure)
            }
            Source::Surface(_) if (hits[0].t - distance).abs() < 1e-9 => {
                let surface = scene.geometry().surface(&ray, &hits[0]);
                let found = emitters.of_hit(&ray, &hits[0], &surface).unwrap();
                assert_eq!(found.source, departure.source);
                // Divided by the cosine, because a grazing hit has fewer digits.
                assert!((found.density / departure.density - 1.0).abs() < 1e-6 / departure.cosine.min(1.0));
                met += 1;
            }
            _ => {}
        }
    }
    assert!(single > 500 && met > 500, "{single} {met}");
}
