//! An isotropic point light.

use super::light::strength;
use super::{Light, LightBounds, LightSample, LightSampleContext, Place, PointEmission, Reach};
use raywright_base::math::DVec3;
use raywright_base::sampling::warp::{UNIFORM_SPHERE_PDF, uniform_sphere};
use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;
use std::f64::consts::PI;

/// A point light of equal intensity in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Position.
    pub position: DVec3,
    /// Radiant intensity, W·sr⁻¹.
    pub intensity: Rgb,
}

impl Light for PointLight {
    fn validate(&self) -> Result<(), String> {
        if self.position.is_finite() && self.intensity.is_radiance() {
            Ok(())
        } else {
            Err("a point light must have a finite position and an intensity that is finite and not negative".into())
        }
    }

    fn reach(&self) -> Reach {
        let intensity = strength(self.intensity);
        Reach::Finite { power: 4.0 * PI * intensity, bounds: LightBounds::everywhere(self.position, intensity) }
    }

    #[inline]
    fn sample(&self, receiver: &LightSampleContext, _: [f64; 2]) -> Option<LightSample> {
        LightSample::of_point(self.position, receiver, |_| self.intensity)
    }

    fn sample_emission(&self, u: [f64; 2]) -> Option<PointEmission> {
        let pdf = UNIFORM_SPHERE_PDF;
        let (position, direction) = (self.position, uniform_sphere(u));
        Some(PointEmission { position, direction, weight: self.intensity / pdf, pdf })
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Point(self.position))
    }

    fn intensity_towards(&self, _: DVec3, _: Option<&Waves>) -> Rgb {
        self.intensity
    }

    fn emission_pdf(&self, _: DVec3) -> f64 {
        UNIFORM_SPHERE_PDF
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}
