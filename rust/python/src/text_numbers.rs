//! Parsing of numbers in text files.

use numpy::PyArray1;
use pyo3::prelude::*;

use raywright::render::text_numbers;

/// Return the numbers at the beginning of a text, and whether nothing else follows; words of `skipped` may occur
/// between them.
#[pyfunction]
#[allow(clippy::needless_pass_by_value)]
pub fn leading_numbers<'py>(py: Python<'py>, text: &[u8], skipped: Vec<Vec<u8>>) -> (Bound<'py, PyArray1<f64>>, bool) {
    let skipped: Vec<&[u8]> = skipped.iter().map(Vec::as_slice).collect();
    let (numbers, is_whole) = py.detach(|| text_numbers::leading_numbers(text, &skipped));
    (PyArray1::from_vec(py, numbers), is_whole)
}
