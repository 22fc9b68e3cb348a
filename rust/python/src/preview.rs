//! Previews of a scene, from a camera to an array of pixels.

use numpy::{Element, PyArrayDyn};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use super::arrays::writable;
use super::cameras::AnyCamera;
use super::level;
use super::query::CompiledScene;
use super::rays::answer;
use raywright::integrators::{Pixel, Preview, PreviewLight};
use raywright::math::DVec3;

/// Writes a picture (H,W,3) of either type. `light` is a direction to the light, or a point if `is_place`; none is at
/// the eye.
#[pyfunction]
#[pyo3(signature = (scene, camera, light, is_place, ambient, background, out, threads))]
#[allow(clippy::too_many_arguments)]
pub fn preview(
    py: Python<'_>,
    scene: &Bound<'_, CompiledScene>,
    camera: AnyCamera,
    light: Option<[f64; 3]>,
    is_place: bool,
    ambient: f32,
    background: [f32; 3],
    out: &Bound<'_, PyAny>,
    threads: Option<usize>,
) -> PyResult<()> {
    let light = match light.map(DVec3::from_array) {
        None => PreviewLight::Headlight,
        Some(place) if is_place => PreviewLight::Point(place),
        Some(sun) => PreviewLight::Sun(sun),
    };
    let camera = &*camera.0;
    let preview = Preview::new(scene.get().scene(), camera, light, ambient, background, level()?);
    let size = [camera.height() as usize, camera.width() as usize];
    if let Ok(out) = out.cast::<PyArrayDyn<u8>>() {
        return draw(py, &preview, size, out, threads);
    }
    match out.cast::<PyArrayDyn<f32>>() {
        Ok(out) => draw(py, &preview, size, out, threads),
        Err(_) => Err(PyTypeError::new_err("out must be an array of uint8 or float32")),
    }
}

fn draw<P: Pixel + Element>(
    py: Python<'_>,
    preview: &Preview<'_>,
    size: [usize; 2],
    out: &Bound<'_, PyArrayDyn<P>>,
    threads: Option<usize>,
) -> PyResult<()> {
    let mut out = writable("out", out, &size, Some(3))?;
    let rows: &mut [[P; 3]] = out.as_slice_mut()?.as_chunks_mut().0;
    let [height, width] = size;
    answer(py, height * width, Preview::ROWS * width, threads, rows, |start, rows| preview.draw(start / width, rows))
}
