//! Directions through points of a camera's film.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

use super::arrays::rows;
use super::render::Camera;

/// Unit directions (N,3) through `points` (N,2) of the film, in pixels from its left and from its top.
#[pyfunction]
pub fn camera_directions<'py>(
    py: Python<'py>,
    camera: Camera,
    points: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let camera = camera.describe()?;
    let points = rows::<f64, 2>("points", &points)?;
    let directions: Vec<f64> = points.iter().flat_map(|&[x, y]| camera.ray(x, y).direction.to_array()).collect();
    PyArray1::from_vec(py, directions).reshape([points.len(), 3])
}
