//! An enum over all spectra.

use super::super::Rgb;
use super::{Illuminant, Response, Smooth, Table, Waves};

/// A spectrum; that of light is relative to daylight.
#[derive(Clone, Debug, PartialEq)]
pub enum Spectrum {
    /// The smooth spectrum of a color.
    Smooth(Smooth),
    /// A tabulated spectrum.
    Table(Table),
}

impl Spectrum {
    /// Value at a visible wavelength, nm.
    #[inline]
    pub fn at(&self, wavelength: f64) -> f64 {
        match self {
            Self::Smooth(smooth) => smooth.at(wavelength),
            Self::Table(table) => table.at(wavelength),
        }
    }

    /// Values at a path's wavelengths.
    #[inline]
    pub fn lanes(&self, waves: &Waves) -> Rgb {
        match self {
            Self::Smooth(smooth) => smooth.lanes(waves),
            Self::Table(table) => waves.lanes(|wavelength| table.at(wavelength)),
        }
    }

    /// Its color in linear Rec. 709.
    pub fn seen(&self) -> Rgb {
        Response::new(Illuminant::Daylight, 1).seen(|nm| self.at(nm))
    }

    /// Minimum and maximum value.
    pub fn range(&self) -> [f64; 2] {
        let values = (360..=830).map(|nm| self.at(f64::from(nm)));
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| [least.min(value), most.max(value)])
    }
}
