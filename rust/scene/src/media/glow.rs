//! What a medium on a grid gives off by itself.

use super::{Field, Values};
use raywright_base::math::DVec3;
use raywright_optics::Rgb;
use raywright_optics::spectra::{COLDEST, Role, Smooth, Waves, black_body, black_body_colour, white};

/// What a medium on a grid gives off by itself, other than in proportion to its density.
#[derive(Clone, Debug)]
pub enum Glow {
    /// So much radiance per unit of length.
    Radiance(Field),
    /// What is as hot as this, in kelvin, radiates as a black body does, as far as it absorbs (Kirchhoff, 1860): so
    /// many times Planck's curve over its greatest value.
    Heat {
        /// How hot it is.
        kelvin: Values<1>,
        /// How many times.
        brightness: f64,
    },
}

impl Glow {
    /// What it gives off at a point of the unit cube, where so much is absorbed.
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

    /// The same at a path's wavelengths.
    pub fn at_waves(&self, within: DVec3, absorbed: impl FnOnce() -> Rgb, waves: &Waves) -> Rgb {
        match self {
            Self::Radiance(field) => Smooth::looked_up(field.at(within), Role::Amount).lanes(waves),
            Self::Heat { kelvin, brightness } => {
                let [kelvin] = kelvin.value(within);
                if kelvin < COLDEST {
                    return Rgb::ZERO;
                }
                // Light is told relative to daylight.
                absorbed() * waves.lanes(|wavelength| brightness * black_body(wavelength, kelvin) / white(wavelength))
            }
        }
    }

    /// Whether there is any of it in each of so many equal blocks of the unit cube, the last axis fastest.
    pub fn bright(&self, blocks: [usize; 3]) -> Vec<bool> {
        match self {
            Self::Radiance(field) => field.ranges(blocks).into_iter().map(|[_, most]| most != [0.0; 3]).collect(),
            Self::Heat { kelvin, brightness } => {
                let is_hot = |[_, [most]]: [[f32; 1]; 2]| f64::from(most) >= COLDEST && *brightness > 0.0;
                kelvin.ranges(blocks).map(is_hot).collect()
            }
        }
    }

    /// The memory held.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Radiance(field) => field.bytes(),
            Self::Heat { kelvin, .. } => kelvin.bytes(),
        }
    }
}
