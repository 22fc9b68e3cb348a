//! Scene descriptions of the Python package, read by attribute.

use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::collections::HashSet;
use std::sync::Arc;

use super::arrays::{TripleRows, Triples, pairs, rows};
use super::builds::Builds;
use super::instances::{self, Wishes};
use super::kinds::Class;
use super::lights;
use super::materials::Appearances;
use super::media;
use super::shapes;
use raywright::scene::media::Medium;
use raywright::scene::textures::Needs;
use raywright::scene::{self, Precision, Rounding, SceneDescription, Surface};

/// `raywright.Scene`.
#[derive(FromPyObject)]
pub struct Scene<'py> {
    shapes: Vec<Bound<'py, PyAny>>,
    lights: Vec<Bound<'py, PyAny>>,
    environment: Option<Bound<'py, PyAny>>,
    medium: Option<Bound<'py, PyAny>>,
    precision: String,
    /// Reason for spectral rendering; `None` for red, green and blue.
    wavelengths: Option<String>,
    /// The `shapes` tuple itself.
    #[pyo3(attribute("shapes"))]
    pub all_shapes: Py<PyAny>,
    /// Build effort of the accelerator.
    pub quality: String,
    /// Treatment of shading normals.
    shading_normals: String,
}

/// `raywright.Mesh`.
#[derive(FromPyObject)]
struct PyMesh<'py> {
    vertices: Triples<'py>,
    faces: PyReadonlyArray2<'py, u32>,
    normals: Option<Triples<'py>>,
    uv: Option<Bound<'py, PyAny>>,
    colors: Option<Triples<'py>>,
}

impl Scene<'_> {
    /// Returns whether shading normals are used as given.
    pub fn normals_as_given(&self) -> bool {
        self.shading_normals == "raw"
    }

    /// Converts to the core's description. Also returns the objects that must live as long as the result.
    ///
    /// Prototypes that are not cached are built as part of `builds`.
    pub fn describe(self, builds: &Builds) -> PyResult<(SceneDescription, Vec<Py<PyAny>>)> {
        let precision = match self.precision.as_str() {
            "auto" => Precision::Auto,
            "single" => Precision::Single,
            "double" => Precision::Double,
            other => {
                return Err(PyValueError::new_err(format!(
                    "precision is {other:?}, expected \"auto\", \"single\" or \"double\""
                )));
            }
        };
        let waves = self.wavelengths.is_some();
        let wishes = Wishes { precision, quality: &self.quality, waves, builds };
        let (appearances, mut kept) = (Appearances::new(waves), Vec::new());
        let shapes = read(&self.shapes, wishes, &appearances, &mut kept)?;
        let mut all = self.lights.iter().map(|light| lights::read(light, waves)).collect::<PyResult<Vec<_>>>()?;
        all.extend(lights::read_environment(self.environment, waves)?);
        Ok((SceneDescription { shapes, lights: all }, kept))
    }

    /// The medium outside all closed surfaces.
    pub fn surrounding(&self) -> PyResult<Option<Arc<dyn Medium>>> {
        self.medium.as_ref().map(|medium| media::read(medium, self.wavelengths.is_some())).transpose()
    }

    /// Size of the build, prototypes included.
    pub fn size(&self) -> PyResult<usize> {
        instances::size(&self.shapes, &mut HashSet::new())
    }
}

/// Attributes of all shapes that determine their appearance.
#[derive(FromPyObject)]
struct Appearance<'py> {
    material: Bound<'py, PyAny>,
    emission: Option<Bound<'py, PyAny>>,
}

/// Reads the shapes of a scene, or of a prototype in it. Vertices are rounded as they are read. If that is a loss, all
/// are read again, so that meshes that share vertices still do.
fn read(
    all: &[Bound<'_, PyAny>],
    wishes: Wishes<'_>,
    appearances: &Appearances,
    kept: &mut Vec<Py<PyAny>>,
) -> PyResult<Vec<scene::Shape>> {
    let (mut shapes, mut rounded) = (Vec::with_capacity(all.len()), Vec::new());
    for one in all {
        if instances::is_instance(one)? {
            shapes.push(instances::read(one, wishes, kept, &|within, kept| read(within, wishes, appearances, kept))?);
            continue;
        }
        let (shape, given) = describe(one, wishes.precision, appearances)?;
        one.py().check_signals()?;
        rounded.extend(given.map(|given| (shapes.len(), given)));
        shapes.push(shape);
    }
    let meshes = shapes.iter().filter_map(|shape| if let Surface::Mesh(m) = &shape.surface { Some(m) } else { None });
    if wishes.precision.is_double(meshes.map(|mesh| mesh.rounding).fold(Rounding::default(), Rounding::worst)) {
        for (number, given) in rounded {
            if let Surface::Mesh(mesh) = &mut shapes[number].surface {
                mesh.vertices = given.rows("vertices")?.vertices();
            }
        }
    }
    Ok(shapes)
}

static MESH: Class = Class::new("shapes.mesh", "Mesh");

/// Reads a mesh or another shape. A mesh whose vertices were rounded is read with all digits.
fn describe<'py>(
    shape: &Bound<'py, PyAny>,
    precision: Precision,
    appearances: &Appearances,
) -> PyResult<(scene::Shape, Option<Triples<'py>>)> {
    let appearance: Appearance<'_> = shape.extract()?;
    let material = appearances.material(&appearance.material)?;
    let emission = appearance
        .emission
        .map_or_else(|| Ok(scene::Emission::default()), |e| lights::read_emission(&e, &appearances.textures))?;
    let appearance = scene::Shape { material, emission, ..scene::Shape::default() };
    if !MESH.has(shape)? {
        return Ok((scene::Shape { surface: shapes::read(shape)?.into(), ..appearance }, None));
    }
    let given = shape.extract::<PyMesh<'py>>()?;
    let mesh = given.describe(precision, appearance.needs())?;
    let is_rounded = mesh.rounding.moved > 0.0;
    Ok((scene::Shape { surface: mesh.into(), ..appearance }, is_rounded.then_some(given.vertices)))
}

impl PyMesh<'_> {
    /// Reads only the vertex attributes that are needed.
    fn describe(&self, precision: Precision, needs: Needs) -> PyResult<scene::Mesh> {
        let (given, faces) = (self.vertices.rows("vertices")?, rows("faces", &self.faces)?.to_vec());
        let count = given.len();
        if let Some(face) = faces.iter().position(|f| f.iter().any(|&v| v as usize >= count)) {
            let corners = faces[face];
            return Err(PyValueError::new_err(format!("face {face} is {corners:?}, but there are {count} vertices")));
        }
        let (vertices, rounding) = match given {
            TripleRows::Double(rows) if precision != Precision::Double => scene::rounded(rows, &faces),
            given => (given.vertices(), Rounding::default()),
        };
        let normals = self.normals.as_ref().map(|n| n.rows("normals").map(|rows| rows.to_single())).transpose()?;
        let uvs = self.uv.as_ref().filter(|_| needs.uv).map(|uv| pairs("uv", uv)).transpose()?;
        let colours = self.colors.as_ref().filter(|_| needs.colours);
        let colours = colours.map(|c| c.rows("colors").map(|rows| rows.to_single())).transpose()?;
        let colours = colours.map(|all| all.into_iter().map(|colour| colour.to_array()).collect());
        let mesh = scene::Mesh { vertices, rounding, faces, normals, uvs, colours };
        let sizes =
            [mesh.normals.as_ref().map(Vec::len), mesh.uvs.as_ref().map(Vec::len), mesh.colours.as_ref().map(Vec::len)];
        match sizes.into_iter().flatten().find(|&size| size != count) {
            Some(size) => Err(PyValueError::new_err(format!("{size} values are given for {count} vertices"))),
            None => Ok(mesh),
        }
    }
}
