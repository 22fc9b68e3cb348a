//! Descriptions of shapes that are not meshes, read by attribute.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;

use super::freeform;
use super::kinds::{Kinds, Read};
use raywright::math::{Affine, DVec3};
use raywright::shapes::{Cuboid, Disk, Ellipsoid, Placed, Plane, Revolution, Shape, Sphere};

/// `raywright.Sphere`.
#[derive(FromPyObject)]
struct PySphere {
    center: [f64; 3],
    radius: f64,
}

/// `raywright.Plane`.
#[derive(FromPyObject)]
struct PyPlane {
    point: [f64; 3],
    normal: [f64; 3],
}

/// `raywright.Disk`.
#[derive(FromPyObject)]
struct PyDisk {
    center: [f64; 3],
    normal: [f64; 3],
    radius: f64,
    inner_radius: f64,
}

/// `raywright.Cylinder`.
#[derive(FromPyObject)]
struct PyCylinder {
    base: [f64; 3],
    tip: [f64; 3],
    radius: f64,
    capped: bool,
}

/// `raywright.Cone`.
#[derive(FromPyObject)]
struct PyCone {
    base: [f64; 3],
    tip: [f64; 3],
    base_radius: f64,
    tip_radius: f64,
    capped: bool,
}

/// `raywright.Box`.
#[derive(FromPyObject)]
struct PyBox {
    min: [f64; 3],
    max: [f64; 3],
}

/// `raywright.shapes.Ellipsoid`.
#[derive(FromPyObject)]
struct PyEllipsoid {
    center: [f64; 3],
    semi_axes: [f64; 3],
}

/// `raywright.shapes.Paraboloid`.
#[derive(FromPyObject)]
struct PyParaboloid {
    apex: [f64; 3],
    tip: [f64; 3],
    radius: f64,
    capped: bool,
}

/// Reads a shape, under its transform if it has one.
///
/// # Errors
///
/// A `TypeError` if it is not a shape, and a `ValueError` for a transform without an inverse.
pub fn read(shape: &Bound<'_, PyAny>) -> PyResult<Arc<dyn Shape>> {
    let own = KINDS.reader(shape)?(shape)?;
    match shape.getattr("transform")?.extract::<Option<[[f64; 4]; 4]>>()? {
        None => Ok(own),
        Some([x, y, z, _]) => {
            let placed = Placed::new(own, Affine::from_matrix([x, y, z]));
            let placed = placed.map_err(|why| PyValueError::new_err(format!("transform has no inverse: {why}")))?;
            Ok(Arc::new(placed))
        }
    }
}

/// Shapes, in their own space.
static KINDS: Kinds<Read<Arc<dyn Shape>>> = Kinds::new(
    "expected a raywright shape",
    &[
        ("shapes.sphere", "Sphere", |of| {
            let PySphere { center, radius } = of.extract()?;
            Ok(Arc::new(Sphere { center: vector(center), radius }))
        }),
        ("shapes.plane", "Plane", |of| {
            let PyPlane { point, normal } = of.extract()?;
            Ok(Arc::new(Plane { point: vector(point), normal: vector(normal) }))
        }),
        ("shapes.disk", "Disk", |of| {
            let PyDisk { center, normal, radius, inner_radius } = of.extract()?;
            Ok(Arc::new(Disk { center: vector(center), normal: vector(normal), radius, inner_radius }))
        }),
        ("shapes.cylinder", "Cylinder", |of| {
            let PyCylinder { base, tip, radius, capped } = of.extract()?;
            Ok(Arc::new(Revolution::cylinder(vector(base), vector(tip), radius, capped)))
        }),
        ("shapes.cone", "Cone", |of| {
            let PyCone { base, tip, base_radius, tip_radius, capped } = of.extract()?;
            Ok(Arc::new(Revolution::cone(vector(base), vector(tip), [base_radius, tip_radius], capped)))
        }),
        ("shapes.box", "Box", |of| {
            let PyBox { min, max } = of.extract()?;
            Ok(Arc::new(Cuboid { min: vector(min), max: vector(max) }))
        }),
        ("shapes.ellipsoid", "Ellipsoid", |of| {
            let PyEllipsoid { center, semi_axes } = of.extract()?;
            Ok(Arc::new(Ellipsoid { center: vector(center), semi_axes: vector(semi_axes) }))
        }),
        ("shapes.paraboloid", "Paraboloid", |of| {
            let PyParaboloid { apex, tip, radius, capped } = of.extract()?;
            Ok(Arc::new(Revolution::paraboloid(vector(apex), vector(tip), radius, capped)))
        }),
        ("shapes.torus", "Torus", freeform::torus),
        ("shapes.polygon", "Polygon", freeform::polygon),
        ("shapes.implicit", "Implicit", freeform::implicit),
    ],
);

fn vector(row: [f64; 3]) -> DVec3 {
    DVec3::from_array(row)
}

/// Lower and upper corner of a shape's bounds under its transform, rounded outwards.
#[pyfunction]
pub fn shape_bounds(shape: &Bound<'_, PyAny>) -> PyResult<[[f64; 3]; 2]> {
    let bounds = read(shape)?.bounds();
    Ok([bounds.min.to_array(), bounds.max.to_array()])
}

/// Area of a shape under its transform.
#[pyfunction]
pub fn shape_area(shape: &Bound<'_, PyAny>) -> PyResult<f64> {
    Ok(read(shape)?.area())
}

/// The reason why an affine matrix has no inverse, or None if it has one.
#[pyfunction]
pub fn matrix_trouble(matrix: [[f64; 4]; 4]) -> Option<String> {
    let [x, y, z, _] = matrix;
    Affine::from_matrix([x, y, z]).inverse().err().map(|why| why.to_string())
}
