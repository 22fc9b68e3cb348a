//! Views so narrow, as of telescopes, that directions in f32 would miss their pixels.

use super::Job;
use raywright_base::math::DVec3;
use raywright_scene::{Footprint, Scene};

/// Return whether pixels at the distance of the scene are so wide that directions in f32 miss none of them over a way.
fn tells_pixels_apart(job: &Job<'_>, way: f64) -> bool {
    /// Roundings of a direction within a pixel.
    const ROUNDINGS: f64 = 64.0;
    let Footprint { width, spread } = job.footprint;
    width + spread * distance(job) >= ROUNDINGS * f64::from(f32::EPSILON) * way
}

/// Return the distance from the camera to the far end of the scene.
fn distance(job: &Job<'_>) -> f64 {
    let middle = [job.camera.width(), job.camera.height()].map(|pixels| 0.5 * f64::from(pixels));
    let origin = job.camera.ray(middle, [0.5; 2], 0.0).ray.origin;
    let region = job.scene.region();
    (origin - region.centre).length() + region.radius
}

/// Return whether camera rays start close to the scene, in f64: where it matters, and nothing fills the space before.
pub(super) fn approaches(job: &Job<'_>) -> bool {
    let radius = job.scene.region().radius;
    let is_bounded = radius > 0.0 && radius.is_finite() && job.scene.surrounding().is_none();
    is_bounded && !tells_pixels_apart(job, distance(job))
}

/// Return whether directions in f32 suffice from where camera rays start.
pub(super) fn are_wide_enough(job: &Job<'_>) -> bool {
    let way = distance(job);
    tells_pixels_apart(job, if approaches(job) { way.min(4.0 * job.scene.region().radius) } else { way })
}

/// Return how far a ray of unit direction can start later, before it comes to the scene.
pub(super) fn approach(scene: &Scene, origin: DVec3, direction: DVec3) -> f64 {
    // All coordinates are within the radius: no point is farther from the center than √3 radii.
    let region = scene.region();
    ((region.centre - origin).dot(direction) - 2.0 * region.radius).max(0.0)
}
