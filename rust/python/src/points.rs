//! Surface data of hits.

use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Numbers, Triples, numbers, rows, unwritten};
use super::query::CompiledScene;
use super::rays::{answer, share};
use raywright::math::{Hit, Ray};
use raywright::scene::textures::Needs;

/// Position, error, normal, shading normal, dp/du, dp/dv, dn/du, dn/dv.
type PointArrays<'py> = (
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
);

/// Surface data of hits, NaN for misses. `ray` gives the ray of each hit, if they are not in ray order.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn points<'py>(
    scene: &CompiledScene,
    py: Python<'py>,
    shape_id: PyReadonlyArray1<'py, i32>,
    primitive: PyReadonlyArray1<'py, i32>,
    instance: Option<PyReadonlyArray1<'py, i32>>,
    uv: PyReadonlyArray2<'py, f64>,
    t: PyReadonlyArray1<'py, f64>,
    origins: Triples<'py>,
    directions: Triples<'py>,
    time: Numbers<'py>,
    ray: Option<PyReadonlyArray1<'py, i64>>,
) -> PyResult<PointArrays<'py>> {
    let (shape, primitive) = (numbers("shape_id", &shape_id)?, numbers("primitive_id", &primitive)?);
    let (uv, t): (&[[f64; 2]], _) = (rows("uv", &uv)?, numbers("t", &t)?);
    let time = time.slice("time")?;
    let instances = instance.as_ref().map(|i| numbers("instance_id", i)).transpose()?;
    let (origins, directions) = (origins.rows("origins")?, directions.rows("directions")?);
    let order = ray.as_ref().map(|r| numbers("ray", r)).transpose()?;
    let count = primitive.len();
    let others = [instances.map_or(count, <[i32]>::len), order.map_or(count, <[i64]>::len)];
    if [shape.len(), uv.len(), t.len()].iter().chain(&others).any(|&n| n != count) {
        return Err(PyValueError::new_err(format!(
            "all arrays of hits must have the same length, which is {count} for primitive"
        )));
    }
    let vectors = || unwritten::<f64>(py, &[count], Some(3));
    let (position, normal, shading) = (vectors()?, vectors()?, vectors()?);
    let (dp_du, dp_dv, dn_du, dn_dv) = (vectors()?, vectors()?, vectors()?, vectors()?);
    let error = unwritten::<f64>(py, &[count], None)?;
    {
        let mut written = [&position, &normal, &shading, &dp_du, &dp_dv, &dn_du, &dn_dv].map(|a| a.readwrite());
        let [a, b, c, d, e, f, g] = &mut written;
        let mut error = error.readwrite();
        let parts = (
            (error.as_slice_mut()?, triples(a.as_slice_mut()?)),
            (triples(b.as_slice_mut()?), triples(c.as_slice_mut()?)),
            (triples(d.as_slice_mut()?), triples(e.as_slice_mut()?)),
            (triples(f.as_slice_mut()?), triples(g.as_slice_mut()?)),
        );
        let geometry = scene.scene().geometry();
        answer(py, count, share(count), None, parts, |start, parts| {
            let ((error, position), (normal, shading), (dp_du, dp_dv), (dn_du, dn_dv)) = parts;
            for at in 0..error.len() {
                let i = start + at;
                let (Ok(shape), Ok(number)) = (u32::try_from(shape[i]), u32::try_from(primitive[i])) else {
                    error[at] = f64::NAN;
                    for array in [&mut *position, normal, shading, dp_du, dp_dv, dn_du, dn_dv] {
                        array[at] = [f64::NAN; 3];
                    }
                    continue;
                };
                let ray = order.map_or(i, |order| order[i] as usize);
                let of = |n: usize| if n == 1 { 0 } else { ray };
                let ray = Ray {
                    time: time[of(time.len())],
                    ..Ray::new(origins.get(of(origins.len())), directions.get(of(directions.len())))
                };
                let first = geometry.primitives_of(shape).start;
                let (primitive, inner) = match instances.map(|instances| u32::try_from(instances[i])) {
                    Some(Ok(instance)) => (first + instance, number),
                    _ => (first + number, 0),
                };
                let hit = Hit { t: t[i], uv: uv[i], primitive, inner };
                let here = geometry.shading_point(&ray, &hit, geometry.surface(&ray, &hit), Needs::NONE);
                error[at] = here.point.error;
                let told = [here.point.position, here.point.normal, here.point.shading_normal];
                let [p, n, s] = told.map(|v| v.to_array());
                (position[at], normal[at], shading[at]) = (p, n, s);
                [dp_du[at], dp_dv[at]] = here.dp.map(|d| d.to_array());
                [dn_du[at], dn_dv[at]] = here.dn.map(|d| d.to_array());
            }
        })?;
    }
    Ok((position, error, normal, shading, dp_du, dp_dv, dn_du, dn_dv))
}

fn triples(numbers: &mut [f64]) -> &mut [[f64; 3]] {
    numbers.as_chunks_mut().0
}
