//! Views of renders in progress.

use numpy::{PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use super::render::Rendering;
use raywright::render;

/// A view of a render during a pass; everything is `None` between passes, when the render itself is accessible.
#[pyclass(module = "raywright._core", frozen)]
pub struct Sight {
    of: render::Sight,
    width: usize,
    height: usize,
}

#[pymethods]
impl Sight {
    #[new]
    fn new(rendering: &Rendering) -> Self {
        let film = &rendering.0.film;
        Self { of: rendering.0.sight(), width: film.width() as usize, height: film.height() as usize }
    }

    #[getter]
    fn is_open(&self) -> bool {
        self.of.is_open()
    }

    /// Returns whether no thread works on it; the render then waits for observers.
    #[getter]
    fn is_done(&self) -> bool {
        self.of.is_done()
    }

    /// The render without its pixels.
    fn outline(&self) -> Option<Rendering> {
        self.of.outline().map(Rendering)
    }

    /// A full copy of the current state.
    fn copy(&self, py: Python<'_>) -> Option<Rendering> {
        py.detach(|| self.of.copy()).map(Rendering)
    }

    #[getter]
    fn rgb<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<f32>>>> {
        let Some(pixels) = py.detach(|| self.of.rgb()) else { return Ok(None) };
        numpy::PyArray1::from_vec(py, pixels.into_flattened()).reshape([self.height, self.width, 3]).map(Some)
    }

    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<u32>>>> {
        let Some(counts) = py.detach(|| self.of.counts()) else { return Ok(None) };
        numpy::PyArray1::from_vec(py, counts).reshape([self.height, self.width]).map(Some)
    }

    /// Number of samples that were not finite or negative, and number of clamped samples.
    #[getter]
    fn amiss(&self) -> Option<(u64, u64)> {
        self.of.amiss().map(|[dropped, clamped]| (dropped, clamped))
    }
}
