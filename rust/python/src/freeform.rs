//! Tori, polygons and implicit surfaces of the Python package, read by attribute.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;

use raywright::math::DVec3;
use raywright::shapes::{Implicit, Polygon, Shape, Torus};

/// `raywright.Torus`.
#[derive(FromPyObject)]
struct PyTorus {
    center: [f64; 3],
    axis: [f64; 3],
    major_radius: f64,
    minor_radius: f64,
}

/// `raywright.Polygon`.
#[derive(FromPyObject)]
struct PyPolygon {
    outline: Vec<[f64; 3]>,
    holes: Vec<Vec<[f64; 3]>>,
}

/// `raywright.shapes.Implicit`.
#[derive(FromPyObject)]
struct PyImplicit {
    expression: String,
    min: [f64; 3],
    max: [f64; 3],
}

fn polygon_of(outline: Vec<[f64; 3]>, holes: Vec<Vec<[f64; 3]>>) -> Result<Polygon, String> {
    let ring = |points: Vec<[f64; 3]>| points.into_iter().map(DVec3::from_array).collect();
    Polygon::new(ring(outline), holes.into_iter().map(ring).collect())
}

/// Reads a torus in its own space.
pub fn torus(shape: &Bound<'_, PyAny>) -> PyResult<Arc<dyn Shape>> {
    let PyTorus { center, axis, major_radius, minor_radius } = shape.extract()?;
    let torus = Torus::new(DVec3::from_array(center), DVec3::from_array(axis), major_radius, minor_radius);
    Ok(Arc::new(torus.map_err(PyValueError::new_err)?))
}

/// Reads a polygon in its own space.
pub fn polygon(shape: &Bound<'_, PyAny>) -> PyResult<Arc<dyn Shape>> {
    let PyPolygon { outline, holes } = shape.extract()?;
    Ok(Arc::new(polygon_of(outline, holes).map_err(PyValueError::new_err)?))
}

/// Reads an implicit surface in its own space.
pub fn implicit(shape: &Bound<'_, PyAny>) -> PyResult<Arc<dyn Shape>> {
    let PyImplicit { expression, min, max } = shape.extract()?;
    let implicit = Implicit::new(&expression, DVec3::from_array(min), DVec3::from_array(max));
    Ok(Arc::new(implicit.map_err(PyValueError::new_err)?))
}

/// The reason why a polygon is invalid, or None.
#[pyfunction]
pub fn polygon_trouble(outline: Vec<[f64; 3]>, holes: Vec<Vec<[f64; 3]>>) -> Option<String> {
    polygon_of(outline, holes).err()
}

/// The reason why an expression or its box is invalid, or None.
#[pyfunction]
pub fn implicit_trouble(expression: &str, min: [f64; 3], max: [f64; 3]) -> Option<String> {
    Implicit::new(expression, DVec3::from_array(min), DVec3::from_array(max)).err()
}
