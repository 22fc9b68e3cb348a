//! First hits of a camera's pixels, as arrays.

use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::arrays::{sealed, unwritten, vectors};
use super::cameras::AnyCamera;
use super::level;
use super::query::CompiledScene;
use super::rays::answer;
use raywright::math::Hit;
use raywright::scene::FirstHits;
use raywright::workers;

/// t, shape_id and primitive (H,W), uv (H,W,2), and the number of pixels that used the BVH.
type HitArrays<'py> = (
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<i32>>,
    Bound<'py, PyArrayDyn<i32>>,
    Bound<'py, PyArrayDyn<f64>>,
    usize,
);

/// Closest hit of the ray through each pixel, by rasterization. `offsets` (2,) or (H,W,2) are positions in the pixel.
#[pyfunction]
pub fn first_hits<'py>(
    py: Python<'py>,
    scene: &Bound<'py, CompiledScene>,
    camera: AnyCamera,
    offsets: PyReadonlyArrayDyn<'py, f64>,
    threads: Option<usize>,
) -> PyResult<HitArrays<'py>> {
    let (scene, camera) = (scene.get().scene(), &*camera.0);
    let offsets = vectors("offsets", &offsets)?;
    let (width, height) = (camera.width() as usize, camera.height() as usize);
    if offsets.len() != 1 && offsets.len() != width * height {
        return Err(PyValueError::new_err(format!("offsets are {}, expected 1 or {width} × {height}", offsets.len())));
    }
    let level = level()?;
    let picture = py
        .detach(|| workers::pool(threads).map(|pool| pool.install(|| FirstHits::new(scene, camera, offsets, level))))
        .map_err(PyRuntimeError::new_err)?;
    let lead = [height, width];
    let (t, shape) = (unwritten(py, &lead, None)?, unwritten(py, &lead, None)?);
    let (primitive, uv) = (unwritten(py, &lead, None)?, unwritten(py, &lead, Some(2))?);
    let by_tree = AtomicUsize::new(0);
    {
        let (mut t, mut shape) = (t.readwrite(), shape.readwrite());
        let (mut primitive, mut uv) = (primitive.readwrite(), uv.readwrite());
        let numbers = (shape.as_slice_mut()?, primitive.as_slice_mut()?);
        let parts = (t.as_slice_mut()?, (numbers, uv.as_slice_mut()?.as_chunks_mut().0));
        let band = picture.band();
        answer(py, width * height, band, threads, parts, |start, (t, ((shape, primitive), uv))| {
            let mut hits = vec![Hit::MISS; t.len()];
            by_tree.fetch_add(picture.answer(start / band, &mut hits), Ordering::Relaxed);
            for (i, hit) in hits.iter().enumerate() {
                let (s, p) = if hit.is_hit() { scene.geometry().locate(hit.primitive) } else { (u32::MAX, u32::MAX) };
                (t[i], uv[i], shape[i], primitive[i]) = (hit.t, hit.uv, s as i32, p as i32);
            }
        })?;
    }
    Ok((t, sealed(shape)?, sealed(primitive)?, uv, by_tree.into_inner()))
}
