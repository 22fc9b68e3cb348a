//! Scenes, cameras and integrators as the package describes them, read by attribute.

use numpy::PyReadonlyArray2;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use super::arrays::{Triples, rows};
use super::level;
use crate::accel::{Accelerator, BruteForce, bvh};
use crate::math::DVec3;
use crate::optics::Rgb;
use crate::scene::{self, Geometry, Material, PointLight, SceneDescription};

/// `raywright.Scene`.
#[derive(FromPyObject)]
pub struct Scene<'py> {
    shapes: Vec<Mesh<'py>>,
    lights: Vec<Light>,
    environment: Option<Environment>,
}

/// `raywright.Mesh`.
#[derive(FromPyObject)]
struct Mesh<'py> {
    vertices: Triples<'py>,
    faces: PyReadonlyArray2<'py, u32>,
    normals: Option<Triples<'py>>,
    material: Diffuse,
    emission: Option<[f64; 3]>,
}

/// `raywright.Diffuse`.
#[derive(FromPyObject)]
struct Diffuse {
    reflectance: [f64; 3],
}

/// `raywright.PointLight`.
#[derive(FromPyObject)]
struct Light {
    position: [f64; 3],
    intensity: [f64; 3],
}

/// `raywright.ConstantEnvironment`.
#[derive(FromPyObject)]
struct Environment {
    radiance: [f64; 3],
}

impl Scene<'_> {
    /// The core's own description of it.
    pub fn describe(self) -> PyResult<SceneDescription> {
        Ok(SceneDescription {
            shapes: self.shapes.into_iter().map(Mesh::describe).collect::<PyResult<_>>()?,
            points: self
                .lights
                .into_iter()
                .map(|light| PointLight {
                    position: DVec3::from_array(light.position),
                    intensity: Rgb::from_array(light.intensity),
                })
                .collect(),
            environment: self.environment.map_or(Rgb::ZERO, |e| Rgb::from_array(e.radiance)),
        })
    }
}

impl Mesh<'_> {
    fn describe(self) -> PyResult<scene::Shape> {
        let vertices = scene::Vertices::from(self.vertices.rows("vertices")?.to_single());
        let faces = rows("faces", &self.faces)?.to_vec();
        if let Some(face) = faces.iter().position(|f| f.iter().any(|&v| v as usize >= vertices.len())) {
            let (corners, count) = (faces[face], vertices.len());
            return Err(PyValueError::new_err(format!("face {face} is {corners:?}, but there are {count} vertices")));
        }
        let normals = self.normals.as_ref().map(|n| n.rows("normals").map(|rows| rows.to_single())).transpose()?;
        Ok(scene::Shape {
            mesh: scene::Mesh { vertices, faces, normals },
            material: Material::Diffuse { reflectance: Rgb::from_array(self.material.reflectance) },
            emission: self.emission.map_or(Rgb::ZERO, Rgb::from_array),
        })
    }
}

/// What to build over a scene's geometry: `raywright.BVH` or `raywright.BruteForce`.
pub enum AcceleratorChoice {
    Bvh(bvh::Options),
    BruteForce,
}

/// `raywright.BVH`.
#[derive(FromPyObject)]
struct Bvh {
    builder: String,
    bins: usize,
    traversal_cost: f32,
    intersection_cost: f32,
}

impl AcceleratorChoice {
    /// Reads a choice by the name of its class.
    pub fn read(choice: &Bound<'_, PyAny>) -> PyResult<Self> {
        let name = choice.get_type().name()?;
        match name.to_str()? {
            "BVH" => {
                let Bvh { builder, bins, traversal_cost, intersection_cost } = choice.extract()?;
                let most = bvh::build::binned::MAX_BINS;
                if builder != "binned" {
                    return Err(PyValueError::new_err(format!("builder is {builder:?}, expected \"binned\"")));
                }
                if !(2..=most).contains(&bins) {
                    return Err(PyValueError::new_err(format!("bins is {bins}, expected 2 to {most}")));
                }
                Ok(Self::Bvh(bvh::Options { bins, traversal_cost, intersection_cost }))
            }
            "BruteForce" => Ok(Self::BruteForce),
            other => Err(PyTypeError::new_err(format!("accelerator is a {other}, expected BVH or BruteForce"))),
        }
    }

    /// Builds it, in the thread pool that is current.
    pub fn build(self) -> PyResult<impl FnOnce(&Geometry) -> Box<dyn Accelerator> + Send> {
        let level = level()?;
        Ok(move |geometry: &Geometry| -> Box<dyn Accelerator> {
            match self {
                Self::Bvh(options) => bvh::widest(geometry, &options, level),
                Self::BruteForce => BruteForce::over(geometry, level),
            }
        })
    }
}
