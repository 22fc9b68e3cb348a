//! Scenes to pictures.

use numpy::{Element, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::ops::ControlFlow;

use super::arrays::{Row, unwritten, vectors};
use super::query::CompiledScene;
use super::rays::{answer, share};
use super::samplers;
use crate::integrators::Path;
use crate::math::DVec3;
use crate::render::{self, HistoryRow, Progress, RenderError, Settings, Until};
use crate::scene;

/// `raywright.Camera`.
#[derive(FromPyObject)]
pub struct Camera {
    position: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    fov: f64,
    width: u32,
    height: u32,
}

impl Camera {
    /// The camera that it describes.
    pub fn describe(&self) -> PyResult<scene::Camera> {
        let [position, target, up] = [self.position, self.target, self.up].map(DVec3::from_array);
        scene::Camera::perspective(position, target, up, self.fov, self.width, self.height)
            .map_err(|e| PyValueError::new_err(e.to_string()))
    }
}

/// `raywright.Path`.
#[derive(FromPyObject)]
pub struct PathIntegrator {
    max_depth: Option<u32>,
    roulette_depth: u32,
}

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
    camera: Camera,
    integrator: PathIntegrator,
    samples: Option<u32>,
    error: Option<f64>,
    seconds: Option<f64>,
    seed: u64,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
    sampler: &Bound<'_, PyAny>,
    filter: &Bound<'_, PyAny>,
) -> PyResult<Rendering> {
    let scene = &scene.get().0;
    let camera = camera.describe()?;
    let path = Path { max_depth: integrator.max_depth, roulette_depth: integrator.roulette_depth };
    let (sampler, filter) = (samplers::sampler(sampler, samples)?, samplers::filter(filter)?.into());
    let settings = Settings { until: Until { samples, error, seconds }, seed, threads, sampler, filter };
    let mut watcher = Watcher { progress, raised: None };
    match py.detach(|| render::render(scene, &camera, &path, &settings, &mut watcher)) {
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

/// Origins and directions (H,W,3), of one array type.
type CameraRays<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Origins and directions (H,W,3) through the pixels, as float32 if `single`, else float64; row 0 is the top. `offsets` is where
/// in the pixel: two numbers for all, or for each.
#[pyfunction]
pub fn camera_rays<'py>(
    py: Python<'py>,
    camera: Camera,
    offsets: PyReadonlyArrayDyn<'py, f64>,
    single: bool,
) -> PyResult<CameraRays<'py>> {
    let (camera, offsets) = (camera.describe()?, vectors("offsets", &offsets)?);
    if single { rays_of::<f32>(py, &camera, offsets) } else { rays_of::<f64>(py, &camera, offsets) }
}

/// Rays of either type, made by all threads.
fn rays_of<'py, T: Element + Send>(
    py: Python<'py>,
    camera: &scene::Camera,
    offsets: &[[f64; 2]],
) -> PyResult<CameraRays<'py>>
where
    [T; 3]: Row,
{
    let (width, height) = (camera.width() as usize, camera.height() as usize);
    let count = width * height;
    if offsets.len() != 1 && offsets.len() != count {
        return Err(PyValueError::new_err(format!("offsets are {}, expected 1 or {width} × {height}", offsets.len())));
    }
    let origins = unwritten::<T>(py, &[height, width], Some(3))?;
    let directions = unwritten::<T>(py, &[height, width], Some(3))?;
    {
        let (mut origins, mut directions) = (origins.readwrite(), directions.readwrite());
        let parts = (origins.as_slice_mut()?.as_chunks_mut().0, directions.as_slice_mut()?.as_chunks_mut().0);
        answer(py, count, share(count), None, parts, |start, (origins, directions)| {
            let (mut x, mut y) = (start % width, start / width);
            for (i, (origin, direction)) in origins.iter_mut().zip(directions).enumerate() {
                let [right, down] = offsets[if offsets.len() == 1 { 0 } else { start + i }];
                let ray = camera.ray(x as f64 + right, y as f64 + down);
                (*origin, *direction) = (Row::of(ray.origin), Row::of(ray.direction));
                x += 1;
                if x == width {
                    (x, y) = (0, y + 1);
                }
            }
        })?;
    }
    Ok((origins.into_any(), directions.into_any()))
}
