//! What every light that is no surface can be asked, and what is drawn from one.

use super::{LightBounds, LightContextLanes, LightLanes, LightSample, LightSampleContext, PointEmission};
use raywright_base::math::DVec3;
use raywright_base::sampling::Pairs;
use raywright_base::simd::Level;
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::fmt::Debug;

/// Where a light shines from: lights are chosen by it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// From within the scene.
    Finite {
        /// Its power, W, a mean of the channels.
        power: f64,
        /// Where it is and where it shines to.
        bounds: LightBounds,
    },
    /// From outside the scene.
    Infinite {
        /// Its radiance integrated over all directions, a mean of the channels.
        flux: f64,
        /// The share of all directions that it effectively comes from, (∫L)² / (4π ∫L²): 1 for the same light from
        /// everywhere, 0 for light from a single direction. The less it is, the less often does scattering find the
        /// light.
        spread: f64,
    },
}

/// Where a light is that has no extent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// At a point.
    Point(DVec3),
    /// Infinitely far away in a direction.
    Direction(DVec3),
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

    /// The same for the receiver and the numbers of each lane.
    fn sample_lanes(&self, _: Level, receivers: &LightContextLanes, u: &Pairs, lights: &mut LightLanes) {
        lights.draw_each(receivers, u, |receiver, u| self.sample(receiver, u));
    }

    /// The radiance that comes from outside along a direction, which is unit and points there; black for a light that
    /// is found by its samples only.
    fn infinite_radiance(&self, _direction: DVec3) -> Rgb {
        Rgb::ZERO
    }

    /// That radiance, if it is the same from everywhere.
    fn constant_radiance(&self) -> Option<Rgb> {
        None
    }

    /// The same at some wavelengths, if it is asked for those.
    fn infinite_radiance_at(&self, direction: DVec3, _waves: Option<&Waves>) -> Rgb {
        self.infinite_radiance(direction)
    }

    /// Whether it is told by wavelength.
    fn has_waves(&self) -> bool {
        false
    }

    /// The density in solid angle with which [`Light::sample`] draws such a direction: above 0 wherever
    /// [`Light::infinite_radiance`] is not black and the receiver's horizon is not above.
    fn infinite_pdf(&self, _receiver: &LightSampleContext, _direction: DVec3) -> f64 {
        0.0
    }

    /// Where it is if all of its light comes from there; `None` if it has an extent.
    fn place(&self) -> Option<Place> {
        None
    }

    /// Draws light that sets out, of a light that is a single point; `None` for any other, or if the draw gives none.
    fn sample_emission(&self, _u: [f64; 2]) -> Option<PointEmission> {
        None
    }

    /// The same at some wavelengths, if it is asked for those.
    fn sample_emission_at(&self, u: [f64; 2], _waves: Option<&Waves>) -> Option<PointEmission> {
        self.sample_emission(u)
    }

    /// What it sends along a unit direction, W/sr, of a light that is a single point; at some wavelengths, if it is
    /// asked for those.
    fn intensity_towards(&self, _direction: DVec3, _waves: Option<&Waves>) -> Rgb {
        Rgb::ZERO
    }

    /// The density, by solid angle, with which [`Light::sample_emission`] draws a unit direction.
    fn emission_pdf(&self, _direction: DVec3) -> f64 {
        0.0
    }

    /// The memory held.
    fn bytes(&self) -> usize;
}

/// One number for an amount of light: the mean of its channels, so that no colour is chosen too seldom, as blue would
/// be by its luminance.
#[inline]
pub(super) fn strength(rgb: Rgb) -> f64 {
    rgb.mean()
}
