//! Integrators against closed forms.

mod branches;
mod flights;
mod glossy;
mod kinds;
mod masks;
mod media;
mod one_by_one;
mod path;
mod reuse;
mod wavefront;

use super::{CameraSample, Integrator, Job};
use raywright_base::math::{DVec3, Ray};
use raywright_base::sampling::Sampler;
use raywright_base::workers::Cancel;
use raywright_optics::Rgb;
use raywright_scene::{Perspective, Scene};
use std::sync::LazyLock;

/// Return a job with rays without width, which no camera sends.
fn job(scene: &Scene) -> Job<'_> {
    static CAMERA: LazyLock<Perspective> =
        LazyLock::new(|| Perspective::looking_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 60.0, 1, 1).expect("a camera"));
    Job::new(scene, &*CAMERA, 0, 1)
}

/// Return the radiance of a number of samples of a ray.
fn samples_of(scene: &Scene, integrator: &dyn Integrator, ray: Ray, count: u32) -> Vec<Rgb> {
    let mut samples: Vec<_> =
        (0..count).map(|number| CameraSample { ray, sampler: Sampler::new(3, 0, number) }).collect();
    let mut values = vec![Rgb::ZERO; count as usize];
    let session = integrator.begin(job(scene), &Cancel::default());
    let mut worker = session.worker();
    for (samples, values) in samples.chunks_mut(4096).zip(values.chunks_mut(4096)) {
        worker.radiance(samples, &Cancel::default(), values);
    }
    values
}

/// Return the mean and standard error of the green radiance along a ray.
fn radiance(scene: &Scene, integrator: &dyn Integrator, ray: Ray, count: u32) -> (f64, f64) {
    let values = samples_of(scene, integrator, ray, count);
    let mean = values.iter().map(|v| v[1]).sum::<f64>() / f64::from(count);
    let variance = values.iter().map(|v| (v[1] - mean).powi(2)).sum::<f64>() / f64::from(count - 1);
    (mean, (variance / f64::from(count)).sqrt())
}

/// Assert agreement within four standard errors (false alarm rate 1 in 16,000) plus f32 rounding. The standard error
/// must be below 1 %.
#[track_caller]
fn assert_radiance(scene: &Scene, integrator: &dyn Integrator, ray: Ray, count: u32, expected: f64) {
    let (mean, error) = radiance(scene, integrator, ray, count);
    assert!(
        (mean - expected).abs() <= 4.0 * error + 4.0 * f64::from(f32::EPSILON) * expected,
        "{mean} ± {error}, not {expected}"
    );
    assert!(error < 0.01 * expected, "{error} of {expected}");
}
