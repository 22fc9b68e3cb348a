//! Bidirectional path tracing against closed forms, and strategies against each other.

use super::{Bidirectional, Merge, PathStrategy};
use crate::{CameraSample, Integrator, Job, Splat};
use raywright_base::cases;
use raywright_base::math::DVec3;
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::fixtures::scene;
use raywright_scene::{
    Camera, DiffuseMaterial, Emission, Perspective, PointLight, Scene, SceneDescription, Shape, Sides,
};
use raywright_shapes::Sphere;
use std::f64::consts::PI;
use std::sync::Arc;

/// Return the mean of a picture and its standard error, with one light path per sample.
fn mean(scene: &Scene, camera: &dyn Camera, integrator: &Bidirectional, samples: u32) -> (f64, f64) {
    let cancel = Cancel::default();
    let session = integrator.begin(Job::new(scene, camera, 0, 1), &cancel);
    let (width, height) = (camera.width(), camera.height());
    let pixels = width * height;
    let (mut worker, mut light) = (session.worker(), session.light_worker());
    let mut means = Vec::new();
    for number in 0..samples {
        let mut all: Vec<CameraSample> = (0..pixels)
            .map(|pixel| {
                let mut sampler = Sampler::new(5, pixel, number);
                let [u, v] = sampler.two(0);
                let film = [f64::from(pixel % width) + u, f64::from(pixel / width) + v];
                CameraSample { ray: camera.ray(film, [0.5; 2], 0.0).ray, sampler }
            })
            .collect();
        let mut found = vec![Rgb::ZERO; all.len()];
        session.before_samples(number..number + 1, true, &cancel);
        worker.radiance(&mut all, &cancel, &mut found);
        let mut sum: f64 = found.iter().map(|rgb| rgb.mean()).sum();
        if let Some(light) = &mut light {
            let mut samplers: Vec<Sampler> = (0..pixels).map(|path| Sampler::new(5, 1 << 31 | path, number)).collect();
            let mut splats: Vec<Splat> = Vec::new();
            light.follow(&mut samplers, &cancel, &mut splats);
            let is_on = |splat: &&Splat| {
                (0.0..f64::from(width)).contains(&splat.film[0]) && (0.0..f64::from(height)).contains(&splat.film[1])
            };
            // A mean over all pixels; each splat is divided by the number of paths per pixel.
            sum += splats.iter().filter(is_on).map(|splat| splat.light.mean()).sum::<f64>() / f64::from(pixels);
        }
        means.push(sum / f64::from(pixels));
    }
    let count = f64::from(samples);
    let mean = means.iter().sum::<f64>() / count;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// A sphere of radius 1 with inward emission.
fn ball(reflectance: f64, emission: f64) -> Shape {
    let surface = Arc::new(Sphere::UNIT) as Arc<dyn raywright_shapes::Shape>;
    let material = Arc::new(DiffuseMaterial { reflectance: Rgb::splat(reflectance).into() });
    let emission = Emission { radiance: Rgb::splat(emission).into(), sides: Sides::Back };
    Shape { surface: surface.into(), material, emission }
}

fn inside(size: u32) -> Perspective {
    let at = DVec3::new(0.2, -0.1, 0.15);
    Perspective::looking_at(at, DVec3::new(1.0, 0.3, 0.2), DVec3::Z, 70.0, size, size).unwrap()
}

/// Inside a diffuse sphere of radius 1 and reflectance ρ with a point light of intensity I at its center, light
/// reflected k times has the radiance I ρᵏ / π everywhere. Each strategy alone finds it all.
#[test]
fn each_way_alone_finds_all_paths_of_its_length() {
    let light = PointLight { position: DVec3::ZERO, intensity: Rgb::splat(PI) };
    let description = SceneDescription { shapes: vec![ball(0.5, 0.0)], lights: vec![Arc::new(light)] };
    let (scene, camera) = (scene(description), inside(8));
    for bounces in 1..=4u32 {
        let expected = 0.5f64.powi(bounces as i32);
        // A point light is never hit.
        for camera_vertices in 1..=bounces + 1 {
            let light_vertices = bounces + 2 - camera_vertices;
            let alone = Some(PathStrategy { vertices: [light_vertices, camera_vertices], merges: false });
            let way = Bidirectional { max_depth: Some(bounces), roulette_depth: 2, merge: None, alone };
            let (mean, error) = mean(&scene, &camera, &way, 200);
            assert!(error < 0.06 * expected, "{alone:?}: {error}");
            assert!((mean - expected).abs() < 4.0 * error + 1e-9, "{alone:?}: {mean} ± {error}, not {expected}");
        }
        // All lengths up to this one, weighted.
        let all = Bidirectional { max_depth: Some(bounces), ..Bidirectional::default() };
        let (mean, error) = mean(&scene, &camera, &all, 200);
        let expected = 1.0 - expected;
        assert!((mean - expected).abs() < 4.0 * error + 1e-9, "{bounces}: {mean} ± {error}, not {expected}");
    }
}

/// The same with an emissive wall: light reflected k times has ρᵏ times the emitted radiance.
#[test]
fn each_way_alone_finds_light_of_a_surface() {
    let description = SceneDescription { shapes: vec![ball(0.5, 1.0)], ..Default::default() };
    let (scene, camera) = (scene(description), inside(8));
    for bounces in 0..=3u32 {
        let expected = 0.5f64.powi(bounces as i32);
        for camera_vertices in 1..=bounces + 2 {
            let light_vertices = bounces + 2 - camera_vertices;
            // Camera rays see emitters directly.
            if bounces == 0 && light_vertices > 0 {
                continue;
            }
            let alone = Some(PathStrategy { vertices: [light_vertices, camera_vertices], merges: false });
            let way = Bidirectional { max_depth: Some(bounces), roulette_depth: 2, merge: None, alone };
            let (mean, error) = mean(&scene, &camera, &way, 200);
            assert!(error < 0.06 * expected, "{alone:?}: {error}");
            assert!((mean - expected).abs() < 4.0 * error + 1e-9, "{alone:?}: {mean} ± {error}, not {expected}");
        }
    }
}

/// Merging at any one matte vertex finds all paths of a length, except direct light. Light is uniform, so disks have no
/// bias but for the sphere's curvature. Photons at a distance d are off the plane by d²/2, and count if d² + (4² − 1)
/// d⁴/4 is below r²: an area of π d². All strategies together find the whole light less part of this bias.
#[test]
fn merges_alone_find_all_paths_of_their_length() {
    let light = PointLight { position: DVec3::ZERO, intensity: Rgb::splat(PI) };
    let description = SceneDescription { shapes: vec![ball(0.5, 0.0)], lights: vec![Arc::new(light)] };
    let (scene, camera) = (scene(description), inside(8));
    let radius = 0.05;
    let merge = Some(Merge { radius: Some(radius), photons: Some(4000), mean_of: Some(1), ..Merge::default() });
    let square: f64 = radius * radius;
    let seen = ((1.0 + 15.0 * square).sqrt() - 1.0) / (7.5 * square);
    for bounces in cases::every(2, 1, 2..=4u32) {
        let expected = 0.5f64.powi(bounces as i32);
        for light_vertices in 3..=bounces + 1 {
            let alone = Some(PathStrategy { vertices: [light_vertices, bounces + 3 - light_vertices], merges: true });
            let way = Bidirectional { max_depth: Some(bounces), roulette_depth: 9, merge, alone };
            let (mean, error) = mean(&scene, &camera, &way, 100);
            assert!(error < 0.02 * expected, "{alone:?}: {error}");
            let off = (mean - expected * seen).abs();
            assert!(off < 4.0 * error + 2e-3 * expected, "{alone:?}: {mean} ± {error}, not {expected}");
        }
        let all = Bidirectional { max_depth: Some(bounces), merge, ..Bidirectional::default() };
        let (mean, error) = mean(&scene, &camera, &all, 100);
        let expected = 1.0 - expected;
        let off = (mean - expected).abs();
        assert!(off < 4.0 * error + (1.0 - seen) * expected, "{bounces}: {mean} ± {error}, not {expected}");
    }
}
