//! EXR decoders for Python.

use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use raywright::render::exr_codecs::{huffman, integrate, piz, run_lengths};

/// Sum the differences of a chunk, and interleave its bytes.
#[pyfunction]
pub fn exr_integrate<'py>(py: Python<'py>, data: &[u8]) -> Bound<'py, PyArray1<u8>> {
    PyArray1::from_vec(py, py.detach(|| integrate(data)))
}

/// Decode `count` bytes of run lengths.
///
/// # Errors
/// A `ValueError` if `data` does not hold them.
#[pyfunction]
pub fn exr_run_lengths<'py>(py: Python<'py>, data: &[u8], count: usize) -> PyResult<Bound<'py, PyBytes>> {
    let found = py.detach(|| run_lengths(data, count)).map_err(PyValueError::new_err)?;
    Ok(PyBytes::new(py, &found))
}

/// Decode `count` words of OpenEXR's Huffman code.
///
/// # Errors
/// A `ValueError` if `data` does not hold them.
#[pyfunction]
pub fn exr_huffman<'py>(py: Python<'py>, data: &[u8], count: usize) -> PyResult<Bound<'py, PyArray1<u16>>> {
    let found = py.detach(|| huffman(data, count)).map_err(PyValueError::new_err)?;
    Ok(PyArray1::from_vec(py, found))
}

/// Decode a PIZ chunk. `channels` are columns, rows and 16-bit words per sample; the result is channel by channel, row
/// by row.
///
/// # Errors
/// A `ValueError` if `data` does not hold them.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)]
pub fn exr_piz<'py>(
    py: Python<'py>,
    data: &[u8],
    channels: Vec<(usize, usize, usize)>,
) -> PyResult<Bound<'py, PyArray1<u16>>> {
    let found = py.detach(|| piz(data, &channels)).map_err(PyValueError::new_err)?;
    Ok(PyArray1::from_vec(py, found))
}
