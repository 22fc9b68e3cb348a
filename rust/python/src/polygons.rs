//! Triangulation of polygons.

use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{numbers, rows};
use raywright::shapes::triangulate;

/// Triangulate polygons with these numbers of corners: (T, 3) indices of corners, which are indices of points.
#[pyfunction]
pub fn triangulate_polygons<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'py, f64>,
    corners: PyReadonlyArray1<'py, i64>,
    counts: PyReadonlyArray1<'py, i64>,
) -> PyResult<Bound<'py, PyArray2<i64>>> {
    let points: &[[f64; 3]] = rows("points", &points)?;
    let corners: &[i64] = numbers("corners", &corners)?;
    let counts: Vec<usize> = numbers("counts", &counts)?.iter().map(|&n| n.max(0) as usize).collect();
    let is_there = |&i: &i64| usize::try_from(i).is_ok_and(|i| i < points.len());
    if counts.iter().sum::<usize>() != corners.len() || !corners.iter().all(is_there) {
        return Err(PyValueError::new_err(
            "counts must sum to the number of corners, and corners must be indices of points",
        ));
    }
    let found = py.detach(|| triangulate(points, corners, &counts));
    let count = found.len();
    found.into_flattened().into_pyarray(py).reshape([count, 3])
}
