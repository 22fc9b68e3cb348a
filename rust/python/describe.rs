//! Scenes, cameras and integrators as the package describes them, read by attribute.

use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Rows, Triples, rows};
use super::instances::{self, Wishes};
use super::lights;
use super::shapes;
use crate::math::DVec3;
use crate::optics::Rgb;
use crate::scene::{self, DiffuseMaterial, SceneDescription};
use std::sync::Arc;

/// `raywright.Scene`.
#[derive(FromPyObject)]
pub struct Scene<'py> {
    shapes: Vec<Bound<'py, PyAny>>,
    lights: Vec<Bound<'py, PyAny>>,
    environment: Option<Bound<'py, PyAny>>,
    precision: String,
    /// How much the build may take for rays to be fast.
    pub quality: String,
}

/// `raywright.Mesh`.
#[derive(FromPyObject)]
struct Mesh<'py> {
    vertices: Triples<'py>,
    faces: PyReadonlyArray2<'py, u32>,
    normals: Option<Triples<'py>>,
}

/// `raywright.Diffuse`.
#[derive(FromPyObject)]
struct Diffuse {
    reflectance: [f64; 3],
}

impl Scene<'_> {
    /// The core's own description of it, and what has to live as long as what is made of it.
    pub fn describe(self) -> PyResult<(SceneDescription, Vec<Py<PyAny>>)> {
        let double = match self.precision.as_str() {
            "single" => false,
            "double" => true,
            other => {
                return Err(PyValueError::new_err(format!(
                    "precision is {other:?}, expected \"single\" or \"double\""
                )));
            }
        };
        let (wishes, mut kept) = (Wishes { double, quality: &self.quality }, Vec::new());
        let shape = |shape: &Bound<'_, PyAny>| describe(shape, double);
        let mut shapes = Vec::with_capacity(self.shapes.len());
        for one in &self.shapes {
            let is_instance = instances::is_instance(one)?;
            shapes.push(if is_instance { instances::read(one, wishes, &mut kept, &shape)? } else { shape(one)? });
        }
        let mut all = self.lights.iter().map(lights::read).collect::<PyResult<Vec<_>>>()?;
        all.extend(lights::read_environment(self.environment)?);
        Ok((SceneDescription { shapes, lights: all }, kept))
    }
}

/// How any shape looks.
#[derive(FromPyObject)]
struct Look<'py> {
    material: Diffuse,
    emission: Option<Bound<'py, PyAny>>,
}

/// Reads any shape: a mesh, or what is none.
fn describe(shape: &Bound<'_, PyAny>, double: bool) -> PyResult<scene::Shape> {
    let look: Look<'_> = shape.extract()?;
    let surface = if shape.get_type().name()? == "Mesh" {
        shape.extract::<Mesh<'_>>()?.describe(double)?.into()
    } else {
        shapes::read(shape)?.into()
    };
    Ok(scene::Shape {
        surface,
        material: Arc::new(DiffuseMaterial { reflectance: Rgb::from_array(look.material.reflectance).into() }),
        emission: look.emission.as_ref().map(lights::read_emission).transpose()?.unwrap_or_default(),
    })
}

impl Mesh<'_> {
    fn describe(self, double: bool) -> PyResult<scene::Mesh> {
        let vertices = match self.vertices.rows("vertices")? {
            Rows::Double(rows) if double => {
                scene::Vertices::Double(rows.iter().map(|&r| DVec3::from_array(r)).collect())
            }
            rows => scene::Vertices::Single(rows.to_single()),
        };
        let faces = rows("faces", &self.faces)?.to_vec();
        if let Some(face) = faces.iter().position(|f| f.iter().any(|&v| v as usize >= vertices.len())) {
            let (corners, count) = (faces[face], vertices.len());
            return Err(PyValueError::new_err(format!("face {face} is {corners:?}, but there are {count} vertices")));
        }
        let normals = self.normals.as_ref().map(|n| n.rows("normals").map(|rows| rows.to_single())).transpose()?;
        Ok(scene::Mesh { vertices, faces, normals, ..scene::Mesh::default() })
    }
}
