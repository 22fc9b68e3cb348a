//! Mesh topology and plane sections, from arrays to arrays.

use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Triples, rows};
use super::rays::each;
use raywright::math::DVec3;
use raywright::scene::topology::{self, Cutter, FaceKind, Rule, Section, Topology};

/// Corners and faces in array form, validated.
fn read<'a>(vertices: &'a Triples<'_>, faces: &'a PyReadonlyArray2<'_, u32>) -> PyResult<(Vec<DVec3>, &'a [[u32; 3]])> {
    let (given, faces): (_, &[[u32; 3]]) = (vertices.rows("vertices")?, rows("faces", faces)?);
    let points: Vec<DVec3> = (0..given.len()).map(|i| given.get(i)).collect();
    match faces.iter().flatten().find(|&&v| v as usize >= points.len()) {
        Some(v) => Err(PyValueError::new_err(format!("faces name vertex {v} of {}", points.len()))),
        None => Ok((points, faces)),
    }
}

/// For each corner, the number of its representative, within one tolerance for all or one per corner.
#[pyfunction]
pub fn weld<'py>(
    py: Python<'py>,
    vertices: Triples<'py>,
    faces: PyReadonlyArray2<'py, u32>,
    tolerances: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<u32>>> {
    let (points, faces) = read(&vertices, &faces)?;
    let tolerances = tolerances.as_slice()?;
    if tolerances.len() != 1 && tolerances.len() != points.len() {
        let told = format!("tolerances must have length 1 or {}, got {}", points.len(), tolerances.len());
        return Err(PyValueError::new_err(told));
    }
    Ok(PyArray1::from_vec(py, py.detach(|| topology::welded(&points, faces, tolerances))))
}

/// Distance between corners of a mesh that differ by rounding.
#[pyfunction]
pub fn weld_rounding<'py>(py: Python<'py>, vertices: Triples<'py>, faces: PyReadonlyArray2<'py, u32>) -> PyResult<f64> {
    let (points, faces) = read(&vertices, &faces)?;
    Ok(py.detach(|| topology::rounding(&points, faces)))
}

/// Topology of a mesh.
#[pyclass(frozen, get_all, module = "raywright._core")]
pub struct MeshTopology {
    /// Volume of each body, and whether it is oriented.
    volumes: Vec<f64>,
    is_oriented: Vec<bool>,
    /// Cracks, as edges between corners, and T-junctions, as corners.
    cracks: Vec<[u32; 2]>,
    junctions: Vec<u32>,
    /// Numbers of faces by kind.
    closed: usize,
    open: usize,
    inner: usize,
    duplicates: usize,
    degenerate: usize,
    turned: usize,
    tolerance: f64,
}

#[pyfunction]
pub fn mesh_topology<'py>(
    py: Python<'py>,
    vertices: Triples<'py>,
    faces: PyReadonlyArray2<'py, u32>,
    tolerance: Option<f64>,
) -> PyResult<MeshTopology> {
    let (points, faces) = read(&vertices, &faces)?;
    let found = py.detach(|| Topology::new(&points, faces, tolerance));
    let count = |is: fn(&FaceKind) -> bool| found.faces.iter().filter(|kind| is(kind)).count();
    Ok(MeshTopology {
        volumes: found.bodies.iter().map(|body| body.volume).collect(),
        is_oriented: found.bodies.iter().map(|body| body.is_oriented).collect(),
        closed: count(|kind| matches!(kind, FaceKind::Closed(_))),
        open: count(|kind| *kind == FaceKind::Open),
        inner: count(|kind| *kind == FaceKind::Inner),
        duplicates: count(|kind| *kind == FaceKind::Duplicate),
        degenerate: count(|kind| *kind == FaceKind::Degenerate),
        cracks: found.cracks,
        junctions: found.junctions,
        turned: found.turned,
        tolerance: found.tolerance,
    })
}

/// Points of all polylines of a plane, the ends of each, whether each is closed, and the area.
type Lines<'py> = (Bound<'py, PyArray2<f64>>, Vec<usize>, Vec<bool>, f64);

/// Sections of faces with planes, plane by plane.
#[pyfunction]
pub fn sections<'py>(
    py: Python<'py>,
    vertices: Triples<'py>,
    faces: PyReadonlyArray2<'py, u32>,
    origins: PyReadonlyArray2<'py, f64>,
    normals: PyReadonlyArray2<'py, f64>,
    even_odd: bool,
    tolerance: Option<f64>,
) -> PyResult<Vec<Lines<'py>>> {
    let (points, faces) = read(&vertices, &faces)?;
    let (origins, normals): (&[[f64; 3]], &[[f64; 3]]) = (rows("origins", &origins)?, rows("normals", &normals)?);
    let cutter = py.detach(|| Cutter::new(&points, faces, tolerance, origins.len()));
    let rule = if even_odd { Rule::EvenOdd } else { Rule::Winding };
    let planes: Vec<[DVec3; 2]> =
        origins.iter().zip(normals).map(|(&at, &way)| [DVec3::from_array(at), DVec3::from_array(way)]).collect();
    let found = each(py, None, planes, |[origin, normal]| cutter.cut(origin, normal, rule))?;
    found.into_iter().map(|section| written(py, &section)).collect()
}

fn written<'py>(py: Python<'py>, section: &Section) -> PyResult<Lines<'py>> {
    let points: Vec<f64> =
        section.lines.iter().flat_map(|line| &line.points).flat_map(|point| point.to_array()).collect();
    let mut splits = vec![0];
    for line in &section.lines {
        splits.push(splits[splits.len() - 1] + line.points.len());
    }
    let rows = points.len() / 3;
    let points = numpy::PyArrayMethods::reshape(&PyArray1::from_vec(py, points), [rows, 3])?;
    Ok((points, splits, section.lines.iter().map(|line| line.is_closed).collect(), section.area))
}
