//! Camera rays in batches of sixteen lanes.

use super::CameraRay;
use raywright_base::math::{LANES, VectorLanes};
use raywright_base::sampling::Pairs;

/// Camera rays in structure-of-arrays form; each lane is a [`CameraRay`].
#[derive(Clone, Debug)]
pub struct CameraRayLanes {
    pub(super) origin: VectorLanes,
    pub(super) direction: VectorLanes,
    pub(super) time: [f64; LANES],
    pub(super) weight: [f64; LANES],
}

impl CameraRayLanes {
    /// Sixteen empty rays.
    pub const NONE: Self =
        Self { origin: VectorLanes::ZERO, direction: VectorLanes::ZERO, time: [0.0; LANES], weight: [0.0; LANES] };

    /// Origins of the rays.
    #[inline(always)]
    pub fn origin(&self) -> &VectorLanes {
        &self.origin
    }

    /// Unit directions of the rays.
    #[inline(always)]
    pub fn direction(&self) -> &VectorLanes {
        &self.direction
    }

    /// When each sees the scene.
    #[inline(always)]
    pub fn time(&self) -> &[f64; LANES] {
        &self.time
    }

    /// How much each counts; 0 where there is no ray.
    #[inline(always)]
    pub fn weight(&self) -> &[f64; LANES] {
        &self.weight
    }

    /// Generates the ray of each lane by a scalar function.
    pub(super) fn take_each(
        &mut self,
        film: &Pairs,
        lens: &Pairs,
        time: &[f64; LANES],
        ray: impl Fn([f64; 2], [f64; 2], f64) -> CameraRay,
    ) {
        for lane in 0..LANES {
            let [film, lens] = [film, lens].map(|points| [points[0][lane], points[1][lane]]);
            self.set(lane, &ray(film, lens, time[lane]));
        }
    }

    /// Sets the ray in a lane.
    #[inline(always)]
    fn set(&mut self, lane: usize, CameraRay { ray, weight }: &CameraRay) {
        self.origin.set(lane, ray.origin);
        self.direction.set(lane, ray.direction);
        (self.time[lane], self.weight[lane]) = (ray.time, *weight);
    }
}
