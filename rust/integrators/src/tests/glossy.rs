//! Light sampling of a few lights over glossy surfaces.

use super::kinds::{DOWN, floor, of};
use super::{radiance, samples_of};
use crate::{Direct, Distributed, Integrator, Path, RayCast, Whitted};
use raywright_accel::BruteForce;
use raywright_base::cases;
use raywright_base::math::{DVec3, Frame, Hit};
use raywright_base::sampling::Sampler;
use raywright_base::simd::Level;
use raywright_optics::{AnyBsdf, Bsdf, Coated, Conductor, Rgb};
use raywright_scene::fixtures::{rectangle, scene, shape};
use raywright_scene::{
    ConstantEnvironment, DirectionalLight, EnvironmentMap, Instances, Interaction, Light, Mesh, Picture, PointLight,
    Prototype, Scene, SceneDescription, Shape, SurfaceInteraction,
};
use raywright_shapes::{Plane, Sphere};
use std::sync::Arc;

fn metal() -> AnyBsdf {
    Conductor::new(Rgb::splat(0.2), Rgb::splat(3.9), [0.2; 2]).into()
}

/// A diffuse surface under a coat.
fn glaze() -> AnyBsdf {
    Coated::new(Rgb::splat(0.5), 1.5, 0.2).into()
}

fn panel(x: f32, y: f32, half: f32) -> Mesh {
    rectangle([x - half, y - half, 1.6], [0.0, 2.0 * half, 0.0], [2.0 * half, 0.0, 0.0])
}

fn round(surface: impl raywright_shapes::Shape + 'static, radiance: f64) -> Shape {
    let surface: Arc<dyn raywright_shapes::Shape> = Arc::new(surface);
    Shape { surface: surface.into(), emission: Rgb::splat(radiance).into(), ..Shape::default() }
}

/// Panels and a ball around the metal's mirror direction, and an occluder of some of them.
fn lamps() -> Vec<Shape> {
    vec![
        shape(panel(0.0, 1.3, 0.3), [0.0; 3], 3.0),
        shape(panel(-1.2, 0.6, 0.4), [0.0; 3], 20.0),
        round(Sphere { center: DVec3::new(0.5, 1.2, 1.2), radius: 0.2 }, 9.0),
        shape(rectangle([-0.5, 0.5, 0.6], [0.4, 0.0, 0.0], [0.0, 0.6, 0.0]), [0.0; 3], 0.0),
    ]
}

fn map() -> Arc<dyn Light> {
    let texels = (0..32).map(|i| [0.1 + (i % 5) as f32; 3]).collect();
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    Arc::new(EnvironmentMap::new(Arc::new(Picture::new(8, texels).unwrap()), axes, 0.5))
}

fn over(bsdf: AnyBsdf, mut shapes: Vec<Shape>, lights: Vec<Arc<dyn Light>>) -> Scene {
    shapes.push(of(floor(), bsdf));
    scene(SceneDescription { shapes, lights })
}

/// Return the mean and standard error of the floor's radiance by BSDF sampling alone, without light sampling.
fn by_scattering(scene: &Scene, count: u32) -> (f64, f64) {
    let mut hit = [Hit::MISS];
    scene.intersect(&[DOWN], &mut hit);
    let here = SurfaceInteraction::at(scene, &DOWN, &hit[0]);
    let (mut sum, mut squares) = (0.0, 0.0);
    for number in 0..count {
        let mut sampler = Sampler::new(11, 0, number);
        let Some(next) = here.sample(&mut || sampler.one(0), Sampler::new(11, 1, number).two(0)) else { continue };
        let ray = here.ray_origin().ray(next.wi);
        scene.intersect(&[ray], &mut hit);
        let arriving = if hit[0].is_hit() {
            let surface = scene.geometry().surface(&ray, &hit[0]);
            scene.emission_at(&surface).towards(-ray.direction.dot(surface.normal), &Default::default())
        } else {
            scene.lights().infinite_radiance(ray.direction)
        };
        let x = (next.weight * arriving)[1];
        sum += x;
        squares += x * x;
    }
    let (mean, count) = (sum / f64::from(count), f64::from(count));
    (mean, ((squares / count - mean * mean) / count).sqrt())
}

/// Lights in a moving prototype, which are never sampled.
fn in_copies() -> Shape {
    let prototype = vec![shape(panel(0.2, 0.9, 0.2), [0.0; 3], 2.0)];
    let prototype = Prototype::new(prototype, |geometry| BruteForce::over(geometry, Level::Scalar)).unwrap();
    let still = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -0.3]];
    let instances = Instances::moving(Arc::new(prototype), vec![[still, still]]).unwrap();
    Shape { surface: instances.into(), ..Shape::default() }
}

#[test]
fn each_light_brings_what_scattering_finds() {
    let sky = |radiance| -> Arc<dyn Light> { Arc::new(ConstantEnvironment { radiance: Rgb::splat(radiance) }) };
    let endless = || round(Plane { point: DVec3::new(0.0, 9.0, 0.0), normal: DVec3::new(0.0, -1.0, 0.1) }, 0.4);
    for (kind, bsdf) in [metal(), glaze()].into_iter().enumerate() {
        let scenes = [
            over(bsdf, lamps(), vec![]),
            over(bsdf, lamps(), vec![map(), sky(0.3)]),
            over(bsdf, vec![], vec![map(), sky(0.3)]),
            over(bsdf, lamps().into_iter().chain([endless(), in_copies()]).collect(), vec![]),
        ];
        for (which, scene) in cases::every(2, kind, scenes.into_iter().enumerate()) {
            assert!(scene.plan().asks_each(|| bsdf.roughness()) && !scene.plan().asks_each(|| 1.0));
            let (expected, error) = by_scattering(&scene, 200_000);
            let each: [&dyn Integrator; 5] = [
                &Path { max_depth: Some(1), roulette_depth: 9, ..Path::default() },
                &Direct::default(),
                &Direct { light_samples: 3, surface_samples: 2 },
                &Direct { light_samples: 1, surface_samples: 4 },
                &Distributed { max_depth: 1, splits: 3, ..Distributed::default() },
            ];
            // Integrators that do not follow all directions miss lights that are never sampled.
            for (number, integrator) in each.into_iter().enumerate().take(if which == 3 { 4 } else { 5 }) {
                // Chance exceeds four standard errors once in 16,000 cases; there are 38.
                let (mean, other) = radiance(&scene, integrator, DOWN, 20_000);
                assert!(
                    (mean - expected).abs() < 4.0 * error.hypot(other),
                    "{which} {number}: {mean} ± {other}, not {expected} ± {error}"
                );
                assert!(other < 0.03 * mean, "{other} of {mean}");
            }
        }
    }
}

#[test]
fn lights_alone_bring_the_same() {
    // Without BSDF sampling: light samples alone, without MIS weights.
    let scene = over(glaze(), lamps(), vec![]);
    let (expected, error) = by_scattering(&scene, 400_000);
    for light_samples in [1, 2, 5] {
        let cast = RayCast { light_samples, ..RayCast::default() };
        let (mean, other) = radiance(&scene, &cast, DOWN, 40_000);
        assert!((mean - expected).abs() < 4.0 * error.hypot(other), "{mean} ± {other}, not {expected} ± {error}");
    }
}

#[test]
fn single_directions_are_shared_in_without_noise() {
    // Unoccluded point and distant lights: the resampled estimate is the sum exactly.
    let place = DVec3::new(0.3, 1.0, 1.4);
    let way = DVec3::new(0.1, -0.5, -0.8);
    let point = PointLight { position: place, intensity: Rgb::splat(2.0) };
    let lights: Vec<Arc<dyn Light>> = vec![
        Arc::new(point),
        Arc::new(PointLight { position: DVec3::NEG_Z, intensity: Rgb::splat(1e6) }),
        Arc::new(DirectionalLight::new(way, Rgb::splat(3.0))),
    ];
    let frame = Frame::new(DVec3::Z);
    let wo = frame.to_local(-DOWN.direction);
    let from = |direction: DVec3| metal().evaluate(wo, frame.to_local(direction)).0[1];
    let expected = from(place.normalize()) * 2.0 / place.length_squared() + from(-way.normalize()) * 3.0;
    let lit = over(metal(), vec![], lights);
    assert!(lit.plan().asks_each(|| 0.2));
    let each: [&dyn Integrator; 5] =
        [&Path::default(), &Direct::default(), &RayCast::default(), &Whitted::default(), &Distributed::default()];
    for integrator in each {
        for value in samples_of(&lit, integrator, DOWN, 20) {
            // Some stages are in f32.
            assert!((value[1] / expected - 1.0).abs() < 4.0 * f64::from(f32::EPSILON), "{value}, not {expected}");
        }
    }
}

#[test]
fn brightness_is_in_proportion_and_never_nan() {
    let lit = |strength: f64| {
        let lamps = lamps().into_iter().take(2).chain([shape(panel(0.5, 0.5, 1e-5), [0.0; 3], 1e3)]);
        let mut lamps: Vec<Shape> = lamps.collect();
        for lamp in &mut lamps {
            lamp.emission.radiance = (lamp.emission.radiance.mean() * strength).into();
        }
        over(metal(), lamps, vec![])
    };
    let path = Path { max_depth: Some(1), roulette_depth: 9, ..Path::default() };
    // What f32 cannot hold is followed path by path, by other numbers.
    let count = 40_000;
    let (expected, error) = radiance(&lit(1.0), &path, DOWN, count);
    for strength in [1e-280, 1e-30, 1e30, 1e280] {
        let values = samples_of(&lit(strength), &path, DOWN, count);
        assert!(values.iter().all(|rgb| rgb.is_finite()));
        let values = || values.iter().map(|rgb| rgb[1] / strength);
        let mean = values().sum::<f64>() / f64::from(count);
        let other = values().map(|value| (value - mean).powi(2)).sum::<f64>().sqrt() / f64::from(count);
        let both = error.hypot(other);
        // Four standard errors: a false alarm in 16,000.
        assert!((mean - expected).abs() < 4.0 * both, "{mean}, not {expected} ± {both}");
        assert!(both < 0.02 * expected, "{both} of {expected}");
    }
}
