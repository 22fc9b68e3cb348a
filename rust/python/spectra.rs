//! Colours of spectra.

use pyo3::prelude::*;

use crate::optics::spectra::{self, Illuminant, Response};

/// The linear Rec. 709 of values at wavelengths in nm, which rise: linear between them, and 0 outside. They say how
/// much there is of daylight, or, unless `of_daylight`, of light that is even over wavelengths and has a luminance of
/// 1.
#[pyfunction]
pub fn spectrum_rgb(rows: Vec<[f64; 2]>, of_daylight: bool) -> [f64; 3] {
    let illuminant = if of_daylight { Illuminant::Daylight } else { Illuminant::Even };
    let value = |wavelength| spectra::at(&rows, wavelength).map_or(0.0, |[_, value]| value);
    Response::new(illuminant, 1).seen(value).to_array()
}
