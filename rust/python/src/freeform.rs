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

/// `raywright.Implicit`.
#[derive(FromPyObject)]
struct PyImplicit {
    expression: String,
    min: [f64; 3],
    max: [f64; 3],
}

fn polygon(outline: Vec<[f64; 3]>, holes: Vec<Vec<[f64; 3]>>) -> Result<Polygon, String> {
    let ring = |points: Vec<[f64; 3]>| points.into_iter().map(DVec3::from_array).collect();
    Polygon::new(ring(outline), holes.into_iter().map(ring).collect())
}

/// The shape in its own space, if the class name is one of these.
pub fn read(name: &str, shape: &Bound<'_, PyAny>) -> PyResult<Option<Arc<dyn Shape>>> {
    let vector = DVec3::from_array;
    Ok(Some(match name {
        "Torus" => {
            let PyTorus { center, axis, major_radius, minor_radius } = shape.extract()?;
            let torus = Torus::new(vector(center), vector(axis), major_radius, minor_radius);
            Arc::new(torus.map_err(PyValueError::new_err)?)
        }
        "Polygon" => {
            let PyPolygon { outline, holes } = shape.extract()?;
            Arc::new(polygon(outline, holes).map_err(PyValueError::new_err)?)
        }
        "Implicit" => {
            let PyImplicit { expression, min, max } = shape.extract()?;
            Arc::new(Implicit::new(&expression, vector(min), vector(max)).map_err(PyValueError::new_err)?)
        }
        _ => return Ok(None),
    }))
}

/// The reason why a polygon is invalid, or None.
#[pyfunction]
pub fn polygon_trouble(outline: Vec<[f64; 3]>, holes: Vec<Vec<[f64; 3]>>) -> Option<String> {
    polygon(outline, holes).err()
}

/// The reason why an expression or its box is invalid, or None.
#[pyfunction]
pub fn implicit_trouble(expression: &str, min: [f64; 3], max: [f64; 3]) -> Option<String> {
    Implicit::new(expression, DVec3::from_array(min), DVec3::from_array(max)).err()
}
