//! Light from a single direction.

use super::light::strength;
use super::{Light, LightSample, LightSampleContext, Place, Reach};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;

/// Light from outside along a single direction, as of a star.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    from: DVec3,
    irradiance: Rgb,
}

impl DirectionalLight {
    /// Light that travels along a direction of any length but 0, and brings an irradiance, W·m⁻², to what faces it.
    pub fn new(direction: DVec3, irradiance: Rgb) -> Self {
        Self { from: -(direction / direction.abs().max_element()).normalize(), irradiance }
    }
}

impl Light for DirectionalLight {
    fn validate(&self) -> Result<(), String> {
        if self.from.is_finite() && self.irradiance.is_radiance() {
            Ok(())
        } else {
            Err("a directional light must have a direction of a length other than 0, and an irradiance that is \
                 finite and not negative"
                .into())
        }
    }

    fn reach(&self) -> Reach {
        Reach::Infinite { flux: strength(self.irradiance), spread: 0.0 }
    }

    #[inline]
    fn sample(&self, _: &LightSampleContext, _: [f64; 2]) -> Option<LightSample> {
        Some(LightSample::of_infinite(self.from, self.irradiance, f64::INFINITY))
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Direction(self.from))
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}
