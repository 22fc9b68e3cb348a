//! Scenes to pictures.

use numpy::{PyArray2, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::ops::ControlFlow;

use super::cameras::AnyCamera;
use super::integrators::AnyIntegrator;
use super::query::CompiledScene;
use crate::render::{self, HistoryRow, Progress, RenderError, Settings, Until};

/// A finished render.
#[pyclass(frozen, module = "raywright._core")]
pub struct Rendering(render::Rendering);

#[pymethods]
impl Rendering {
    #[getter]
    fn rgb<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        self.picture(py, self.0.rgb())
    }
    #[getter]
    fn standard_error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        self.picture(py, self.0.standard_error())
    }
    #[getter]
    fn error(&self) -> (f64, f64, f64) {
        self.0.error.map_or((f64::NAN, f64::NAN, f64::NAN), |e| (e.value, e.low, e.high))
    }
    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<f64> =
            self.0.history.iter().flat_map(|row| [row.seconds, f64::from(row.samples), row.error]).collect();
        numpy::PyArray1::from_vec(py, rows).reshape([self.0.history.len(), 3])
    }
    #[getter]
    fn seconds(&self) -> f64 {
        self.0.seconds
    }
    #[getter]
    fn samples(&self) -> u32 {
        self.0.film.samples()
    }
    #[getter]
    fn dropped(&self) -> u64 {
        self.0.film.dropped()
    }
}

impl Rendering {
    fn picture<'py>(&self, py: Python<'py>, pixels: Vec<[f32; 3]>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let (width, height) = (self.0.film.width() as usize, self.0.film.height() as usize);
        numpy::PyArray1::from_vec(py, pixels.into_flattened()).reshape([height, width, 3])
    }
}

/// Renders until the first of `samples` (per pixel), `error` (relMSE) or `seconds` is met.
#[pyfunction]
#[pyo3(name = "render")]
#[allow(clippy::too_many_arguments)]
pub fn render_scene(
    py: Python<'_>,
    scene: &Bound<'_, CompiledScene>,
    camera: AnyCamera,
    integrator: AnyIntegrator,
    samples: Option<u32>,
    error: Option<f64>,
    seconds: Option<f64>,
    seed: u64,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Rendering> {
    let scene = &scene.get().0;
    let settings = Settings { until: Until { samples, error, seconds }, seed, threads, ..Settings::default() };
    let mut watcher = Watcher { progress, raised: None };
    match py.detach(|| render::render(scene, &*camera.0, &*integrator.0, &settings, &mut watcher)) {
        Ok(rendering) => Ok(Rendering(rendering)),
        Err(RenderError::Interrupted) => {
            Err(watcher.raised.unwrap_or_else(|| PyRuntimeError::new_err("the render was interrupted")))
        }
        Err(error) => Err(PyRuntimeError::new_err(error.to_string())),
    }
}

/// Passes on how a render goes to a Python function, and hears signals.
struct Watcher {
    progress: Option<Py<PyAny>>,
    raised: Option<PyErr>,
}

impl Watcher {
    /// Goes on unless an exception is raised, which it keeps.
    fn unless_raised(&mut self, ask: impl FnOnce(Python<'_>, Option<&Py<PyAny>>) -> PyResult<()>) -> ControlFlow<()> {
        match Python::attach(|py| ask(py, self.progress.as_ref())) {
            Ok(()) => ControlFlow::Continue(()),
            Err(raised) => {
                self.raised = Some(raised);
                ControlFlow::Break(())
            }
        }
    }
}

impl Progress for Watcher {
    fn pass(&mut self, row: &HistoryRow) -> ControlFlow<()> {
        let HistoryRow { seconds, samples, error } = *row;
        self.unless_raised(|py, progress| {
            py.check_signals()?;
            if let Some(progress) = progress {
                progress.call1(py, (seconds, samples, error))?;
            }
            Ok(())
        })
    }

    fn poll(&mut self) -> ControlFlow<()> {
        self.unless_raised(|py, _| py.check_signals())
    }
}
