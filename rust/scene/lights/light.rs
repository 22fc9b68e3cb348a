//! What every light that is no surface can be asked, and what is drawn from one.

use super::{LightBounds, LightSampleContext};
use crate::math::{DVec3, Ray};
use crate::optics::Rgb;
use crate::scene::RayOrigin;
use std::fmt::Debug;

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
    pub(super) fn of_outside(direction: DVec3, weight: Rgb, pdf: f64) -> Self {
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
        (weight != Rgb::ZERO).then_some(one)
    }

    /// The same, when its light is one of several and was chosen with a probability.
    #[inline]
    pub(super) fn chosen(self, probability: f64) -> Self {
        Self { weight: self.weight / probability, pdf: self.pdf * probability, ..self }
    }
}

/// Where a light shines from: lights are chosen by it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// From within the scene.
    Inside {
        /// Its power, W, a mean of the channels.
        power: f64,
        /// Where it is and where it shines to.
        bounds: LightBounds,
    },
    /// From outside.
    Outside {
        /// Its radiance integrated over all directions, a mean of the channels.
        flux: f64,
        /// The share of all directions that it effectively comes from, (∫L)² / (4π ∫L²): 1 for the same light from
        /// everywhere, 0 for light from a single direction. The less it is, the less often does scattering find the
        /// light.
        spread: f64,
    },
}

/// A light that is no surface.
pub trait Light: Debug + Send + Sync {
    /// What is wrong with it, in a few words; `Ok` if nothing is.
    fn validate(&self) -> Result<(), String>;

    /// Where it shines from. The power or flux of one that is dark is 0, and it is never asked for a sample.
    fn reach(&self) -> Reach;

    /// Draws light that reaches a receiver, as if it were the only light, by two numbers in [0, 1). `None` if the draw
    /// gives none. Light below a receiver's horizon need not be left out.
    fn sample(&self, receiver: &LightSampleContext, u: [f64; 2]) -> Option<LightSample>;

    /// The radiance that comes from outside along a direction, which is unit and points there; black for a light that
    /// is found by its samples only.
    fn outside(&self, _direction: DVec3) -> Rgb {
        Rgb::ZERO
    }

    /// The density in solid angle with which [`Light::sample`] draws such a direction: above 0 wherever
    /// [`Light::outside`] is not black and the receiver's horizon is not above.
    fn outside_pdf(&self, _receiver: &LightSampleContext, _direction: DVec3) -> f64 {
        0.0
    }

    /// The memory held.
    fn bytes(&self) -> usize;
}

/// One number for an amount of light: the mean of its channels, so that no colour is chosen too seldom, as blue would
/// be by its luminance.
#[inline]
pub(super) fn strength(rgb: Rgb) -> f64 {
    rgb.element_sum() / 3.0
}
