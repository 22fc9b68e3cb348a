//! Scenes, cameras and integrators as the package describes them, read by attribute.

use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Rows, Triples, pairs, rows};
use super::instances::{self, Wishes};
use super::lights;
use super::materials::Looks;
use super::shapes;
use crate::math::DVec3;
use crate::scene::textures::Needs;
use crate::scene::{self, SceneDescription};

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
    uv: Option<Bound<'py, PyAny>>,
    colors: Option<Triples<'py>>,
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
        let looks = Looks::default();
        let shape = |shape: &Bound<'_, PyAny>| describe(shape, double, &looks);
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
    material: Bound<'py, PyAny>,
    emission: Option<Bound<'py, PyAny>>,
}

/// Reads any shape: a mesh, or what is none.
fn describe(shape: &Bound<'_, PyAny>, double: bool, looks: &Looks) -> PyResult<scene::Shape> {
    let look: Look<'_> = shape.extract()?;
    let material = looks.material(&look.material)?;
    let emission =
        look.emission.map_or_else(|| Ok(scene::Emission::default()), |e| lights::read_emission(&e, &looks.textures))?;
    let look = scene::Shape { material, emission, ..scene::Shape::default() };
    let surface = if shape.get_type().name()? == "Mesh" {
        shape.extract::<Mesh<'_>>()?.describe(double, look.needs())?.into()
    } else {
        shapes::read(shape)?.into()
    };
    Ok(scene::Shape { surface, ..look })
}

impl Mesh<'_> {
    /// Of what is there of its vertices, only what is needed is read.
    fn describe(self, double: bool, needs: Needs) -> PyResult<scene::Mesh> {
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
        let uvs = self.uv.filter(|_| needs.uv).map(|uv| pairs("uv", &uv)).transpose()?;
        let colours = self.colors.filter(|_| needs.colours);
        let colours = colours.map(|c| c.rows("colors").map(|rows| rows.to_single())).transpose()?;
        let colours = colours.map(|all| all.into_iter().map(|colour| colour.to_array()).collect());
        let mesh = scene::Mesh { vertices, faces, normals, uvs, colours };
        let count = mesh.vertices.len();
        let sizes =
            [mesh.normals.as_ref().map(Vec::len), mesh.uvs.as_ref().map(Vec::len), mesh.colours.as_ref().map(Vec::len)];
        match sizes.into_iter().flatten().find(|&size| size != count) {
            Some(size) => Err(PyValueError::new_err(format!("{size} values are given for {count} vertices"))),
            None => Ok(mesh),
        }
    }
}
