//! Interface of lights that are not surfaces.

use super::{LightBounds, LightSample, LightSampleContext, PointEmission};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::fmt::Debug;

/// Extent of a light, on which light selection depends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// Within the scene.
    Finite {
        /// Power, W, a mean of the channels.
        power: f64,
        /// Spatial and directional bounds.
        bounds: LightBounds,
    },
    /// At infinity.
    Infinite {
        /// Radiance integrated over all directions, a mean of the channels.
        flux: f64,
        /// Effective share of all directions, (∫L)² / (4π ∫L²): 1 for a constant environment, 0 for a delta direction.
        /// The smaller it is, the less often BSDF sampling finds the light.
        spread: f64,
    },
}

/// Location of a delta light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// A point.
    Point(DVec3),
    /// A direction at infinity.
    Direction(DVec3),
}

/// A light that is not a surface.
pub trait Light: Debug + Send + Sync {
    /// Returns a short reason if the light is invalid.
    fn validate(&self) -> Result<(), String>;

    /// Returns the light's extent. The power or flux of a dark light is 0, and it is never sampled.
    fn reach(&self) -> Reach;

    /// Samples incident light at a receiver, as if this were the only light, by two numbers in [0, 1). Returns `None`
    /// if the sample carries no light. Samples below the receiver's horizon are allowed.
    fn sample(&self, receiver: &LightSampleContext, u: [f64; 2]) -> Option<LightSample>;

    /// Radiance from infinity along a unit direction that points to the light; black for a delta light.
    fn infinite_radiance(&self, _direction: DVec3) -> Rgb {
        Rgb::ZERO
    }

    /// The radiance from infinity, if it is the same for all directions.
    fn constant_radiance(&self) -> Option<Rgb> {
        None
    }

    /// Radiance from infinity at these wavelengths, if the light supports them.
    fn infinite_radiance_at(&self, direction: DVec3, _waves: Option<&Waves>) -> Rgb {
        self.infinite_radiance(direction)
    }

    /// Returns whether the light is spectral.
    fn has_waves(&self) -> bool {
        false
    }

    /// Density of [`Light::sample`] for a direction by solid angle. It is positive wherever
    /// [`Light::infinite_radiance`] is not black and the direction is above the receiver's horizon.
    fn infinite_pdf(&self, _receiver: &LightSampleContext, _direction: DVec3) -> f64 {
        0.0
    }

    /// Location of a delta light; `None` if the light has an extent.
    fn place(&self) -> Option<Place> {
        None
    }

    /// Samples emission from a point light; `None` for any other light, or if the sample carries no light.
    fn sample_emission(&self, _u: [f64; 2]) -> Option<PointEmission> {
        None
    }

    /// Samples emission at these wavelengths, if the light supports them.
    fn sample_emission_at(&self, u: [f64; 2], _waves: Option<&Waves>) -> Option<PointEmission> {
        self.sample_emission(u)
    }

    /// Intensity of a point light in a unit direction, W/sr, at these wavelengths if the light supports them.
    fn intensity_towards(&self, _direction: DVec3, _waves: Option<&Waves>) -> Rgb {
        Rgb::ZERO
    }

    /// Density of [`Light::sample_emission`] for a unit direction, by solid angle.
    fn emission_pdf(&self, _direction: DVec3) -> f64 {
        0.0
    }

    /// Memory in bytes.
    fn bytes(&self) -> usize;
}

/// Scalar strength of an RGB value: the mean of its channels. Luminance would sample blue light too rarely.
#[inline]
pub(super) fn strength(rgb: Rgb) -> f64 {
    rgb.mean()
}
