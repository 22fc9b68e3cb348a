//! Scenes, cameras and integrators as the package describes them, read by attribute.

use std::fmt::Display;
use std::ops::RangeInclusive;

use numpy::PyReadonlyArray2;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use super::arrays::{Rows, Triples, rows};
use super::level;
use crate::accel::bvh::build::halves::Way;
use crate::accel::bvh::build::morton::Bits;
use crate::accel::bvh::build::{Builder, ploc, spatial};
use crate::accel::bvh::optimise::{Optimiser, Optimisers};
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
        let double = match self.precision.as_str() {
            "single" => false,
            "double" => true,
            other => {
                return Err(PyValueError::new_err(format!(
                    "precision is {other:?}, expected \"single\" or \"double\""
                )));
            }
        };
        Ok(SceneDescription {
            shapes: self.shapes.into_iter().map(|mesh| mesh.describe(double)).collect::<PyResult<_>>()?,
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
    fn describe(self, double: bool) -> PyResult<scene::Shape> {
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
        Ok(scene::Shape {
            surface: scene::Mesh { vertices, faces, normals }.into(),
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
    bins: Option<usize>,
    traversal_cost: f32,
    intersection_cost: f32,
    budget: Option<f32>,
    radius: Option<usize>,
    optimise: Option<Vec<String>>,
}

impl Bvh {
    fn builder(&self) -> PyResult<Builder> {
        let Self { bins, budget, radius, .. } = *self;
        within("bins", bins, 2..=bvh::build::binned::MAX_BINS)?;
        within("budget", budget, 0.0..=spatial::MAX_BUDGET)?;
        within("radius", radius, 1..=ploc::MAX_RADIUS)?;
        Ok(match self.builder.as_str() {
            "binned" => Builder::Binned { bins },
            "sweep" => Builder::Sweep,
            "spatial" => Builder::Spatial { bins, budget: budget.unwrap_or(spatial::BUDGET) },
            "morton" => Builder::Morton(Bits::default()),
            "ploc" => Builder::Ploc { radius: radius.unwrap_or(ploc::RADIUS) },
            "midpoint" => Builder::Halves(Way::Midpoint),
            "median" => Builder::Halves(Way::Median),
            "mean" => Builder::Halves(Way::Mean),
            other => return Err(unknown("builder", other, &BUILDERS)),
        })
    }

    fn optimisers(&self) -> PyResult<Option<Optimisers>> {
        let Some(names) = &self.optimise else { return Ok(None) };
        let optimiser = |name: &String| match name.as_str() {
            "reinsertion" => Ok(Optimiser::Reinsertion),
            "treelet" => Ok(Optimiser::Treelet),
            other => Err(unknown("optimise", other, &["reinsertion", "treelet"])),
        };
        let optimisers = names.iter().map(optimiser).collect::<PyResult<Vec<_>>>()?;
        match Optimisers::new(optimisers) {
            Some(optimisers) => Ok(Some(optimisers)),
            None => Err(PyValueError::new_err(format!("optimise is {names:?}, expected each at most once"))),
        }
    }
}

const BUILDERS: [&str; 8] = ["binned", "sweep", "spatial", "morton", "ploc", "midpoint", "median", "mean"];

fn unknown(name: &str, came: &str, expected: &[&str]) -> PyErr {
    PyValueError::new_err(format!("{name} is {came:?}, expected one of {}", expected.join(", ")))
}

fn within<T: PartialOrd + Display>(name: &str, came: Option<T>, range: RangeInclusive<T>) -> PyResult<()> {
    match came.filter(|came| !range.contains(came)) {
        Some(came) => {
            Err(PyValueError::new_err(format!("{name} is {came}, expected {} to {}", range.start(), range.end())))
        }
        None => Ok(()),
    }
}

impl AcceleratorChoice {
    /// Reads a choice by the name of its class; `quality` says how much the build may take.
    pub fn read(choice: &Bound<'_, PyAny>, quality: &str) -> PyResult<Self> {
        let name = choice.get_type().name()?;
        match name.to_str()? {
            "BVH" => {
                let bvh: Bvh = choice.extract()?;
                let quality = match quality {
                    "fast build" => bvh::Quality::FastBuild,
                    "balanced" => bvh::Quality::Balanced,
                    "fast rays" => bvh::Quality::FastRays,
                    other => {
                        return Err(PyValueError::new_err(format!(
                            "quality is {other:?}, expected \"fast build\", \"balanced\" or \"fast rays\""
                        )));
                    }
                };
                Ok(Self::Bvh(bvh::Options {
                    quality,
                    builder: bvh.builder()?,
                    optimisers: bvh.optimisers()?,
                    traversal_cost: bvh.traversal_cost,
                    intersection_cost: bvh.intersection_cost,
                }))
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
                Self::Bvh(options) => bvh::over(geometry, &options, level),
                Self::BruteForce => BruteForce::over(geometry, level),
            }
        })
    }
}
