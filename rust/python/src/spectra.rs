//! Spectra and indices of refraction of the Python package, read by attribute, and colors of spectra.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;

use super::kinds::{Kinds, Read};
use raywright::optics::spectra::{self, FIRST, Illuminant, LAST, Response, Role, Smooth, Spectrum, Table, Told};
use raywright::optics::thin_film::{self, Complex};
use raywright::optics::{Dispersion, Dispersive, Rgb};

/// Linear Rec. 709 color of values at increasing wavelengths in nm, linear between them, and 0 outside. They are
/// relative to daylight or, unless `of_daylight`, to equal-energy light of luminance 1.
#[pyfunction]
pub fn spectrum_rgb(rows: Vec<[f64; 2]>, of_daylight: bool) -> [f64; 3] {
    let illuminant = if of_daylight { Illuminant::Daylight } else { Illuminant::Even };
    let value = |wavelength| spectra::at(&rows, wavelength).map_or(0.0, |[_, value]| value);
    Response::new(illuminant, 1).seen(value).to_array()
}

/// Luminance of power values at increasing wavelengths in nm, linear between them, and 0 outside. It is 1 for a power
/// of 1 everywhere.
#[pyfunction]
pub fn spectrum_luminance(rows: Vec<[f64; 2]>) -> f64 {
    let (mut seen, mut all) = (0.0, 0.0);
    for nm in (FIRST as u32..=LAST as u32).map(f64::from) {
        let weight = spectra::matching(nm).y;
        seen += weight * spectra::at(&rows, nm).map_or(0.0, |[_, value]| value);
        all += weight;
    }
    seen / all
}

/// The power of daylight (D65) at each nm from 360 to 830, 100 at 560.
#[pyfunction]
pub fn daylight_power() -> Vec<f64> {
    (FIRST as u32..=LAST as u32).map(|nm| spectra::daylight(nm.into())).collect()
}

/// Reflectance of films for unpolarized light, one wavelength per row. Rows have wavelength and thickness in nm, cosine
/// of incidence, indices of the surroundings and the film, and real and imaginary part of the base's index.
#[pyfunction]
pub fn film_reflectance(rows: Vec<[f64; 7]>) -> Vec<f64> {
    let each = |[wavelength, thickness, cosine, outside, film, eta, k]: [f64; 7]| {
        thin_film::reflectance(wavelength, cosine, thickness, outside, film, Complex { re: eta, im: k })
    };
    rows.into_iter().map(each).collect()
}

/// Smooth spectrum of a color at wavelengths in nm; `bounded` for a reflectance, otherwise an unbounded amount.
///
/// # Errors
/// A `ValueError` for a color with negative channels.
#[pyfunction]
pub fn smooth_spectrum(colour: [f64; 3], bounded: bool, looked_up: bool, wavelengths: Vec<f64>) -> PyResult<Vec<f64>> {
    let colour = Rgb::from_array(colour);
    if !colour.is_radiance() {
        return Err(PyValueError::new_err("a colour must be finite and not negative"));
    }
    let role = if bounded { Role::Share } else { Role::Amount };
    let smooth = if looked_up { Smooth::looked_up(colour, role) } else { Smooth::of(colour, role) };
    Ok(wavelengths.into_iter().map(|nm| smooth.at(nm)).collect())
}

/// Physical quantity of a texture's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// Reflectances.
    Share,
    /// Amounts of light.
    Light,
    /// Other unbounded amounts, such as indices of refraction.
    Amount,
    /// Plain numbers without a spectrum.
    Numbers,
}

/// Reads a `raywright.Spectrum`.
///
/// # Errors
/// A `ValueError` for one without values.
pub fn table(given: &Bound<'_, PyAny>, meaning: Meaning) -> PyResult<Arc<Spectrum>> {
    let [wavelengths, values] = ["wavelengths", "values"].map(|name| given.getattr(name)?.extract::<Vec<f64>>());
    let told = match meaning {
        Meaning::Light => Told::Power,
        Meaning::Share => Told::Shares,
        Meaning::Amount | Meaning::Numbers => Told::Index,
    };
    let table = Table::new(&wavelengths?, &values?, told);
    table
        .map(|table| Arc::new(Spectrum::Table(table)))
        .ok_or_else(|| PyValueError::new_err("a spectrum must have values"))
}

/// A spectrum and its RGB color: of three numbers the smooth spectrum, or a `raywright.Spectrum`.
///
/// # Errors
/// As [`table`].
pub fn tint(given: &Bound<'_, PyAny>, meaning: Meaning) -> PyResult<(Arc<Spectrum>, Rgb)> {
    if let Ok(colour) = given.extract::<[f64; 3]>() {
        let colour = Rgb::from_array(colour);
        let role = if meaning == Meaning::Share { Role::Share } else { Role::Amount };
        return Ok((Arc::new(Spectrum::Smooth(Smooth::of(colour.at_least(Rgb::ZERO), role))), colour));
    }
    let spectrum = table(given, meaning)?;
    let colour = spectrum.seen().at_least(Rgb::ZERO);
    Ok((spectrum, colour))
}

static DISPERSIONS: Kinds<Read<Dispersion>> = Kinds::new(
    "ior must be a number or a dispersion",
    &[
        ("materials.dispersion", "Cauchy", |of| {
            Ok(Dispersion::Cauchy([of.getattr("B")?.extract()?, of.getattr("C")?.extract()?]))
        }),
        ("materials.dispersion", "Sellmeier", |of| {
            let [b, c] = ["B", "C"].map(|name| of.getattr(name)?.extract::<Vec<f64>>());
            Ok(Dispersion::Sellmeier(b?.into_iter().zip(c?).map(|(b, c)| [b, c]).collect()))
        }),
    ],
);

/// Reads an index of refraction, for yellow light if it varies, and its dispersion.
///
/// # Errors
/// A `TypeError` if it is not an index, a `ValueError` for a formula that is invalid at some visible wavelength, or if
/// there are too many.
pub fn index(given: &Bound<'_, PyAny>) -> PyResult<(f64, Dispersive)> {
    if let Ok(number) = given.extract::<f64>() {
        return Ok((number, Dispersive::NONE));
    }
    let dispersion = DISPERSIONS.reader(given)?(given)?;
    if !dispersion.is_physical(FIRST, LAST) {
        return Err(PyValueError::new_err(format!(
            "ior must be above 0 from {FIRST} to {LAST} nm, got {dispersion:?}"
        )));
    }
    let yellow = dispersion.at(587.5618);
    let kept = Dispersive::of(dispersion);
    kept.map(|kept| (yellow, kept))
        .ok_or_else(|| PyValueError::new_err("a process can use at most 4096 dispersions as ior"))
}
