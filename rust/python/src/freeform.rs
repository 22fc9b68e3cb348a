//! Toruses, polygons and implicit surfaces, as the package describes them, read by attribute.

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

/// The shape in its own space, if the name of its class is one of these.
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

/// What is wrong with a polygon, or None if nothing is.
#[pyfunction]
pub fn polygon_trouble(outline: Vec<[f64; 3]>, holes: Vec<Vec<[f64; 3]>>) -> Option<String> {
    polygon(outline, holes).err()
}

/// What is wrong with an expression or its box, or None if nothing is.
#[pyfunction]
pub fn implicit_trouble(expression: &str, min: [f64; 3], max: [f64; 3]) -> Option<String> {
    Implicit::new(expression, DVec3::from_array(min), DVec3::from_array(max)).err()
}
