//! Sampler and filter descriptions of the Python package, one dataclass per kind, read by attribute.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::kinds::{Kinds, Read};
use raywright::render::filter::{self, Filter, FilterProfile, Separable};
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

static SAMPLERS: Kinds<Read<SamplerKind>> = Kinds::new(
    "sampler must be one of raywright's",
    &[
        ("rendering.samplers", "Independent", |_| Ok(SamplerKind::Independent)),
        ("rendering.samplers", "Stratified", |of| batch(of).map(SamplerKind::Stratified)),
        ("rendering.samplers", "Halton", |of| batch(of).map(SamplerKind::Halton)),
        ("rendering.samplers", "Sobol", |of| batch(of).map(SamplerKind::Sobol)),
        ("rendering.samplers", "Lattice", |of| batch(of).map(SamplerKind::Lattice)),
    ],
);

/// Reads a sampler.
pub fn sampler(sampler: &Bound<'_, PyAny>) -> PyResult<SamplerKind> {
    SAMPLERS.reader(sampler)?(sampler)
}

/// The batches of a sampler.
fn batch(sampler: &Bound<'_, PyAny>) -> PyResult<BatchSize> {
    match sampler.extract::<Batched>()?.batch {
        None => Ok(BatchSize::for_budget(None)),
        Some(batch) => BatchSize::new(batch)
            .ok_or_else(|| PyValueError::new_err(format!("batch is {batch}, expected a power of two from 1 to 64"))),
    }
}

/// `raywright.rendering.BoxFilter`, `TriangleFilter` and `BlackmanHarrisFilter`.
#[derive(FromPyObject)]
struct Wide {
    radius: f64,
}

/// `raywright.rendering.GaussianFilter`.
#[derive(FromPyObject)]
struct Gaussian {
    radius: f64,
    sigma: f64,
}

/// `raywright.rendering.MitchellFilter`.
#[derive(FromPyObject)]
struct Mitchell {
    radius: f64,
    b: f64,
    c: f64,
}

/// `raywright.rendering.LanczosFilter`.
#[derive(FromPyObject)]
struct Lanczos {
    lobes: u32,
}

/// `raywright.rendering.CroppedFilter`.
#[derive(FromPyObject)]
struct Cropped<'py> {
    filter: Bound<'py, PyAny>,
}

static FILTERS: Kinds<Read<Box<dyn Filter>>> = Kinds::new(
    "filter must be one of raywright's",
    &[
        ("rendering.filters", "BoxFilter", |of| {
            let Wide { radius } = of.extract()?;
            Ok(Box::new(filter::Box::new(radius).map_err(PyValueError::new_err)?))
        }),
        ("rendering.filters", "TriangleFilter", |of| {
            let Wide { radius } = of.extract()?;
            separable(filter::Triangle::new(radius))
        }),
        ("rendering.filters", "GaussianFilter", |of| {
            let Gaussian { radius, sigma } = of.extract()?;
            separable(filter::Gaussian::new(radius, sigma))
        }),
        ("rendering.filters", "MitchellFilter", |of| {
            let Mitchell { radius, b, c } = of.extract()?;
            separable(filter::Mitchell::new(radius, b, c))
        }),
        ("rendering.filters", "BlackmanHarrisFilter", |of| {
            let Wide { radius } = of.extract()?;
            separable(filter::BlackmanHarris::new(radius))
        }),
        ("rendering.filters", "LanczosFilter", |of| {
            let Lanczos { lobes } = of.extract()?;
            separable(filter::Lanczos::new(lobes))
        }),
        ("rendering.filters", "CroppedFilter", |of| {
            let Cropped { filter: whole } = of.extract()?;
            Ok(Box::new(filter::Cropped(self::filter(&whole)?)))
        }),
    ],
);

/// Reads a filter.
pub fn filter(filter: &Bound<'_, PyAny>) -> PyResult<Box<dyn Filter>> {
    FILTERS.reader(filter)?(filter)
}

fn separable<P: FilterProfile + 'static>(profile: Result<P, String>) -> PyResult<Box<dyn Filter>> {
    Ok(Box::new(Separable::new(profile.map_err(PyValueError::new_err)?)))
}
