//! Random numbers of samples, for integrators written in Python.

use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{numbers, sealed, unwritten};
use raywright::sampling::{CAMERA_DIMENSIONS, SamplerKind};

/// One number, or a pair if `pair`, of a dimension of each sample of a pixel: (N,) or (N,2). Dimension numbers start
/// after those of the camera.
#[pyfunction]
pub fn random_numbers<'py>(
    py: Python<'py>,
    seed: u64,
    pixel: PyReadonlyArray1<'py, u32>,
    sample: PyReadonlyArray1<'py, u32>,
    dimension: u32,
    pair: bool,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let (pixel, sample) = (numbers("pixel", &pixel)?, numbers("sample", &sample)?);
    if pixel.len() != sample.len() {
        return Err(PyValueError::new_err(format!(
            "pixels and samples have lengths {} and {}, expected the same",
            pixel.len(),
            sample.len()
        )));
    }
    let dimension = CAMERA_DIMENSIONS.wrapping_add(dimension);
    let array = unwritten::<f64>(py, &[pixel.len()], pair.then_some(2))?;
    {
        let mut written = array.readwrite();
        let to = written.as_slice_mut()?;
        py.detach(|| {
            let samplers = pixel.iter().zip(sample).map(|(&p, &s)| SamplerKind::Independent.sampler(seed, p, s));
            if pair {
                for (to, mut sampler) in to.as_chunks_mut().0.iter_mut().zip(samplers) {
                    *to = sampler.two(dimension);
                }
            } else {
                for (to, mut sampler) in to.iter_mut().zip(samplers) {
                    *to = sampler.one(dimension);
                }
            }
        });
    }
    sealed(array)
}
