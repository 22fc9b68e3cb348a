//! Rays to hits, from arrays to arrays.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::prelude::*;

use super::arrays::{Rows, Triples, numbers, rows};
use super::describe::{AcceleratorChoice, Scene};
use crate::accel::Info;
use crate::math::{Hit, Ray, Tiling};
use crate::scene;
use crate::workers;

/// Rays that a thread takes at a time: enough to make the hand-over free, few enough to be heard by Ctrl-C.
const CHUNK: usize = 1024;

/// Rays gathered from the arrays at a time: small enough to stay in a near cache, enough to keep a wave full.
const GATHER: usize = 512;

/// Up to so many rays the calling thread does the work: waking others takes longer.
const ALONE: usize = 512;

/// What the compiled accelerator looks like.
#[pyclass(frozen, module = "raywright._core")]
pub struct AcceleratorInfo(Info);

#[pymethods]
impl AcceleratorInfo {
    #[getter]
    fn kind(&self) -> &str {
        &self.0.kind
    }
    #[getter]
    fn primitives(&self) -> usize {
        self.0.primitives
    }
    #[getter]
    fn nodes(&self) -> usize {
        self.0.nodes
    }
    #[getter]
    fn leaves(&self) -> usize {
        self.0.leaves
    }
    #[getter]
    fn depth(&self) -> usize {
        self.0.depth
    }
    #[getter]
    fn bytes(&self) -> usize {
        self.0.bytes
    }
    #[getter]
    fn build_seconds(&self) -> f64 {
        self.0.build_seconds
    }
    #[getter]
    fn sah_cost(&self) -> f64 {
        self.0.sah_cost
    }
    fn __repr__(&self) -> String {
        let Info { kind, primitives, nodes, leaves, depth, bytes, build_seconds, sah_cost } = &self.0;
        format!(
            "AcceleratorInfo(kind={kind:?}, primitives={primitives}, nodes={nodes}, leaves={leaves}, depth={depth}, \
             bytes={bytes}, build_seconds={build_seconds:.4}, sah_cost={sah_cost:.2})"
        )
    }
}

/// A scene ready for rays.
#[pyclass(frozen, module = "raywright._core")]
pub struct CompiledScene(pub scene::Scene);

/// A batch of rays as it came: each part one for all rays, or one a ray.
#[derive(Clone, Copy)]
struct RayArrays<'a> {
    origins: Rows<'a>,
    directions: Rows<'a>,
    t_min: &'a [f64],
    t_max: &'a [f64],
    count: usize,
    tiling: Tiling,
}

impl<'a> RayArrays<'a> {
    fn new(origins: Rows<'a>, directions: Rows<'a>, t_min: &'a [f64], t_max: &'a [f64], row: usize) -> PyResult<Self> {
        let lengths = [origins.len(), directions.len(), t_min.len(), t_max.len()];
        // Broadcasting as numpy has it: ones fit anything, a zero too.
        let count = if lengths.contains(&0) { 0 } else { lengths.into_iter().max().unwrap_or(0) };
        if lengths.iter().any(|&n| n != 1 && n != count) {
            return Err(PyValueError::new_err(format!(
                "origins, directions, t_min and t_max have lengths {lengths:?}"
            )));
        }
        Ok(Self { origins, directions, t_min, t_max, count, tiling: Tiling::new(count, row) })
    }

    /// Ray `i`.
    #[inline(always)]
    fn ray(&self, i: usize) -> Ray {
        let of = |n: usize| if n == 1 { 0 } else { i };
        Ray {
            origin: self.origins.get(of(self.origins.len())),
            direction: self.directions.get(of(self.directions.len())),
            t_min: self.t_min[of(self.t_min.len())],
            t_max: self.t_max[of(self.t_max.len())],
        }
    }

    /// Calls `answer` with some hundred rays at a time of the `count` from `start` on, and with where each lies among them.
    #[inline(always)]
    fn gathered(&self, start: usize, count: usize, mut answer: impl FnMut(&[Ray], &[usize])) {
        let mut rays = Vec::with_capacity(GATHER.min(count));
        let mut places = [0; GATHER];
        for from in (0..count).step_by(GATHER) {
            let places = &mut places[..GATHER.min(count - from)];
            self.tiling.places(from, count, places);
            rays.clear();
            rays.extend(places.iter().map(|&place| self.ray(start + place)));
            answer(&rays, places);
        }
    }
}

#[pymethods]
impl CompiledScene {
    #[new]
    fn new(py: Python<'_>, scene: Scene<'_>, accelerator: &Bound<'_, PyAny>) -> PyResult<Self> {
        let build = AcceleratorChoice::read(accelerator)?.build()?;
        let description = scene.describe()?;
        let compiled = py
            .detach(|| workers::pool(None).map(|pool| pool.install(|| scene::Scene::new(description, build))))
            .map_err(PyRuntimeError::new_err)?;
        compiled.map(Self).map_err(|e| PyValueError::new_err(e.to_string()))
    }

    #[allow(clippy::type_complexity, clippy::too_many_arguments)]
    fn intersect<'py>(
        &self,
        py: Python<'py>,
        origins: Triples<'py>,
        directions: Triples<'py>,
        t_min: PyReadonlyArray1<'py, f64>,
        t_max: PyReadonlyArray1<'py, f64>,
        threads: Option<usize>,
        row: usize,
    ) -> PyResult<(
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray1<i32>>,
        Bound<'py, PyArray1<i32>>,
        Bound<'py, PyArray2<f64>>,
    )> {
        let rays = RayArrays::new(
            origins.rows("origins")?,
            directions.rows("directions")?,
            numbers("t_min", &t_min)?,
            numbers("t_max", &t_max)?,
            row,
        )?;
        let n = rays.count;
        let t = PyArray1::zeros(py, n, false);
        let shape = PyArray1::zeros(py, n, false);
        let primitive = PyArray1::zeros(py, n, false);
        let uv = PyArray2::zeros(py, [n, 2], false);
        {
            let (mut t, mut shape, mut primitive, mut uv) =
                (t.readwrite(), shape.readwrite(), primitive.readwrite(), uv.readwrite());
            let (t, shape, primitive) = (t.as_slice_mut()?, shape.as_slice_mut()?, primitive.as_slice_mut()?);
            let uv = uv.as_slice_mut()?.as_chunks_mut().0;
            let parts = (t, shape, primitive, uv);
            let scene = &self.0;
            answer(py, n, rays.tiling.chunk(CHUNK), threads, parts, |start, (t, shape, primitive, uv)| {
                let count = t.len();
                let mut hits = [Hit::MISS; GATHER];
                rays.gathered(start, count, |batch, places| {
                    let hits = &mut hits[..batch.len()];
                    scene.intersect(batch, hits);
                    for (hit, &i) in hits.iter().zip(places) {
                        (t[i], uv[i]) = (hit.t, hit.uv);
                        (shape[i], primitive[i]) = if hit.is_hit() {
                            let (shape, primitive) = scene.geometry().locate(hit.primitive);
                            (shape as i32, primitive as i32)
                        } else {
                            (-1, -1)
                        };
                    }
                });
            })?;
        }
        Ok((t, shape, primitive, uv))
    }

    #[allow(clippy::too_many_arguments)]
    fn occluded<'py>(
        &self,
        py: Python<'py>,
        origins: Triples<'py>,
        directions: Triples<'py>,
        t_min: PyReadonlyArray1<'py, f64>,
        t_max: PyReadonlyArray1<'py, f64>,
        threads: Option<usize>,
        row: usize,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let rays = RayArrays::new(
            origins.rows("origins")?,
            directions.rows("directions")?,
            numbers("t_min", &t_min)?,
            numbers("t_max", &t_max)?,
            row,
        )?;
        let out = PyArray1::zeros(py, rays.count, false);
        {
            let mut out = out.readwrite();
            let scene = &self.0;
            answer(py, rays.count, rays.tiling.chunk(CHUNK), threads, out.as_slice_mut()?, |start, out| {
                let count = out.len();
                let mut found = [false; GATHER];
                rays.gathered(start, count, |batch, places| {
                    let found = &mut found[..batch.len()];
                    scene.occluded(batch, found);
                    for (&found, &i) in found.iter().zip(places) {
                        out[i] = found;
                    }
                });
            })?;
        }
        Ok(out)
    }

    fn positions<'py>(
        &self,
        py: Python<'py>,
        shape_id: PyReadonlyArray1<'py, i32>,
        primitive: PyReadonlyArray1<'py, i32>,
        uv: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let uv = rows("uv", &uv)?;
        self.of_primitives(py, &shape_id, &primitive, |geometry, p, i| geometry.position(p, uv[i]).to_array())
    }

    fn normals<'py>(
        &self,
        py: Python<'py>,
        shape_id: PyReadonlyArray1<'py, i32>,
        primitive: PyReadonlyArray1<'py, i32>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.of_primitives(py, &shape_id, &primitive, |geometry, p, _| geometry.normal(p).to_array())
    }

    #[getter]
    fn accelerator(&self) -> AcceleratorInfo {
        AcceleratorInfo(self.0.accelerator().info().clone())
    }

    #[getter]
    fn dropped(&self) -> usize {
        self.0.geometry().dropped()
    }

    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let bounds = self.0.region();
        if bounds.is_empty() {
            return Ok(None);
        }
        let corners = [bounds.min, bounds.max].map(|c| c.to_array().to_vec());
        Ok(Some(PyArray2::from_vec2(py, &corners)?))
    }

    #[getter]
    fn bytes(&self) -> usize {
        self.0.accelerator().info().bytes + self.0.geometry().bytes()
    }
}

impl CompiledScene {
    /// A vector of each primitive, NaN for misses.
    fn of_primitives<'py>(
        &self,
        py: Python<'py>,
        shape_id: &PyReadonlyArray1<'py, i32>,
        primitive: &PyReadonlyArray1<'py, i32>,
        vector: impl Fn(&scene::Geometry, u32, usize) -> [f64; 3] + Sync,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (shape, primitive) = (numbers("shape_id", shape_id)?, numbers("primitive", primitive)?);
        let out = PyArray2::zeros(py, [primitive.len(), 3], false);
        {
            let geometry = self.0.geometry();
            let mut out = out.readwrite();
            answer(py, primitive.len(), CHUNK, None, out.as_slice_mut()?.as_chunks_mut().0, |start, out| {
                for (i, to) in out.iter_mut().enumerate() {
                    let i = start + i;
                    *to = match (u32::try_from(shape[i]), u32::try_from(primitive[i])) {
                        (Ok(shape), Ok(primitive)) => {
                            vector(geometry, geometry.primitives_of(shape).start + primitive, i)
                        }
                        _ => [f64::NAN; 3],
                    };
                }
            })?;
        }
        Ok(out)
    }
}

/// Arrays of answers that can be shared out among threads.
trait Parts: Send + Sized {
    fn split(self, at: usize) -> (Self, Self);
}

impl<T: Send> Parts for &mut [T] {
    fn split(self, at: usize) -> (Self, Self) {
        self.split_at_mut(at)
    }
}

impl<A: Parts, B: Parts, C: Parts, D: Parts> Parts for (A, B, C, D) {
    fn split(self, at: usize) -> (Self, Self) {
        let ((a, e), (b, f), (c, g), (d, h)) = (self.0.split(at), self.1.split(at), self.2.split(at), self.3.split(at));
        ((a, b, c, d), (e, f, g, h))
    }
}

/// Fills `n` answers, `chunk` at a time, with the interpreter detached and signals heard.
fn answer<P: Parts>(
    py: Python<'_>,
    n: usize,
    chunk: usize,
    threads: Option<usize>,
    parts: P,
    fill: impl Fn(usize, P) + Sync,
) -> PyResult<()> {
    if n <= ALONE {
        py.detach(|| fill(0, parts));
        return Ok(());
    }
    let mut signal = Ok(());
    py.detach(|| {
        workers::watched(
            threads,
            |cancel| {
                let mut chunks = Vec::with_capacity(n.div_ceil(chunk));
                let mut rest = parts;
                for start in (0..n).step_by(chunk) {
                    let (part, more) = rest.split(chunk.min(n - start));
                    chunks.push((start, part));
                    rest = more;
                }
                chunks.into_par_iter().for_each(|(start, chunk)| {
                    if !cancel.is_raised() {
                        fill(start, chunk);
                    }
                });
            },
            || {
                signal = Python::attach(|py| py.check_signals());
                signal.is_ok()
            },
        )
    })
    .map_err(PyRuntimeError::new_err)?;
    signal
}
