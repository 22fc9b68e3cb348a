//! Sampler and filter descriptions of the Python package, one dataclass per kind, read by attribute.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use raywright::render::filter::{self, Filter, Profile, Separable};
use raywright::sampling::{BatchSize, SamplerKind};

/// Attributes of samplers with batches.
#[derive(FromPyObject)]
struct Batched {
    batch: Option<u32>,
}

/// Samples per batch for a number of samples per pixel, if that is known.
#[pyfunction]
#[pyo3(signature = (samples))]
pub fn batch_for(samples: Option<u32>) -> u32 {
    SamplerKind::Sobol(BatchSize::for_budget(samples)).batch()
}

/// Reads a sampler by the name of its class.
pub fn sampler(sampler: &Bound<'_, PyAny>) -> PyResult<SamplerKind> {
    let name = sampler.get_type().name()?;
    let kind = match name.to_str()? {
        "Independent" => return Ok(SamplerKind::Independent),
        "Stratified" => SamplerKind::Stratified,
        "Halton" => SamplerKind::Halton,
        "Sobol" => SamplerKind::Sobol,
        "Lattice" => SamplerKind::Lattice,
        other => return Err(PyTypeError::new_err(format!("sampler is a {other}, expected one of raywright's"))),
    };
    let size = match sampler.extract::<Batched>()?.batch {
        None => BatchSize::for_budget(None),
        Some(batch) => BatchSize::new(batch)
            .ok_or_else(|| PyValueError::new_err(format!("batch is {batch}, expected a power of two from 1 to 64")))?,
    };
    Ok(kind(size))
}

/// `raywright.BoxFilter`, `TriangleFilter` and `BlackmanHarrisFilter`.
#[derive(FromPyObject)]
struct Wide {
    radius: f64,
}

/// `raywright.GaussianFilter`.
#[derive(FromPyObject)]
struct Gaussian {
    radius: f64,
    sigma: f64,
}

/// `raywright.MitchellFilter`.
#[derive(FromPyObject)]
struct Mitchell {
    radius: f64,
    b: f64,
    c: f64,
}

/// `raywright.LanczosFilter`.
#[derive(FromPyObject)]
struct Lanczos {
    lobes: u32,
}

/// `raywright.CroppedFilter`.
#[derive(FromPyObject)]
struct Cropped<'py> {
    filter: Bound<'py, PyAny>,
}

/// Reads a filter by the name of its class.
pub fn filter(filter: &Bound<'_, PyAny>) -> PyResult<Box<dyn Filter>> {
    let name = filter.get_type().name()?;
    match name.to_str()? {
        "BoxFilter" => {
            let Wide { radius } = filter.extract()?;
            Ok(Box::new(filter::Box::new(radius).map_err(PyValueError::new_err)?))
        }
        "TriangleFilter" => {
            let Wide { radius } = filter.extract()?;
            separable(filter::Triangle::new(radius))
        }
        "GaussianFilter" => {
            let Gaussian { radius, sigma } = filter.extract()?;
            separable(filter::Gaussian::new(radius, sigma))
        }
        "MitchellFilter" => {
            let Mitchell { radius, b, c } = filter.extract()?;
            separable(filter::Mitchell::new(radius, b, c))
        }
        "BlackmanHarrisFilter" => {
            let Wide { radius } = filter.extract()?;
            separable(filter::BlackmanHarris::new(radius))
        }
        "LanczosFilter" => {
            let Lanczos { lobes } = filter.extract()?;
            separable(filter::Lanczos::new(lobes))
        }
        "CroppedFilter" => {
            let Cropped { filter: whole } = filter.extract()?;
            Ok(Box::new(filter::Cropped(self::filter(&whole)?)))
        }
        other => Err(PyTypeError::new_err(format!("filter is a {other}, expected one of raywright's"))),
    }
}

fn separable<P: Profile + 'static>(profile: Result<P, String>) -> PyResult<Box<dyn Filter>> {
    Ok(Box::new(Separable::new(profile.map_err(PyValueError::new_err)?)))
}
