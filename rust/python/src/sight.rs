//! Renders that are looked at while they go on.

use numpy::{PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use super::render::Rendering;
use raywright::render;

/// What can be seen of a render from outside while a pass is worked on; `None` of everything between passes, when the
/// render itself can be asked.
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

    /// Whether nobody works on it: whoever looks is waited for.
    #[getter]
    fn is_done(&self) -> bool {
        self.of.is_done()
    }

    /// The render without its pixels.
    fn outline(&self) -> Option<Rendering> {
        self.of.outline().map(Rendering)
    }

    /// All of the render as it is now, to be looked at.
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

    /// Samples that were not finite or negative, and samples that were clamped.
    #[getter]
    fn amiss(&self) -> Option<(u64, u64)> {
        self.of.amiss().map(|[dropped, clamped]| (dropped, clamped))
    }
}
