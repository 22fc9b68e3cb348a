//! Wavefront stages against paths in f64.

use super::{job, samples_of};
use crate::wavefront::Wavefront;
use crate::{CameraSample, Path, Session};
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::{Sampler, warp};
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::fixtures::{cornell, furnace, rectangle, scene, shape};
use raywright_scene::{ConstantEnvironment, Light, PointLight, Scene, SceneDescription, ShadingVariant, Shape};
use std::sync::Arc;

const DEPTH: u32 = 4;

/// Return the radiance of samples in all directions from a place.
fn found(session: &dyn Session, from: DVec3, count: u32) -> Vec<Rgb> {
    let samples = (0..count).map(|number| {
        let mut sampler = Sampler::new(3, 7, number);
        let ray = Ray::new(from, warp::uniform_sphere(sampler.two(0)));
        CameraSample { ray, sampler }
    });
    let mut samples: Vec<_> = samples.collect();
    let mut values = vec![Rgb::ZERO; samples.len()];
    session.worker().radiance(&mut samples, &Cancel::default(), &mut values);
    values
}

/// Assert equal samples by wavefront stages and in f64, but for f32 rounding. A few rays pass an edge on its other
/// side.
#[track_caller]
fn assert_same(scene: &Scene, from: DVec3) {
    assert!(Wavefront::takes(scene));
    let path = Path { max_depth: Some(DEPTH), roulette_depth: u32::MAX, ..Path::default() };
    let count = 20_000;
    let stages = found(&Wavefront::new(job(scene), path.max_depth, path.roulette_depth, false), from, count);
    let session = path.begin_as(job(scene), ShadingVariant::Plain, &Cancel::default());
    let wanted = found(&*session, from, count);
    let largest = wanted.iter().map(|value| value.max()).fold(0.0, f64::max);
    assert!(largest > 0.0);
    let differ = stages.iter().zip(&wanted).filter(|&(&got, &wanted)| {
        (0..3).any(|channel| (got[channel] - wanted[channel]).abs() > 1e-3 * (wanted[channel] + 0.01 * largest))
    });
    let differ = differ.count();
    assert!(differ <= count as usize / 200, "{differ} of {count} differ");
}

#[test]
fn stages_find_what_f64_finds() {
    let (cornell, _) = cornell(4, 4);
    assert_same(&cornell, DVec3::new(0.5, 0.6, 0.9));
    assert_same(&furnace(0.5, 1.0), DVec3::new(0.1, -0.2, 0.3));
}

#[test]
fn stages_know_all_lights() {
    let floor = || shape(rectangle([-4.0, 0.0, -4.0], [0.0, 0.0, 8.0], [8.0, 0.0, 0.0]), [0.7, 0.5, 0.2], 0.0);
    let lamp = |x: f32, light: f64| shape(rectangle([x, 2.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.1, 0.3]), [0.1; 3], light);
    let sky = || Arc::new(ConstantEnvironment { radiance: Rgb::new(0.5, 1.0, 2.0) });
    let point = || Arc::new(PointLight { position: DVec3::new(0.5, 1.0, 0.0), intensity: Rgb::new(3.0, 2.0, 1.0) });
    let same = |shapes: Vec<Shape>, lights: Vec<Arc<dyn Light>>| {
        assert_same(&scene(SceneDescription { shapes, lights }), DVec3::new(0.0, 1.5, 0.3));
    };
    same(vec![floor()], vec![sky()]);
    same(vec![floor(), lamp(-1.0, 9.0)], vec![sky(), point()]);
    same(vec![floor()], vec![point()]);
    // Enough lights for a light BVH.
    same(vec![floor(), lamp(-1.0, 9.0), lamp(0.5, 4.0), lamp(2.0, 1.0)], vec![]);
}

#[test]
fn roulette_of_stages_changes_no_mean() {
    let (scene, _) = cornell(4, 4);
    let ray = Ray::new(DVec3::new(0.5, 0.6, 0.9), DVec3::new(0.48, -0.6, -0.64));
    let mean = |roulette_depth: u32| {
        let path = Path { max_depth: Some(30), roulette_depth, ..Path::default() };
        let values = samples_of(&scene, &path, ray, 60_000);
        let mean = values.iter().map(|value| value[1]).sum::<f64>() / values.len() as f64;
        let square = values.iter().map(|value| (value[1] - mean).powi(2)).sum::<f64>();
        (mean, (square / (values.len() as f64).powi(2)).sqrt())
    };
    let (wanted, error) = mean(u32::MAX);
    for depth in [0, 2, 5] {
        let (got, other) = mean(depth);
        assert!((got - wanted).abs() < 4.0 * error.hypot(other), "{depth}: {got}, not {wanted} ± {error}");
    }
}

#[test]
fn points_on_large_triangles_are_as_near_as_on_small_ones() {
    let point = PointLight { position: DVec3::new(1.0, 0.0, 1.0), intensity: Rgb::ONE };
    let lights: Vec<Arc<dyn Light>> = vec![Arc::new(point)];
    let expected = 0.5 * 0.353_553_390_593_273_73 / std::f64::consts::PI;
    let ray = Ray::new(DVec3::new(0.0, -0.6, 0.8), DVec3::new(0.0, 0.6, -0.8));
    for size in [2f32, 2e3, 2e6] {
        let ground = rectangle([-0.45 * size, -0.55 * size, 0.0], [size, 0.0, 0.0], [0.0, size, 0.0]);
        let scene = scene(SceneDescription { shapes: vec![shape(ground, [0.5; 3], 0.0)], lights: lights.clone() });
        assert!(Wavefront::takes(&scene));
        let mut samples = [0, 1, 2, 3].map(|number| CameraSample { ray, sampler: Sampler::new(3, 7, number) });
        let mut values = [Rgb::ZERO; 4];
        let session = Wavefront::new(job(&scene), None, 4, false);
        session.worker().radiance(&mut samples, &Cancel::default(), &mut values);
        for value in values {
            let off = value[1] / expected - 1.0;
            assert!(off.abs() < 8.0 * f64::from(f32::EPSILON), "{size}: {off:e}");
        }
    }
}
