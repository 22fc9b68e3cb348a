//! Photons of a scene, as arrays.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::query::CompiledScene;
use super::signals::heard;
use raywright::integrators::{Photon, photons as follow};

/// Rows of three numbers.
type PhotonRows<'py> = Bound<'py, PyArray2<f64>>;

/// Positions, directions, normals and powers (K,3); shape_id, primitive, path and bounces (K,); bit masks of the
/// bounces that were sharp and of those in media (K,); and emitted, escaped and absorbed power.
type PhotonArrays<'py> = (
    (PhotonRows<'py>, PhotonRows<'py>, PhotonRows<'py>, PhotonRows<'py>),
    (Bound<'py, PyArray1<i32>>, Bound<'py, PyArray1<i32>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>),
    (Bound<'py, PyArray1<u64>>, Bound<'py, PyArray1<u64>>),
    ([f64; 3], [f64; 3], [f64; 3]),
);

/// Photons at surfaces, and at absorption and scattering in media, from this number of paths.
#[pyfunction]
pub fn photons<'py>(
    py: Python<'py>,
    scene: &Bound<'py, CompiledScene>,
    count: u32,
    max_depth: Option<u32>,
    roulette_depth: u32,
    seed: u64,
    threads: Option<usize>,
) -> PyResult<PhotonArrays<'py>> {
    let scene = &scene.get().0;
    if let Some(why) = scene.not_drawn().or_else(|| scene.glow()) {
        return Err(PyValueError::new_err(format!("{why}, and light paths cannot start there")));
    }
    let found = heard(py, threads, |cancel| follow(scene, count, (max_depth, roulette_depth), seed, cancel))?;
    let all = &found.photons;
    let rows =
        |of: fn(&Photon) -> [f64; 3]| PyArray1::from_vec(py, all.iter().flat_map(of).collect()).reshape([all.len(), 3]);
    Ok((
        (
            rows(|photon| photon.position.to_array())?,
            rows(|photon| photon.direction.to_array())?,
            rows(|photon| photon.normal.to_array())?,
            rows(|photon| photon.power.to_array())?,
        ),
        (
            PyArray1::from_iter(py, all.iter().map(|photon| photon.surface.map_or(-1, |(shape, _)| shape as i32))),
            PyArray1::from_iter(py, all.iter().map(|photon| photon.surface.map_or(-1, |(_, face)| face as i32))),
            PyArray1::from_iter(py, all.iter().map(|photon| i64::from(photon.path))),
            PyArray1::from_iter(py, all.iter().map(|photon| i64::from(photon.bounces))),
        ),
        (
            PyArray1::from_iter(py, all.iter().map(|photon| photon.sharp)),
            PyArray1::from_iter(py, all.iter().map(|photon| photon.adrift)),
        ),
        (found.emitted.to_array(), found.escaped.to_array(), found.absorbed.to_array()),
    ))
}
