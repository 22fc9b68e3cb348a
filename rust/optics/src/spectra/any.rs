//! Any spectrum.

use super::super::Rgb;
use super::{Illuminant, Response, Smooth, Table, Waves};

/// A spectrum that is kept: of light, relative to daylight.
#[derive(Clone, Debug, PartialEq)]
pub enum Spectrum {
    /// The smooth one of a colour.
    Smooth(Smooth),
    /// One by its values.
    Table(Table),
}

impl Spectrum {
    /// The value at a wavelength that is seen, nm.
    #[inline]
    pub fn at(&self, wavelength: f64) -> f64 {
        match self {
            Self::Smooth(smooth) => smooth.at(wavelength),
            Self::Table(table) => table.at(wavelength),
        }
    }

    /// The values at those of a path.
    #[inline]
    pub fn lanes(&self, waves: &Waves) -> Rgb {
        match self {
            Self::Smooth(smooth) => smooth.lanes(waves),
            Self::Table(table) => waves.lanes(|wavelength| table.at(wavelength)),
        }
    }

    /// What it looks like, in linear Rec. 709.
    pub fn seen(&self) -> Rgb {
        Response::new(Illuminant::Daylight, 1).seen(|nm| self.at(nm))
    }

    /// Its least and its greatest value.
    pub fn range(&self) -> [f64; 2] {
        let values = (360..=830).map(|nm| self.at(f64::from(nm)));
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| [least.min(value), most.max(value)])
    }
}
