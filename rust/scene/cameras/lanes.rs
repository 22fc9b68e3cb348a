//! Rays of a camera, sixteen at a time.

use super::CameraRay;
use crate::math::{LANES, Ray, VectorLanes};

/// Rays of a camera, a lane each, as [`CameraRay`] has them.
#[derive(Clone, Debug)]
pub struct CameraRayLanes {
    pub(super) origin: VectorLanes,
    pub(super) direction: VectorLanes,
    pub(super) time: [f64; LANES],
    pub(super) weight: [f64; LANES],
}

impl CameraRayLanes {
    /// No rays.
    pub const NONE: Self =
        Self { origin: VectorLanes::ZERO, direction: VectorLanes::ZERO, time: [0.0; LANES], weight: [0.0; LANES] };

    /// That of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> CameraRay {
        let ray = Ray { time: self.time[lane], ..Ray::new(self.origin.get(lane), self.direction.get(lane)) };
        CameraRay { ray, weight: self.weight[lane] }
    }

    /// Sets that of a lane.
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, CameraRay { ray, weight }: &CameraRay) {
        self.origin.set(lane, ray.origin);
        self.direction.set(lane, ray.direction);
        (self.time[lane], self.weight[lane]) = (ray.time, *weight);
    }
}
