//! Emission of a grid medium.

use super::{Field, Values};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use raywright_optics::spectra::{COLDEST, Role, Smooth, Waves, black_body, black_body_colour, white};

/// Emission of a grid medium that is not proportional to its density.
#[derive(Clone, Debug)]
pub enum Glow {
    /// Radiance per unit length.
    Radiance(Field),
    /// Black-body emission at a temperature in kelvin, times the absorption (Kirchhoff, 1860). Planck's curve is
    /// normalized to its maximum and multiplied by `brightness`.
    Heat {
        /// Temperature in kelvin.
        kelvin: Values<1>,
        /// Factor.
        brightness: f64,
    },
}

impl Glow {
    /// Emission at a point of the unit cube; `absorbed` is the absorption coefficient there.
    #[inline]
    pub fn at(&self, within: DVec3, absorbed: impl FnOnce() -> Rgb) -> Rgb {
        match self {
            Self::Radiance(field) => field.at(within),
            Self::Heat { kelvin, brightness } => {
                let [kelvin] = kelvin.value(within);
                if kelvin < COLDEST { Rgb::ZERO } else { absorbed() * black_body_colour(kelvin) * *brightness }
            }
        }
    }

    /// Emission at a path's wavelengths.
    pub fn at_waves(&self, within: DVec3, absorbed: impl FnOnce() -> Rgb, waves: &Waves) -> Rgb {
        match self {
            Self::Radiance(field) => Smooth::looked_up(field.at(within), Role::Amount).lanes(waves),
            Self::Heat { kelvin, brightness } => {
                let [kelvin] = kelvin.value(within);
                if kelvin < COLDEST {
                    return Rgb::ZERO;
                }
                // Radiance is relative to daylight.
                absorbed() * waves.lanes(|wavelength| brightness * black_body(wavelength, kelvin) / white(wavelength))
            }
        }
    }

    /// One flag per block of the unit cube, the last axis fastest: true if anything in it emits.
    pub fn bright(&self, blocks: [usize; 3]) -> Vec<bool> {
        match self {
            Self::Radiance(field) => field.ranges(blocks).into_iter().map(|[_, most]| most != [0.0; 3]).collect(),
            Self::Heat { kelvin, brightness } => {
                let is_hot = |[_, [most]]: [[f32; 1]; 2]| f64::from(most) >= COLDEST && *brightness > 0.0;
                kelvin.ranges(blocks).map(is_hot).collect()
            }
        }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Radiance(field) => field.bytes(),
            Self::Heat { kelvin, .. } => kelvin.bytes(),
        }
    }
}
