//! Scenes to pictures.

use numpy::{PyArray2, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::ops::ControlFlow;

use super::cameras::AnyCamera;
use super::integrators::AnyIntegrator;
use super::query::CompiledScene;
use super::samplers;
use super::written::Written;
use crate::integrators::Integrator;
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
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let (width, height) = (self.0.film.width() as usize, self.0.film.height() as usize);
        numpy::PyArray1::from_vec(py, self.0.film.counts()).reshape([height, width])
    }
    #[getter]
    fn carried(&self) -> Option<(u32, f64)> {
        self.0.error.and_then(|e| e.carried).map(|c| (c.samples, c.share))
    }
    #[getter]
    fn dropped(&self) -> u64 {
        self.0.film.dropped()
    }
    #[getter]
    fn clamped(&self) -> (u64, f64) {
        self.0.film.clamped()
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
    integrator: &Bound<'_, PyAny>,
    described: Py<PyAny>,
    samples: Option<u32>,
    error: Option<f64>,
    seconds: Option<f64>,
    seed: u64,
    threads: Option<usize>,
    adaptive: bool,
    clamp: Option<f64>,
    progress: Option<Py<PyAny>>,
    sampler: &Bound<'_, PyAny>,
    filter: &Bound<'_, PyAny>,
) -> PyResult<Rendering> {
    let scene = &scene.get().0;
    let own = py.import("raywright.integrator")?.getattr("Integrator")?;
    let (mut given, mut written) = (None, None);
    if integrator.is_instance(&own)? {
        written = Some(Written::new(integrator.clone().unbind(), described, seed));
    } else {
        given = Some(integrator.extract::<AnyIntegrator>()?.0);
    }
    let chosen: &dyn Integrator = match (&given, &written) {
        (Some(given), _) => &**given,
        (_, Some(written)) => written,
        _ => unreachable!("it is one or the other"),
    };
    let until = Until { samples, error, seconds };
    let (sampler, filter) = (samplers::sampler(sampler, samples)?, samplers::filter(filter)?.into());
    let settings = Settings { until, seed, threads, adaptive, clamp, sampler, filter };
    let mut watcher = Watcher { progress, raised: None, written: written.as_ref() };
    match py.detach(|| render::render(scene, &*camera.0, chosen, &settings, &mut watcher)) {
        Ok(rendering) => Ok(Rendering(rendering)),
        Err(RenderError::Interrupted) => {
            let raised = written.as_ref().and_then(Written::raised).or(watcher.raised);
            Err(raised.unwrap_or_else(|| PyRuntimeError::new_err("the render was interrupted")))
        }
        Err(error) => Err(PyRuntimeError::new_err(error.to_string())),
    }
}

/// Passes on how a render goes to a Python function, and hears signals.
struct Watcher<'a> {
    progress: Option<Py<PyAny>>,
    raised: Option<PyErr>,
    written: Option<&'a Written>,
}

impl Watcher<'_> {
    /// Goes on unless an exception is raised, which it keeps.
    fn unless_raised(&mut self, ask: impl FnOnce(Python<'_>, Option<&Py<PyAny>>) -> PyResult<()>) -> ControlFlow<()> {
        let raised = self.written.and_then(Written::raised);
        match raised.map_or_else(|| Python::attach(|py| ask(py, self.progress.as_ref())), Err) {
            Ok(()) => ControlFlow::Continue(()),
            Err(raised) => {
                self.raised = Some(raised);
                ControlFlow::Break(())
            }
        }
    }
}

impl Progress for Watcher<'_> {
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
