//! Views so narrow, as of telescopes, that directions in f32 would miss their pixels.

use super::Job;
use raywright_base::math::{Hit, Ray};
use raywright_scene::{Footprint, Scene};

/// Where the stages' camera rays start. Roundings of a direction matter by the length of a ray alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CameraStart {
    AtCamera,
    /// Before all that the scene contains.
    CloseToScene,
    /// Before their first hits, which are found in f64.
    CloseToHits,
}

impl CameraStart {
    /// Choose by the width of pixels at the distance of the scene. Media on the way to a hit must not be skipped.
    pub fn of(job: &Job<'_>) -> Self {
        let (scene, region) = (job.scene, job.scene.region());
        if tells_pixels_apart(job) {
            Self::AtCamera
        } else if !scene.plan().needs().media {
            Self::CloseToHits
        } else if scene.surrounding().is_none() && region.radius > 0.0 && region.radius.is_finite() {
            Self::CloseToScene
        } else {
            Self::AtCamera
        }
    }

    /// Return the distance of each camera ray's start from the camera.
    pub fn ways(self, scene: &Scene, rays: &[Ray]) -> Vec<f64> {
        /// Remaining share of the way.
        const REST: f64 = 1.0 / (1u64 << 20) as f64;
        let region = scene.region();
        match self {
            Self::AtCamera => vec![0.0; rays.len()],
            // All coordinates are within the radius: no point is farther from the center than √3 radii.
            Self::CloseToScene => rays
                .iter()
                .map(|ray| ((region.centre - ray.origin).dot(ray.direction) - 2.0 * region.radius).max(0.0))
                .collect(),
            Self::CloseToHits => {
                let mut hits = vec![Hit::MISS; rays.len()];
                scene.intersect(rays, &mut hits);
                let is_bounded = region.radius.is_finite();
                // A ray that misses all starts behind the scene, which its rounded direction might hit.
                let behind = |ray: &Ray| (region.centre - ray.origin).dot(ray.direction) + 2.0 * region.radius;
                let way = |(ray, hit): (&Ray, &Hit)| match hit.is_hit() {
                    true => hit.t * (1.0 - REST),
                    false if is_bounded => behind(ray).max(0.0),
                    false => 0.0,
                };
                rays.iter().zip(&hits).map(way).collect()
            }
        }
    }
}

/// Return whether pixels at the distance of the scene are so wide that directions in f32 miss none of them.
fn tells_pixels_apart(job: &Job<'_>) -> bool {
    /// Roundings of a direction within a pixel.
    const ROUNDINGS: f64 = 64.0;
    let middle = [job.camera.width(), job.camera.height()].map(|pixels| 0.5 * f64::from(pixels));
    let origin = job.camera.ray(middle, [0.5; 2], 0.0).ray.origin;
    let region = job.scene.region();
    let distance = (origin - region.centre).length() + region.radius;
    let Footprint { width, spread } = job.footprint;
    width + spread * distance >= ROUNDINGS * f64::from(f32::EPSILON) * distance
}
