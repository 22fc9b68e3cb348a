//! Spectral lights.

use super::{Light, LightSample, LightSampleContext, Place, PointEmission, Reach};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use raywright_optics::spectra::{Role, Smooth, Spectrum, Waves};
use std::sync::Arc;

/// A spectral light that is not a surface.
#[derive(Clone, Debug)]
pub struct Waved {
    light: Arc<dyn Light>,
    /// True if the light has colors, each of which is upsampled to a smooth spectrum; otherwise it is gray.
    is_coloured: bool,
    /// A spectral factor.
    tint: Option<Tint>,
}

/// A spectrum, its RGB color, and the color's mean, which the light already includes.
#[derive(Clone, Debug)]
struct Tint {
    spectrum: Arc<Spectrum>,
    colour: Rgb,
    mean: f64,
}

impl Waved {
    /// A light with many colors; each is upsampled to a smooth spectrum.
    pub fn coloured(light: Arc<dyn Light>) -> Self {
        Self { light, is_coloured: true, tint: None }
    }

    /// A light, gray or with many colors, times a spectrum. `make` creates it with the given brightness; `colour` is
    /// the spectrum in red, green and blue.
    ///
    /// # Errors
    /// If `make` fails.
    pub fn tinted<E>(
        (spectrum, colour): (Arc<Spectrum>, Rgb),
        is_coloured: bool,
        make: impl FnOnce(f64) -> Result<Arc<dyn Light>, E>,
    ) -> Result<Self, E> {
        let mean = colour.mean();
        Ok(Self { light: make(mean)?, is_coloured, tint: Some(Tint { spectrum, colour, mean }) })
    }

    fn at(&self, light: Rgb, waves: Option<&Waves>) -> Rgb {
        let own = match waves {
            Some(waves) if self.is_coloured => Smooth::looked_up(light, Role::Amount).lanes(waves),
            _ => light,
        };
        match &self.tint {
            Some(tint) if tint.mean > 0.0 => {
                own * (waves.map_or(tint.colour, |waves| tint.spectrum.lanes(waves)) / tint.mean)
            }
            _ => own,
        }
    }
}

impl Light for Waved {
    fn validate(&self) -> Result<(), String> {
        self.light.validate()
    }

    fn reach(&self) -> Reach {
        self.light.reach()
    }

    fn sample(&self, receiver: &LightSampleContext, u: [f64; 2]) -> Option<LightSample> {
        let drawn = self.light.sample(receiver, u)?;
        let weight = self.at(drawn.weight, receiver.waves.as_ref());
        (!weight.is_black()).then_some(LightSample { weight, ..drawn })
    }

    fn infinite_radiance(&self, direction: DVec3) -> Rgb {
        self.at(self.light.infinite_radiance(direction), None)
    }

    fn infinite_radiance_at(&self, direction: DVec3, waves: Option<&Waves>) -> Rgb {
        self.at(self.light.infinite_radiance(direction), waves)
    }

    fn has_waves(&self) -> bool {
        true
    }

    fn infinite_pdf(&self, receiver: &LightSampleContext, direction: DVec3) -> f64 {
        self.light.infinite_pdf(receiver, direction)
    }

    fn place(&self) -> Option<Place> {
        self.light.place()
    }

    fn sample_emission(&self, u: [f64; 2]) -> Option<PointEmission> {
        self.sample_emission_at(u, None)
    }

    fn sample_emission_at(&self, u: [f64; 2], waves: Option<&Waves>) -> Option<PointEmission> {
        let drawn = self.light.sample_emission(u)?;
        Some(PointEmission { weight: self.at(drawn.weight, waves), ..drawn })
    }

    fn intensity_towards(&self, direction: DVec3, waves: Option<&Waves>) -> Rgb {
        self.at(self.light.intensity_towards(direction, waves), waves)
    }

    fn emission_pdf(&self, direction: DVec3) -> f64 {
        self.light.emission_pdf(direction)
    }

    fn bytes(&self) -> usize {
        size_of::<Self>() + self.light.bytes()
    }
}
