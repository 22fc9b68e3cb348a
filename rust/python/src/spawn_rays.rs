//! Origins of rays that leave surface points.

use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Triples, numbers, rows, unwritten};
use super::rays::{answer, share};
use raywright::math::DVec3;
use raywright::scene::RayOrigin;

/// Origins of rays along directions of leading shape `shape`, from the points indexed by `which`, or from all points
/// cyclically. NaN for the points of misses.
#[pyfunction]
pub fn spawn_rays<'py>(
    py: Python<'py>,
    position: PyReadonlyArray2<'py, f64>,
    error: PyReadonlyArray1<'py, f64>,
    normal: PyReadonlyArray2<'py, f64>,
    directions: Triples<'py>,
    which: Option<PyReadonlyArray1<'py, i64>>,
    shape: Vec<usize>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let (position, normal) = (rows::<f64, 3>("position", &position)?, rows::<f64, 3>("normal", &normal)?);
    let (error, directions) = (numbers("error", &error)?, directions.rows("directions")?);
    let which = which.as_ref().map(|which| numbers("which", which)).transpose()?;
    let (points, count) = (error.len(), shape.iter().product::<usize>());
    let fits =
        |which: &[i64]| which.len() == count && which.iter().all(|&i| usize::try_from(i).is_ok_and(|i| i < points));
    if [position.len(), normal.len()] != [points; 2]
        || ![1, count].contains(&directions.len())
        || !which.map_or(points > 0 || count == 0, fits)
    {
        return Err(PyValueError::new_err(format!(
            "position, normal, directions and which do not match {count} rays from {points} points"
        )));
    }
    let origins = unwritten::<f64>(py, &shape, Some(3))?;
    answer(py, count, share(count), None, origins.readwrite().as_slice_mut()?.as_chunks_mut().0, |start, origins| {
        for (ray, origin) in (start..).zip(origins) {
            let i = which.map_or_else(|| ray % points, |which| which[ray] as usize);
            let (position, normal) = (DVec3::from_array(position[i]), DVec3::from_array(normal[i]));
            let way = directions.get(if directions.len() == 1 { 0 } else { ray });
            *origin = RayOrigin::off(position, error[i], normal).ray(way).origin.to_array();
        }
    })?;
    Ok(origins)
}
