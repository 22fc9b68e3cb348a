//! Integrator descriptions of the Python package, read by attribute, and auxiliary buffers (AOVs).

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArrayDyn};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{numbers, vectors};
use super::cameras::AnyCamera;
use super::kinds::{Kinds, Read};
use super::query::CompiledScene;
use super::signals::heard;
use raywright::integrators::{
    AmbientOcclusion, BeamTraced, Bidirectional, Channel, ConeTraced, Direct, Distributed, Guiding, Integrator, Kernel,
    LightTraced, Merge, Path, PhotonMap, ProgressivePhotonMap, Radiosity, RayCast, Whitted, aovs as observe,
};
use raywright::optics::Rgb;
use raywright::scene::{Patches, PlanRow};

/// Any integrator of the package.
pub struct AnyIntegrator(pub Box<dyn Integrator>);

/// An attribute of a description.
fn attribute<'py, T: FromPyObjectOwned<'py>>(of: &Bound<'py, PyAny>, name: &str) -> PyResult<T> {
    of.getattr(name)?.extract::<T>().map_err(Into::into)
}

fn rgb(of: &Bound<'_, PyAny>, name: &str) -> PyResult<Rgb> {
    attribute::<[f64; 3]>(of, name).map(Rgb::from_array)
}

/// Kernel of photon density estimation.
fn kernel(of: &Bound<'_, PyAny>) -> PyResult<Kernel> {
    match attribute::<String>(of, "filter")?.as_str() {
        "cone" => Ok(Kernel::Cone),
        "epanechnikov" => Ok(Kernel::Epanechnikov),
        _ => Ok(Kernel::Box),
    }
}

/// Options of vertex merging, if it is enabled.
fn merge(of: &Bound<'_, PyAny>) -> PyResult<Option<Merge>> {
    if !attribute::<bool>(of, "vertex_merging")? {
        return Ok(None);
    }
    let (radius, photons) = (attribute(of, "radius")?, attribute(of, "photons")?);
    Ok(Some(Merge { radius, photons, ..Merge::default() }))
}

/// A path tracer; options left open get plain defaults.
pub fn path(of: &Bound<'_, PyAny>) -> PyResult<Path> {
    Ok(Path {
        max_depth: attribute(of, "max_depth")?,
        roulette_depth: attribute(of, "roulette_depth")?,
        reuse: attribute::<Option<u32>>(of, "reuse")?.unwrap_or(1),
        guiding: match attribute::<Option<String>>(of, "guiding")?.as_deref() {
            Some("photons") => Guiding::Photons,
            Some("learned") => Guiding::Learned,
            _ => Guiding::None,
        },
    })
}

/// Data of a radiosity lookup: cuts (F,), the first face of each primitive of the scene (N + 1,), flags of mirrored
/// faces (F,), irradiance at three corners (S,3,3), whether there are back sides, and the area of surfaces that are not
/// instances.
type RadiosityTable<'py> = (
    PyReadonlyArray1<'py, u32>,
    PyReadonlyArray1<'py, u32>,
    PyReadonlyArray1<'py, bool>,
    PyReadonlyArrayDyn<'py, f64>,
    bool,
    f64,
);

fn radiosity(of: &Bound<'_, PyAny>) -> PyResult<Radiosity> {
    let (cuts, first, mirrored, irradiance, has_backs, area) = of.getattr("_table")?.extract::<RadiosityTable<'_>>()?;
    let patches = Patches::new(numbers("cuts", &cuts)?.to_vec()).map_err(PyValueError::new_err)?;
    let corners: &[[f64; 3]] = vectors("irradiance", &irradiance)?;
    let irradiance: Vec<_> = corners.as_chunks().0.iter().map(|all: &[_; 3]| all.map(Rgb::from_array)).collect();
    let wanted = patches.count() * if has_backs { 2 } else { 1 };
    if irradiance.len() != wanted {
        return Err(PyValueError::new_err(format!("irradiance is of {} sides, expected {wanted}", irradiance.len())));
    }
    let (first, mirrored) = (numbers("first", &first)?.to_vec(), numbers("mirrored", &mirrored)?.to_vec());
    if first.last().is_none_or(|&all| all as usize != patches.primitives()) || mirrored.len() != patches.primitives() {
        return Err(PyValueError::new_err(format!("first and mirrored must be of {} faces", patches.primitives())));
    }
    Ok(Radiosity { patches, first, mirrored, has_backs, irradiance, area })
}

static KINDS: Kinds<Read<Box<dyn Integrator>>> = Kinds::new(
    "integrator must be one of raywright's",
    &[
        ("integrators.path", "Path", |of| Ok(Box::new(path(of)?))),
        ("integrators.light_traced", "LightTraced", |of| {
            Ok(Box::new(LightTraced {
                max_depth: attribute(of, "max_depth")?,
                roulette_depth: attribute(of, "roulette_depth")?,
            }))
        }),
        ("integrators.photon_maps", "PhotonMap", |of| {
            Ok(Box::new(PhotonMap {
                photons: attribute(of, "photons")?,
                nearest: attribute(of, "k_nearest")?,
                radius: attribute(of, "radius")?,
                caustic: attribute(of, "caustic")?,
                gather: attribute(of, "final_gather")?,
                maps: attribute(of, "maps")?,
                kernel: kernel(of)?,
                max_depth: attribute(of, "max_depth")?,
                roulette_depth: attribute(of, "roulette_depth")?,
                scale: 1.0,
            }))
        }),
        ("integrators.photon_maps", "ProgressivePhotonMap", |of| {
            Ok(Box::new(ProgressivePhotonMap {
                photons: attribute(of, "photons")?,
                radius: attribute(of, "radius")?,
                alpha: attribute(of, "alpha")?,
                gather: attribute(of, "final_gather")?,
                kernel: kernel(of)?,
                max_depth: attribute(of, "max_depth")?,
                roulette_depth: attribute(of, "roulette_depth")?,
                scale: 1.0,
                mean_of: None,
            }))
        }),
        ("integrators.bidirectional", "Bidirectional", |of| {
            Ok(Box::new(Bidirectional {
                max_depth: attribute(of, "max_depth")?,
                roulette_depth: attribute(of, "roulette_depth")?,
                merge: merge(of)?,
                alone: None,
            }))
        }),
        ("integrators.direct", "Direct", |of| {
            Ok(Box::new(Direct {
                light_samples: attribute(of, "light_samples")?,
                surface_samples: attribute(of, "surface_samples")?,
            }))
        }),
        ("integrators.radiosity", "Radiosity", |of| Ok(Box::new(radiosity(of)?))),
        ("integrators.ray_cast", "RayCast", |of| {
            Ok(Box::new(RayCast {
                ambient: rgb(of, "ambient")?,
                shadows: attribute(of, "shadows")?,
                light_samples: attribute(of, "light_samples")?,
            }))
        }),
        ("integrators.whitted", "Whitted", |of| {
            Ok(Box::new(Whitted {
                max_depth: attribute(of, "max_depth")?,
                contribution: attribute(of, "contribution")?,
                ambient: rgb(of, "ambient")?,
                light_samples: attribute(of, "light_samples")?,
            }))
        }),
        ("integrators.distributed", "Distributed", |of| {
            Ok(Box::new(Distributed {
                max_depth: attribute(of, "max_depth")?,
                splits: attribute(of, "splits")?,
                ambient: rgb(of, "ambient")?,
            }))
        }),
        ("integrators.beam_traced", "BeamTraced", |of| {
            Ok(Box::new(BeamTraced {
                max_depth: attribute(of, "max_depth")?,
                ambient: rgb(of, "ambient")?,
                tolerance: attribute(of, "tolerance")?,
            }))
        }),
        ("integrators.cone_traced", "ConeTraced", |of| {
            Ok(Box::new(ConeTraced {
                max_depth: attribute(of, "max_depth")?,
                contribution: attribute(of, "contribution")?,
                ambient: rgb(of, "ambient")?,
            }))
        }),
        ("integrators.ambient_occlusion", "AmbientOcclusion", |of| {
            Ok(Box::new(AmbientOcclusion {
                radius: attribute(of, "radius")?,
                cosine: attribute(of, "cosine")?,
                samples: attribute(of, "samples")?,
            }))
        }),
    ],
);

impl FromPyObject<'_, '_> for AnyIntegrator {
    type Error = PyErr;

    fn extract(of: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        KINDS.reader(&of)?(&of).map(Self)
    }
}

/// AOVs by name, float64 (H,W) or (H,W,n), in the requested order.
#[pyfunction]
pub fn aovs<'py>(
    py: Python<'py>,
    scene: &Bound<'_, CompiledScene>,
    camera: AnyCamera,
    names: Vec<String>,
    samples: u32,
    seed: u64,
    threads: Option<usize>,
) -> PyResult<Vec<Bound<'py, PyArrayDyn<f64>>>> {
    let named = |name: &String| {
        let found = Channel::ALL.into_iter().find(|channel| channel.name() == name);
        found.ok_or_else(|| {
            let all = Channel::ALL.map(Channel::name).join(", ");
            PyValueError::new_err(format!("aov {name:?} is unknown, expected some of {all}"))
        })
    };
    let channels: Vec<Channel> = names.iter().map(named).collect::<PyResult<_>>()?;
    let (scene, camera) = (&scene.get().0, &*camera.0);
    let pictures = heard(py, threads, |cancel| observe(scene, camera, &channels, samples, seed, cancel))?;
    let size = [camera.height() as usize, camera.width() as usize];
    let array = |(channel, values): (&Channel, Vec<f64>)| match channel.width() {
        1 => PyArray1::from_vec(py, values).reshape(&size[..]),
        n => PyArray1::from_vec(py, values).reshape(&[size[0], size[1], n][..]),
    };
    channels.iter().zip(pictures).map(array).collect()
}

/// The scene's plan: rows of feature, presence and effect.
#[pyfunction]
pub fn plan(scene: &Bound<'_, CompiledScene>) -> Vec<PlanRow> {
    scene.get().0.plan().rows()
}
