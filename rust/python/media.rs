//! Media as the package describes them, read by attribute.

use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::sync::Arc;

use crate::optics::{HenyeyGreenstein, Phase, Rgb};
use crate::scene::media::{At, Coefficients, GridMedium, Homogeneous, Medium, Values};

/// What all media have.
#[derive(FromPyObject)]
struct PyMedium<'py> {
    absorption: [f64; 3],
    scattering: [f64; 3],
    phase: Bound<'py, PyAny>,
}

/// The medium of a description.
///
/// # Errors
/// A `TypeError` for what is none, a `ValueError` for one that cannot be.
pub fn read(given: &Bound<'_, PyAny>) -> PyResult<Arc<dyn Medium>> {
    let name = given.get_type().name()?;
    let PyMedium { absorption, scattering, phase } = given.extract()?;
    let [absorption, scattering] = [absorption, scattering].map(Rgb::from_array);
    let phase = read_phase(&phase)?;
    match name.to_str()? {
        "Homogeneous" => {
            let emission = Rgb::from_array(given.getattr("emission")?.extract()?);
            let medium = Homogeneous::new(absorption, scattering, emission, phase);
            let medium = medium.ok_or_else(|| PyValueError::new_err("a medium must be finite and not negative"))?;
            Ok(Arc::new(medium))
        }
        "GridMedium" => {
            let at = match given.getattr("at")?.extract::<String>()?.as_str() {
                "centres" => At::Centres,
                _ => At::Corners,
            };
            let told = |name: &'static str| move |why: String| PyValueError::new_err(format!("{name} {why}"));
            let (size, density) = values::<1>(&given.getattr("density")?)?;
            let density = Values::new(size, at, density).map_err(told("density"))?;
            let glow = given.call_method0("_glow")?;
            let is_glowing = !glow.is_none();
            let emission = if is_glowing { [0.0; 3] } else { given.getattr("emission")?.extract()? };
            let glow = is_glowing.then(|| values::<3>(&glow)).transpose()?;
            let glow = glow.map(|(size, glow)| Values::new(size, at, glow)).transpose().map_err(told("emission"))?;
            let coefficients = Coefficients::new(absorption, scattering, Rgb::from_array(emission));
            let matrix = given.call_method0("_place")?.extract()?;
            let medium = GridMedium::new(density, glow, coefficients, phase, matrix).map_err(told("medium"))?;
            Ok(Arc::new(medium))
        }
        other => Err(PyTypeError::new_err(format!("medium must be a raywright medium, got {other}"))),
    }
}

/// How many numbers there are along each of three axes, and all of them.
fn values<const C: usize>(array: &Bound<'_, PyAny>) -> PyResult<([usize; 3], Vec<[f32; C]>)> {
    let array: PyReadonlyArrayDyn<'_, f32> = array.extract()?;
    let &[x, y, z, ..] = array.shape() else {
        return Err(PyValueError::new_err("a grid must have three axes"));
    };
    let numbers = array.as_slice().map_err(|_| PyValueError::new_err("a grid must be C-contiguous"))?;
    Ok(([x, y, z], numbers.as_chunks::<C>().0.to_vec()))
}

/// How a medium scatters.
fn read_phase(given: &Bound<'_, PyAny>) -> PyResult<Phase> {
    match given.get_type().name()?.to_str()? {
        "Isotropic" => Ok(Phase::Isotropic),
        "Rayleigh" => Ok(Phase::Rayleigh),
        "HenyeyGreenstein" => {
            let by = HenyeyGreenstein::new(given.getattr("g")?.extract()?);
            by.map(Phase::HenyeyGreenstein).ok_or_else(|| PyValueError::new_err("g must be between -1 and 1"))
        }
        other => Err(PyTypeError::new_err(format!("phase must be a raywright phase function, got {other}"))),
    }
}
