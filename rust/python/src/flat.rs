//! A scene as flat arrays for GPU kernels, with ray setup and exact evaluation of candidates.

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::accelerators;
use super::arrays::{numbers, rows, sealed, unwritten};
use super::hits::{ALL, HitArrays, Hits};
use super::level;
use super::query::CompiledScene;
use super::rays::{BATCH, RayArguments, RayBatch, answer, share};
use raywright::accel::Primitives;
use raywright::accel::flat::{CANDIDATES, CERTAIN, Flat, NO_CANDIDATE, Settled, Settler, flat_ray};
use raywright::math::Hit;
use raywright::workers;

/// A compiled scene's flat arrays.
#[pyclass(frozen, module = "raywright._core")]
pub struct FlatScene {
    scene: Py<CompiledScene>,
    flat: Flat,
}

/// Occlusion of rays, the number of rays whose candidates were evaluated, and the number that used the scene's own
/// accelerator.
type Occluded<'py> = (Bound<'py, PyArrayDyn<bool>>, (usize, usize));

#[pymethods]
#[allow(clippy::too_many_arguments)]
impl FlatScene {
    /// Builds a tree over a scene's geometry, by an accelerator description and a quality, and over prototypes if these
    /// are wanted.
    #[new]
    fn new(
        py: Python<'_>,
        scene: Bound<'_, CompiledScene>,
        accelerator: &Bound<'_, PyAny>,
        quality: &str,
        prototypes: bool,
    ) -> PyResult<Self> {
        let options = accelerators::tree_options(accelerator, quality)?;
        let compiled = scene.get();
        let flat = py
            .detach(|| {
                let build = || Flat::new(compiled.scene().geometry(), &options, prototypes);
                workers::pool(None).map(|pool| pool.install(build))
            })
            .map_err(PyRuntimeError::new_err)?;
        Ok(Self { scene: scene.unbind(), flat })
    }

    /// (K, 8) uint32, the bytes of nodes.
    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<u32>>> {
        let rows = self.flat.nodes.iter().map(|n| {
            let ([a, b, c], [d, e, f]) = (n.min.map(f32::to_bits), n.max.map(f32::to_bits));
            [a, b, c, n.index, d, e, f, n.count]
        });
        table(py, self.flat.nodes.len(), rows)
    }

    /// (M, 12) uint32, the bytes of triangles.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<u32>>> {
        let rows = self.flat.triangles.iter().map(|t| {
            let [corner, edge, other] = [t.corner, t.edge, t.other].map(|v| v.map(f32::to_bits));
            let [[a, b, c], [d, e, f], [g, h, i]] = [corner, edge, other];
            [a, b, c, t.primitive, d, e, f, t.largest.to_bits(), g, h, i, t.instance]
        });
        table(py, self.flat.triangles.len(), rows)
    }

    /// (I, 16) uint32, the bytes of instances.
    #[getter]
    fn instances<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<u32>>> {
        let rows = self.flat.instances.iter().map(|one| {
            let [[a, b, c, d], [e, f, g, h], [i, j, k, l]] = one.rows.map(|row| row.map(f32::to_bits));
            [a, b, c, d, e, f, g, h, i, j, k, l, one.node, one.end, one.primitive, one.reserved]
        });
        table(py, self.flat.instances.len(), rows)
    }

    /// Numbers of nodes and of triangles that belong to the scene itself, not to prototypes.
    #[getter]
    fn own(&self) -> (usize, usize) {
        (self.flat.own[0], self.flat.own[1])
    }

    /// Unbounded primitives.
    #[getter]
    fn unbounded<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, &self.flat.unbounded)
    }

    /// First primitive of each shape, and the total number.
    #[getter]
    fn first(&self) -> Vec<u32> {
        let geometry = self.scene.get().scene().geometry();
        let shapes = (0..geometry.shapes() as u32).map(|shape| geometry.primitives_of(shape).start);
        shapes.chain([Primitives::count(geometry) as u32]).collect()
    }

    #[getter]
    fn depth(&self) -> usize {
        self.flat.depth
    }

    /// Center of box units.
    #[getter]
    fn centre<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.flat.region.centre.to_array())
    }

    /// Factor from the scene's units to box units.
    #[getter]
    fn scale(&self) -> f64 {
        self.flat.region.scale
    }

    /// Rays in the kernels' format, (N, 8) float32.
    fn rays<'py>(&self, py: Python<'py>, rays: RayArguments<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let (threads, rays) = (rays.threads, rays.rays()?);
        let out = unwritten(py, &[rays.count()], Some(8))?;
        answer(
            py,
            rays.count(),
            rays.chunk(),
            threads,
            out.readwrite().as_slice_mut()?.as_chunks_mut().0,
            |start, out| {
                rays.part(start, out.len(), |rays, start| {
                    rays.gathered(start, out.len(), |batch, places| {
                        for (ray, &place) in batch.iter().zip(places) {
                            out[place] = flat_ray(ray, &self.flat.region);
                        }
                    });
                });
            },
        )?;
        Ok(out)
    }

    /// Closest hits among candidates, (N, 4) uint32. Also returns the number of rays whose candidates were evaluated,
    /// and the number that used the scene's own accelerator.
    fn intersect<'py>(
        &self,
        py: Python<'py>,
        rays: RayArguments<'py>,
        candidates: PyReadonlyArray2<'py, u32>,
    ) -> PyResult<(Hits<'py>, (usize, usize))> {
        let (lead, threads, rays) = (&rays.shape, rays.threads, rays.rays()?);
        let candidates = rows::<u32, CANDIDATES>("candidates", &candidates)?;
        self.check(&rays, candidates)?;
        let scene = self.scene.get().scene();
        let settler = Settler::new(scene.geometry(), &self.flat, scene.accelerator(), level()?);
        let (decided, walked) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let hits = HitArrays::new(py, scene, lead, None, ALL)?.written(|parts| {
            answer(py, rays.count(), rays.chunk(), threads, parts, |start, mut parts| {
                let count = parts.count;
                let mut hits = vec![Hit::MISS; BATCH.min(count)];
                let mut mine = Vec::with_capacity(hits.len());
                let candidates = &candidates[start..];
                rays.part(start, count, |rays, start| {
                    rays.gathered(start, count, |batch, places| {
                        let hits = &mut hits[..batch.len()];
                        mine.clear();
                        mine.extend(places.iter().map(|&place| candidates[place]));
                        let told: Settled = settler.closest(batch, &mine, hits);
                        decided.fetch_add(told.decided, Ordering::Relaxed);
                        walked.fetch_add(told.walked, Ordering::Relaxed);
                        parts.write(scene, hits, places);
                    });
                });
            })
        })?;
        Ok((hits, (decided.into_inner(), walked.into_inner())))
    }

    /// Occlusion of rays from candidates, (N,) uint32. Also returns the number of rays whose candidates were evaluated,
    /// and the number that used the scene's own accelerator.
    fn occluded<'py>(
        &self,
        py: Python<'py>,
        rays: RayArguments<'py>,
        told: PyReadonlyArray1<'py, u32>,
    ) -> PyResult<Occluded<'py>> {
        let (lead, threads, rays) = (&rays.shape, rays.threads, rays.rays()?);
        let told = numbers("told", &told)?;
        let scene = self.scene.get().scene();
        self.check(&rays, told.as_chunks::<1>().0)?;
        let settler = Settler::new(scene.geometry(), &self.flat, scene.accelerator(), level()?);
        let out = unwritten(py, lead, None)?;
        let (decided, walked) = (AtomicUsize::new(0), AtomicUsize::new(0));
        answer(py, rays.count(), share(rays.count()), threads, out.readwrite().as_slice_mut()?, |start, out| {
            // Most rays are decided already; only the others are needed.
            let (mut open, mut places, mut mine) = (Vec::new(), Vec::new(), Vec::new());
            let is_open = |told: u32| told != CERTAIN && (told != NO_CANDIDATE || !self.flat.unbounded.is_empty());
            let (count, told) = (out.len(), &told[start..]);
            rays.part(start, count, |rays, start| {
                for (i, to) in out.iter_mut().enumerate() {
                    *to = told[i] == CERTAIN;
                    if is_open(told[i]) {
                        open.push(rays.ray(start + i));
                        places.push(i);
                        mine.push(told[i]);
                    }
                }
            });
            let mut found = vec![false; open.len()];
            let settled = settler.occluded(&open, &mine, &mut found);
            decided.fetch_add(settled.decided, Ordering::Relaxed);
            walked.fetch_add(settled.walked, Ordering::Relaxed);
            places.iter().zip(found).for_each(|(&i, found)| out[i] = found);
        })?;
        Ok((out, (decided.into_inner(), walked.into_inner())))
    }
}

impl FlatScene {
    /// Rejects candidates for another number of rays, and primitives that do not exist.
    fn check<const K: usize>(&self, rays: &RayBatch<'_>, told: &[[u32; K]]) -> PyResult<()> {
        if rays.count() != told.len() {
            let count = told.len();
            return Err(PyValueError::new_err(format!("got numbers of {count} rays, expected {}", rays.count())));
        }
        let count = Primitives::count(self.scene.get().scene().geometry()) as u32;
        let strange = |row: &[u32; K]| row.iter().any(|&p| p >= count && p < CERTAIN);
        match told.iter().position(strange) {
            Some(i) => {
                Err(PyValueError::new_err(format!("primitive of ray {i} is out of range for {count} primitives")))
            }
            None => Ok(()),
        }
    }
}

/// Rows of numbers as an array.
fn table<'py, const K: usize>(
    py: Python<'py>,
    count: usize,
    rows: impl Iterator<Item = [u32; K]>,
) -> PyResult<Bound<'py, PyArrayDyn<u32>>> {
    let out = unwritten(py, &[count], Some(K))?;
    for (to, row) in out.readwrite().as_slice_mut()?.as_chunks_mut::<K>().0.iter_mut().zip(rows) {
        *to = row;
    }
    sealed(out)
}
