//! Light that was drawn.

use super::LightSampleContext;
use crate::RayOrigin;
use raywright_base::math::{DVec3, Ray};
use raywright_optics::Rgb;

/// Light on its way to a point, drawn from a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Where it comes from, as a unit vector.
    pub direction: DVec3,
    /// Radiance over density, were nothing in between.
    pub weight: Rgb,
    /// Density in solid angle. Infinite where a single direction has all of it, as with a point light: weighed against
    /// any other way to find this direction, such a sample then gets all the weight.
    pub pdf: f64,
    /// Where it sets out; `None` if from outside the scene.
    pub source: Option<RayOrigin>,
    /// On which primitive of the scene that is; [`Ray::NO_TRIANGLE`] if on none.
    pub primitive: u32,
}

impl LightSample {
    /// Light from outside the scene.
    #[inline]
    pub(super) fn of_infinite(direction: DVec3, weight: Rgb, pdf: f64) -> Self {
        Self { direction, weight, pdf, source: None, primitive: Ray::NO_TRIANGLE }
    }

    /// Light from a point of this intensity along a direction away from it; `None` where that is 0, or at the point
    /// itself.
    #[inline]
    pub(super) fn of_point(
        position: DVec3,
        receiver: &LightSampleContext,
        intensity: impl FnOnce(DVec3) -> Rgb,
    ) -> Option<Self> {
        let way = position - receiver.position;
        let distance = way.length();
        // At the light itself there is no direction.
        if distance == 0.0 {
            return None;
        }
        let direction = way / distance;
        let weight = intensity(-direction) / (distance * distance);
        let source = Some(RayOrigin::free(position));
        let one = Self { direction, weight, pdf: f64::INFINITY, source, primitive: Ray::NO_TRIANGLE };
        (!weight.is_black()).then_some(one)
    }

    /// The same, when its light is one of several and was chosen with a probability; above 1, one of so many draws.
    #[inline]
    pub fn chosen(self, probability: f64) -> Self {
        Self { weight: self.weight / probability, pdf: self.pdf * probability, ..self }
    }
}
