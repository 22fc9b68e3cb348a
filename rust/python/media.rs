//! Media as the package describes them, read by attribute.

use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::sync::Arc;

use super::spectra::{self, Meaning};
use crate::optics::spectra::{Role, Smooth, Spectrum};
use crate::optics::{HenyeyGreenstein, Phase, Rgb};
use crate::scene::media::{At, Coefficients, GridMedium, Homogeneous, Medium, Values, WavedMedium};

/// What all media have.
#[derive(FromPyObject)]
struct PyMedium<'py> {
    absorption: Bound<'py, PyAny>,
    scattering: Bound<'py, PyAny>,
    phase: Bound<'py, PyAny>,
}

/// The medium of a description, by wavelength where it is to be.
///
/// # Errors
/// A `TypeError` for what is none, a `ValueError` for one that cannot be.
pub fn read(given: &Bound<'_, PyAny>, waves: bool) -> PyResult<Arc<dyn Medium>> {
    let name = given.get_type().name()?;
    let PyMedium { absorption, scattering, phase } = given.extract()?;
    let tint = |told: &Bound<'_, PyAny>, meaning| {
        if waves {
            return spectra::tint(told, meaning);
        }
        // Nobody asks for its spectrum.
        let colour = Rgb::from_array(told.extract()?);
        Ok((Arc::new(Spectrum::Smooth(Smooth::of(Rgb::ONE, Role::Amount))), colour))
    };
    let (absorbs, scatters) = (tint(&absorption, Meaning::Amount)?, tint(&scattering, Meaning::Amount)?);
    let phase = read_phase(&phase)?;
    let (absorption, scattering) = (absorbs.1, scatters.1);
    let by_waves = |medium: Arc<dyn Medium>, emission| -> Arc<dyn Medium> {
        if waves { Arc::new(WavedMedium::new(medium, [absorbs, scatters], emission)) } else { medium }
    };
    match name.to_str()? {
        "Homogeneous" => {
            let emission = tint(&given.getattr("emission")?, Meaning::Light)?;
            let medium = Homogeneous::new(absorption, scattering, emission.1, phase);
            let medium = medium.ok_or_else(|| PyValueError::new_err("a medium must be finite and not negative"))?;
            Ok(by_waves(Arc::new(medium), Some(emission)))
        }
        "GridMedium" => {
            let at = match given.getattr("at")?.extract::<String>()?.as_str() {
                "centres" => At::Centres,
                _ => At::Corners,
            };
            let of = |name: &'static str| move |why: String| PyValueError::new_err(format!("{name} {why}"));
            let (size, density) = values::<1>(&given.getattr("density")?)?;
            let density = Values::new(size, at, density).map_err(of("density"))?;
            let glow = given.call_method0("_glow")?;
            let is_glowing = !glow.is_none();
            let told = given.getattr("emission")?;
            let shines = if is_glowing { None } else { Some(tint(&told, Meaning::Light)?) };
            let emission = shines.as_ref().map_or(Rgb::ZERO, |shines| shines.1);
            let glow = is_glowing.then(|| values::<3>(&glow)).transpose()?;
            let glow = glow.map(|(size, glow)| Values::new(size, at, glow)).transpose().map_err(of("emission"))?;
            let coefficients = Coefficients::new(absorption, scattering, emission);
            let matrix = given.call_method0("_place")?.extract()?;
            let medium = GridMedium::new(density, glow, coefficients, phase, matrix).map_err(of("medium"))?;
            Ok(by_waves(Arc::new(medium), shines))
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
