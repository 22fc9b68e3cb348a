//! Rendering for Python.

use numpy::{PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::time::{Duration, Instant};

use super::arrays;
use super::cameras::AnyCamera;
use super::denoise;
use super::integrators;
use super::job::Job;
use super::query::CompiledScene;
use super::samplers;
use super::signals::heard;
use super::watcher::{Watcher, malformed};
use raywright::integrators::{Guide, Guiding, Integrator, Path};
use raywright::render::{self, Progress, RenderError, Settings, Until};
use raywright::workers::{Cancel, onlookers, pool, watched};

/// Reads a film on threads that never render.
fn looked_at<T: Send>(py: Python<'_>, tell: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = onlookers().map_err(PyRuntimeError::new_err)?;
    Ok(py.detach(|| pool.install(tell)))
}

/// A render: its picture so far, and the state needed to continue it.
#[pyclass(module = "raywright._core")]
pub struct Rendering(pub(super) render::Rendering);

#[pymethods]
impl Rendering {
    /// Creates the render of a job, not begun.
    #[new]
    fn new(job: &Bound<'_, Job>, threads: Option<usize>, patch: u32) -> PyResult<Self> {
        let (job, cores) = (job.get(), pool(threads).map_err(PyRuntimeError::new_err)?.threads());
        let settings = job.settings(Until::default(), threads);
        Ok(Self(render::Rendering::new(settings.film(job.camera(), cores, patch.max(1)))))
    }

    /// Reads a render of a job from the bytes of `to_bytes`; a `ValueError` tells why they are invalid.
    #[staticmethod]
    fn from_bytes(
        py: Python<'_>,
        data: &[u8],
        job: &Bound<'_, Job>,
        threads: Option<usize>,
        patch: u32,
    ) -> PyResult<Self> {
        let (job, pool) = (job.get(), pool(threads).map_err(PyRuntimeError::new_err)?);
        let (width, height) = (job.camera().width(), job.camera().height());
        let Settings { sampler, adaptive, apart, clamp, .. } = job.settings(Until::default(), threads);
        let (batch, patch) = (sampler.batch(), patch.max(1));
        let read = || render::Rendering::from_bytes(data, width, height, batch, adaptive, clamp, patch, apart);
        py.detach(|| pool.install(read)).map(Self).map_err(malformed)
    }

    /// Maximum size of `to_bytes` for a job.
    #[staticmethod]
    fn most_bytes(job: &Bound<'_, Job>) -> usize {
        let (camera, settings) = (job.get().camera(), job.get().settings(Until::default(), None));
        render::Rendering::most_bytes(camera.width(), camera.height(), settings.adaptive, settings.apart)
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.0.to_bytes()))
    }

    #[getter]
    fn rgb<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let pixels = looked_at(py, || self.0.rgb())?;
        self.picture(py, pixels)
    }
    /// Standard error of each pixel, the same pooled with neighbors, and its degrees of freedom; `None` if there are
    /// too few samples.
    #[getter]
    #[allow(clippy::type_complexity)]
    fn uncertainty<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<(Bound<'py, PyArray3<f32>>, Bound<'py, PyArray3<f32>>, Bound<'py, PyArray2<f32>>)>> {
        let Some(known) = looked_at(py, || self.0.uncertainty())? else { return Ok(None) };
        let (width, height) = (self.0.film.width() as usize, self.0.film.height() as usize);
        let degrees = known.degrees.into_iter().map(|degrees| degrees as f32).collect();
        Ok(Some((
            self.picture(py, render::roots(known.variances))?,
            self.picture(py, render::roots(known.pooled))?,
            numpy::PyArray1::from_vec(py, degrees).reshape([height, width])?,
        )))
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
    /// Adds time that was spent elsewhere.
    fn spend(&mut self, seconds: f64) {
        self.0.seconds += seconds.max(0.0);
    }
    #[getter]
    fn samples(&self) -> u32 {
        self.0.film.samples()
    }
    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let (width, height) = (self.0.film.width() as usize, self.0.film.height() as usize);
        let counts = looked_at(py, || self.0.film.counts())?;
        numpy::PyArray1::from_vec(py, counts).reshape([height, width])
    }
    #[getter]
    fn trusted(&self) -> bool {
        self.0.is_trusted()
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
    fn clamped(&self, py: Python<'_>) -> PyResult<(u64, f64)> {
        looked_at(py, || self.0.film.clamped())
    }

    /// Four independent parts of the samples, (4, H, W, 3), and the variances of the halves that they form, (2, H, W,
    /// 3). `None` if they were not kept, or a part has no whole batch.
    #[getter]
    fn halves<'py>(&self, py: Python<'py>) -> PyResult<Option<denoise::QuarterArrays<'py>>> {
        denoise::halves(py, &self.0.film)
    }
    #[getter]
    fn patch(&self) -> u32 {
        self.0.film.patch()
    }

    #[getter]
    fn aim(&self) -> u32 {
        self.0.aim()
    }
    #[getter]
    fn tiles(&self) -> usize {
        self.0.film.tile_count()
    }
    #[getter]
    fn block(&self) -> u32 {
        self.0.film.block()
    }
    #[getter]
    fn appends(&self) -> bool {
        self.0.film.appends()
    }
    #[getter]
    fn rate(&self) -> f64 {
        self.0.rate()
    }

    fn next_aim(
        &self,
        samples: Option<u32>,
        error: Option<f64>,
        seconds: Option<f64>,
        after: u32,
        elapsed: f64,
        rate: f64,
    ) -> u32 {
        self.0.next_aim(&Until { samples, error, seconds }, after, elapsed, rate)
    }

    fn begin(&mut self, py: Python<'_>, aim: u32) -> PyResult<()> {
        let pool = pool(None).map_err(PyRuntimeError::new_err)?;
        py.detach(|| pool.install(|| self.0.begin(aim)));
        Ok(())
    }

    fn end(&mut self, py: Python<'_>, seconds: f64) -> PyResult<(f64, u32, f64, bool)> {
        let pool = pool(None).map_err(PyRuntimeError::new_err)?;
        let row = py.detach(|| pool.install(|| self.0.end(seconds)));
        Ok((row.seconds, row.samples, row.error, self.0.is_trusted()))
    }

    fn request<'py>(
        &self,
        py: Python<'py>,
        first: usize,
        count: usize,
        before: Option<u32>,
        samples: u32,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let film = &self.0.film;
        let tiles = first..first.saturating_add(count);
        if tiles.end > film.tile_count() || before.is_some_and(|b| !film.appends() || !b.is_multiple_of(film.block())) {
            return Err(PyValueError::new_err("request must name tiles of the film, and before must be whole blocks"));
        }
        Ok(PyBytes::new(py, &self.0.request(tiles, before, samples)))
    }

    fn take(&mut self, answer: &[u8]) -> PyResult<()> {
        self.0.take(answer).map_err(malformed)
    }

    fn add(&mut self, py: Python<'_>, count: u32, sums: PyReadonlyArray2<'_, f64>, dropped: u64) -> PyResult<()> {
        let rows = arrays::rows("sums", &sums)?;
        let pool = pool(None).map_err(PyRuntimeError::new_err)?;
        py.detach(|| pool.install(|| self.0.add(count, rows, dropped))).map_err(malformed)
    }

    /// Coverage of each pixel, by the existing samples or by `samples` each: the covered share, and the numbers, -1 for
    /// none, and shares of the shapes that cover most of it.
    #[allow(clippy::type_complexity)]
    fn cover<'py>(
        &self,
        py: Python<'py>,
        job: &Bound<'_, Job>,
        scene: &Bound<'_, CompiledScene>,
        ranks: usize,
        samples: Option<u32>,
        threads: Option<usize>,
    ) -> PyResult<(Bound<'py, PyArray2<f32>>, Bound<'py, PyArray3<i32>>, Bound<'py, PyArray3<f32>>)> {
        let (job, scene, film) = (job.get(), &scene.get().0, &self.0.film);
        let (integrator, settings) = (job.integrator(py), job.settings(Until::default(), threads));
        let (seen, integrator) = ((scene, job.camera()), integrator.get());
        let all = heard(py, threads, |cancel| render::cover(film, samples, seen, integrator, &settings, cancel))?;
        let (width, height) = (film.width() as usize, film.height() as usize);
        let of = |cover: &render::Cover, rank: usize| cover.get(rank).copied();
        let ranked = |cover| (0..ranks).map(move |rank| of(cover, rank));
        let alpha = all.iter().map(|cover| cover.iter().fold(0.0, |sum, (_, share)| sum + share) as f32).collect();
        let shapes = all.iter().flat_map(ranked).map(|one| one.map_or(-1, |(shape, _)| shape as i32)).collect();
        let shares = all.iter().flat_map(ranked).map(|one| one.map_or(0.0, |(_, share)| share as f32)).collect();
        Ok((
            numpy::PyArray1::from_vec(py, alpha).reshape([height, width])?,
            numpy::PyArray1::from_vec(py, shapes).reshape([height, width, ranks])?,
            numpy::PyArray1::from_vec(py, shares).reshape([height, width, ranks])?,
        ))
    }

    /// Continues until the first of `samples` (per pixel), `error` (relMSE) or `seconds` is met, or for `pause`
    /// seconds; returns whether one was met. `look` is called whenever signals are handled. It may raise to end the
    /// render, or return true to pause it after the pass.
    #[allow(clippy::too_many_arguments)]
    fn go_on(
        &mut self,
        py: Python<'_>,
        job: &Bound<'_, Job>,
        scene: &Bound<'_, CompiledScene>,
        threads: Option<usize>,
        samples: Option<u32>,
        error: Option<f64>,
        seconds: Option<f64>,
        pause: Option<f64>,
        progress: Option<Py<PyAny>>,
        look: Option<Py<PyAny>>,
    ) -> PyResult<bool> {
        let (job, scene) = (job.get(), &scene.get().0);
        let integrator = job.integrator(py);
        let settings = job.settings(Until { samples, error, seconds }, threads);
        let pause = pause.map(|pause| Instant::now() + Duration::from_secs_f64(pause.clamp(0.0, 1e9)));
        let mut watcher = Watcher { progress, look, rests: false, raised: None, pause, written: integrator.written() };
        let (rendering, camera) = (&mut self.0, job.camera());
        let result = py.detach(|| {
            job.showing(integrator.get(), |shown| {
                render::go_on(rendering, scene, camera, shown, &settings, &mut watcher)
            })
        });
        result.map_err(|error| watcher.error(error))
    }

    /// Bias of each pixel by density estimation and its standard error, or `None` for an unbiased integrator. `look` is
    /// called whenever signals are handled, and may raise to end it.
    fn bias<'py>(
        &self,
        py: Python<'py>,
        job: &Bound<'_, Job>,
        scene: &Bound<'_, CompiledScene>,
        threads: Option<usize>,
        look: Option<Py<PyAny>>,
    ) -> PyResult<Option<[Bound<'py, PyArray3<f32>>; 2]>> {
        let (job, scene) = (job.get(), &scene.get().0);
        let (integrator, settings) = (job.integrator(py), job.settings(Until::default(), threads));
        let mut watcher =
            Watcher { progress: None, look, rests: false, raised: None, pause: None, written: integrator.written() };
        let (camera, samples) = (job.camera(), self.0.film.samples());
        let told = py.detach(|| render::bias(scene, camera, integrator.get(), &settings, samples, &mut watcher));
        let Some(told) = told.map_err(|error| watcher.error(error))? else { return Ok(None) };
        let pixels = |k: usize| told.iter().map(|of| of[k].to_array().map(|x| x as f32)).collect();
        Ok(Some([self.picture(py, pixels(0))?, self.picture(py, pixels(1))?]))
    }
}

impl Rendering {
    fn picture<'py>(&self, py: Python<'py>, pixels: Vec<[f32; 3]>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let (width, height) = (self.0.film.width() as usize, self.0.film.height() as usize);
        numpy::PyArray1::from_vec(py, pixels.into_flattened()).reshape([height, width, 3])
    }
}

/// Half widths of confidence intervals of `level` in standard errors, for each of these degrees of freedom.
#[pyfunction]
pub fn student<'py>(
    py: Python<'py>,
    level: f64,
    degrees: numpy::PyReadonlyArray1<'py, f64>,
) -> Bound<'py, numpy::PyArray1<f64>> {
    let quantiles = degrees.as_array().iter().map(|&degrees| render::quantile(level, degrees)).collect();
    numpy::PyArray1::from_vec(py, quantiles)
}

/// Returns whether paths could share samples in a scene, whether photons could guide them through specular objects, and
/// whether their guide could learn, whatever the path's options; photons are traced for the second. `look` is called
/// whenever signals are handled, and may raise to end it.
#[pyfunction]
pub fn chances(
    py: Python<'_>,
    scene: &Bound<'_, CompiledScene>,
    path: &Bound<'_, PyAny>,
    threads: Option<usize>,
    look: Option<Py<PyAny>>,
) -> PyResult<(bool, bool, bool)> {
    let (scene, path) = (&scene.get().0, integrators::path(path)?);
    let any = Path { reuse: 2, guiding: Guiding::Photons, ..path };
    let learns = Path { guiding: Guiding::Learned, ..path }.guiding_in(scene) == Guiding::Learned;
    let mut watcher = Watcher { progress: None, look, rests: false, raised: None, pause: None, written: None };
    let aims = |cancel: &Cancel| any.guiding_in(scene) == Guiding::Photons && Guide::of(scene, cancel).is_some();
    let mut goes_on = true;
    let aims = py.detach(|| {
        watched(threads, aims, || {
            goes_on = watcher.poll().is_continue();
            goes_on
        })
    });
    let aims = aims.map_err(PyRuntimeError::new_err)?;
    if goes_on { Ok((any.patch(scene) > 1, aims, learns)) } else { Err(watcher.error(RenderError::Interrupted)) }
}

/// Approximate relMSE of some path tracers with few samples, estimated on a few parts of a picture. `look` is called
/// whenever signals are handled, and may raise to end it.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn pilot(
    py: Python<'_>,
    scene: &Bound<'_, CompiledScene>,
    camera: AnyCamera,
    paths: Vec<Bound<'_, PyAny>>,
    threads: Option<usize>,
    clamp: Option<f64>,
    filter: &Bound<'_, PyAny>,
    look: Option<Py<PyAny>>,
) -> PyResult<Vec<f64>> {
    let paths: Vec<Path> = paths.iter().map(integrators::path).collect::<PyResult<_>>()?;
    let filter = samplers::filter(filter)?.into();
    let settings = Settings { threads, clamp, filter, ..Settings::default() };
    let mut watcher = Watcher { progress: None, look, rests: false, raised: None, pause: None, written: None };
    let scene = &scene.get().0;
    let result = py.detach(|| render::pilot(scene, &*camera.0, &paths, &settings, &mut watcher));
    result.map_err(|error| watcher.error(error))
}

/// Nanoseconds by part of the rendering since the last call, and the number of surface vertices of paths; only with the
/// feature `timing`.
#[cfg(feature = "timing")]
#[pyfunction]
pub fn timing() -> (Vec<(&'static str, f64)>, u64) {
    let (spent, vertices) = raywright::timing::take();
    (raywright::timing::Part::ALL.iter().zip(spent).map(|(&(_, name), spent)| (name, spent)).collect(), vertices)
}
