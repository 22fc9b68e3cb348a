//! A directional light.

use super::light::strength;
use super::{Light, LightSample, LightSampleContext, Place, Reach};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;

/// Light from a single direction, such as a distant star.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    from: DVec3,
    irradiance: Rgb,
}

impl DirectionalLight {
    /// Creates a light that travels along a direction of any non-zero length, with an irradiance, W·m⁻², on surfaces
    /// perpendicular to it.
    pub fn new(direction: DVec3, irradiance: Rgb) -> Self {
        Self { from: -(direction / direction.abs().max_element()).normalize(), irradiance }
    }
}

impl Light for DirectionalLight {
    fn validate(&self) -> Result<(), String> {
        if self.from.is_finite() && self.irradiance.is_radiance() {
            Ok(())
        } else {
            Err("a directional light must have a nonzero direction and a finite irradiance of at least 0".into())
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
