//! What cones touch, from arrays to arrays.

use numpy::{PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Numbers, Triples, sealed, unwritten};
use super::query::CompiledScene;
use super::rays::{chunks, each};
use crate::accel::Touches;
use crate::shapes::triangle::SolidCone;

/// Splits (N+1,), and distance (K,), shape_id (K,) and primitive (K,) of all that is touched.
type Touched<'py> = (
    Bound<'py, PyArrayDyn<i64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<i32>>,
    Bound<'py, PyArrayDyn<i32>>,
);

/// Cones that a thread takes at a time, of so many: each may touch much, so that few are already worth the hand-over.
fn share(count: usize) -> usize {
    (count / 64).clamp(16, 1024)
}

/// What cones touch, nearest first. Each array has one row, or one for each cone; `half_angle` is in degrees.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn cones<'py>(
    py: Python<'py>,
    scene: &Bound<'py, CompiledScene>,
    origins: Triples<'py>,
    directions: Triples<'py>,
    half_angle: Numbers<'py>,
    t_max: Numbers<'py>,
    shape: Vec<usize>,
    threads: Option<usize>,
) -> PyResult<Touched<'py>> {
    let scene = scene.get().scene();
    if let Some(shape) = scene.geometry().first_other() {
        return Err(PyValueError::new_err(format!("cones touch meshes alone, and shape {shape} is none")));
    }
    let (apexes, axes) = (origins.rows("origins")?, directions.rows("directions")?);
    let (angles, most) = (half_angle.slice("half_angle")?, t_max.slice("t_max")?);
    let count = shape.iter().product();
    let lengths = [apexes.len(), axes.len(), angles.len(), most.len()];
    if lengths.iter().any(|&n| n != 1 && n != count) {
        return Err(PyValueError::new_err(format!(
            "origins, directions, half_angle and t_max have lengths {lengths:?}, expected 1 or {count}"
        )));
    }
    let found = each(py, threads, chunks(count, share(count)), |(start, count)| {
        let of = |n: usize, i: usize| if n == 1 { 0 } else { i };
        let cone = |i| {
            let (apex, axis) = (apexes.get(of(apexes.len(), i)), axes.get(of(axes.len(), i)));
            SolidCone::new(apex, axis, angles[of(angles.len(), i)], most[of(most.len(), i)])
        };
        let cones: Vec<_> = (start..start + count).map(cone).collect();
        scene.touched(&cones)
    })?;
    let mut all = Touches::new();
    found.iter().for_each(|some| all.append(some));
    let total = all.touches.len();
    let (splits, distance) = (unwritten(py, &[count + 1], None)?, unwritten(py, &[total], None)?);
    let (shape, primitive) = (unwritten(py, &[total], None)?, unwritten(py, &[total], None)?);
    {
        let (mut splits, mut distance) = (splits.readwrite(), distance.readwrite());
        let (mut shape, mut primitive) = (shape.readwrite(), primitive.readwrite());
        for (to, &split) in splits.as_slice_mut()?.iter_mut().zip(&all.splits) {
            *to = split as i64;
        }
        let places = distance.as_slice_mut()?.iter_mut().zip(shape.as_slice_mut()?).zip(primitive.as_slice_mut()?);
        for (((distance, shape), primitive), touch) in places.zip(&all.touches) {
            let (s, p) = scene.geometry().locate(touch.primitive);
            (*distance, *shape, *primitive) = (touch.distance, s as i32, p as i32);
        }
    }
    Ok((sealed(splits)?, sealed(distance)?, sealed(shape)?, sealed(primitive)?))
}
