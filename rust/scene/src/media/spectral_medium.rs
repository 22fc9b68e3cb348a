//! Spectral media.

use super::{Coefficients, Cubic, Medium, Stretches};
use raywright_base::math::{DVec3, Ray};
use raywright_optics::spectra::{Role, Smooth, Spectrum, Waves};
use raywright_optics::{Phase, Rgb};
use std::sync::Arc;

/// A medium with constant absorption and scattering spectra, scaled by its density.
#[derive(Clone, Debug)]
pub struct WavedMedium {
    medium: Arc<dyn Medium>,
    absorption: Tint,
    scattering: Tint,
    /// Emission spectrum; `None` if the emission has a color per point.
    emission: Option<Tint>,
}

/// A spectrum, and the mean of the RGB channels that represent it in the medium.
#[derive(Clone, Debug)]
struct Tint {
    spectrum: Arc<Spectrum>,
    mean: f64,
}

impl Tint {
    fn new((spectrum, colour): (Arc<Spectrum>, Rgb)) -> Self {
        Self { spectrum, mean: colour.mean() }
    }

    /// The spectrum, scaled by the ratio of the mean channels.
    fn lanes(&self, here: Rgb, waves: &Waves) -> Rgb {
        if self.mean > 0.0 { self.spectrum.lanes(waves) * (here.mean() / self.mean) } else { Rgb::ZERO }
    }
}

impl WavedMedium {
    /// Creates a spectral medium from one in RGB. Absorption, scattering and emission at unit density are given as
    /// spectra, with the RGB colors that represent them.
    pub fn new(
        medium: Arc<dyn Medium>,
        [absorption, scattering]: [(Arc<Spectrum>, Rgb); 2],
        emission: Option<(Arc<Spectrum>, Rgb)>,
    ) -> Self {
        let (absorption, scattering) = (Tint::new(absorption), Tint::new(scattering));
        Self { medium, absorption, scattering, emission: emission.map(Tint::new) }
    }
}

impl Medium for WavedMedium {
    fn phase(&self) -> Phase {
        self.medium.phase()
    }

    fn scatters(&self) -> bool {
        self.medium.scatters()
    }

    fn glows(&self) -> bool {
        self.medium.glows()
    }

    fn is_even(&self) -> bool {
        self.medium.is_even()
    }

    fn stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_> {
        self.medium.stretches(ray, span)
    }

    fn closed_stretches(&self, ray: &Ray, span: [f64; 2]) -> Stretches<'_> {
        self.medium.closed_stretches(ray, span)
    }

    fn cubic(&self, ends: [DVec3; 2]) -> Cubic {
        self.medium.cubic(ends)
    }

    fn at(&self, point: DVec3) -> Coefficients {
        self.medium.at(point)
    }

    fn by_waves(&self, here: Coefficients, waves: &Waves) -> Coefficients {
        let absorbed = (here.extinction - here.scattering).at_least(Rgb::ZERO);
        let emission = match &self.emission {
            Some(tint) => tint.lanes(here.emission, waves),
            None if here.emission.is_black() => Rgb::ZERO,
            None => Smooth::looked_up(here.emission, Role::Amount).lanes(waves),
        };
        let scattering = self.scattering.lanes(here.scattering, waves);
        Coefficients { extinction: self.absorption.lanes(absorbed, waves) + scattering, scattering, emission }
    }

    fn most_by_waves(&self, most: Rgb, waves: &Waves) -> Rgb {
        let of = |tint: &Tint| tint.lanes(Rgb::splat(tint.mean), waves);
        let mean = self.absorption.mean + self.scattering.mean;
        // Slightly increased, to bound rounding.
        if mean > 0.0 {
            (of(&self.absorption) + of(&self.scattering)) * (most.mean() / mean * (1.0 + 1e-12))
        } else {
            most
        }
    }

    fn least_by_waves(&self, least: Rgb, waves: &Waves) -> Rgb {
        // Slightly decreased, to bound rounding.
        self.most_by_waves(least, waves) * (1.0 - 1e-11)
    }

    fn has_waves(&self) -> bool {
        true
    }

    fn bytes(&self) -> usize {
        size_of::<Self>() + self.medium.bytes()
    }
}
