//! Samples of incident light.

use super::LightSampleContext;
use crate::RayOrigin;
use raywright_base::math::{DVec3, Ray};
use raywright_optics::Rgb;

/// A sample of incident light at a receiver.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub direction: DVec3,
    /// Unoccluded radiance over density.
    pub weight: Rgb,
    /// Density by solid angle. It is infinite for a delta light, so that MIS gives the sample all the weight.
    pub pdf: f64,
    /// Position on the light; `None` for infinite lights.
    pub source: Option<RayOrigin>,
    /// Primitive of the light; [`Ray::NO_TRIANGLE`] if the light is not a primitive.
    pub primitive: u32,
}

impl LightSample {
    /// Light from an infinite light.
    #[inline]
    pub(super) fn of_infinite(direction: DVec3, weight: Rgb, pdf: f64) -> Self {
        Self { direction, weight, pdf, source: None, primitive: Ray::NO_TRIANGLE }
    }

    /// Light from a point light whose intensity depends on the direction away from it. `None` if the intensity is 0, or
    /// the receiver is at the light itself.
    #[inline]
    pub(super) fn of_point(
        position: DVec3,
        receiver: &LightSampleContext,
        intensity: impl FnOnce(DVec3) -> Rgb,
    ) -> Option<Self> {
        let way = position - receiver.position;
        let distance = way.length();
        // At the light itself the direction is undefined.
        if distance == 0.0 {
            return None;
        }
        let direction = way / distance;
        let weight = intensity(-direction) / (distance * distance);
        let source = Some(RayOrigin::free(position));
        let one = Self { direction, weight, pdf: f64::INFINITY, source, primitive: Ray::NO_TRIANGLE };
        (!weight.is_black()).then_some(one)
    }

    /// Accounts for the selection probability of the light, or for the number of samples if it is above 1.
    #[inline]
    pub fn chosen(self, probability: f64) -> Self {
        Self { weight: self.weight / probability, pdf: self.pdf * probability, ..self }
    }
}
