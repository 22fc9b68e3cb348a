//! Cone queries from arrays to arrays.

use numpy::{PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Numbers, TripleRows, Triples, sealed, unwritten};
use super::query::CompiledScene;
use super::rays::{chunks, each};
use raywright::accel::Touches;
use raywright::scene::{ConeFilter, Coverage};
use raywright::shapes::triangle::SolidCone;

/// Splits (N+1,), and distance (K,), shape_id (K,) and primitive (K,) of all touched triangles.
type Touched<'py> = (
    Bound<'py, PyArrayDyn<i64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<i32>>,
    Bound<'py, PyArrayDyn<i32>>,
);

/// Cones per task: each may touch many triangles, so a few already outweigh the cost of a task.
fn share(count: usize) -> usize {
    (count / 64).clamp(16, 1024)
}

/// Cones in array form: each part one for all cones, or one per cone.
struct ConeArrays<'a> {
    apexes: TripleRows<'a>,
    axes: TripleRows<'a>,
    angles: &'a [f64],
    most: &'a [f64],
    count: usize,
}

impl<'a> ConeArrays<'a> {
    fn of(
        origins: &'a Triples<'_>,
        directions: &'a Triples<'_>,
        half_angle: &'a Numbers<'_>,
        t_max: &'a Numbers<'_>,
        shape: &[usize],
    ) -> PyResult<Self> {
        let (apexes, axes) = (origins.rows("origins")?, directions.rows("directions")?);
        let (angles, most) = (half_angle.slice("half_angle")?, t_max.slice("t_max")?);
        let count = shape.iter().product();
        let lengths = [apexes.len(), axes.len(), angles.len(), most.len()];
        if lengths.iter().any(|&n| n != 1 && n != count) {
            return Err(PyValueError::new_err(format!(
                "origins, directions, half_angle and t_max have lengths {lengths:?}, expected 1 or {count}"
            )));
        }
        Ok(Self { apexes, axes, angles, most, count })
    }

    fn get(&self, i: usize) -> Option<SolidCone> {
        let of = |n: usize| if n == 1 { 0 } else { i };
        let (apex, axis) = (self.apexes.get(of(self.apexes.len())), self.axes.get(of(self.axes.len())));
        SolidCone::new(apex, axis, self.angles[of(self.angles.len())], self.most[of(self.most.len())])
    }

    /// Returns whether any part of a cone is NaN.
    fn is_nan(&self, i: usize) -> bool {
        let of = |n: usize| if n == 1 { 0 } else { i };
        let (apex, axis) = (self.apexes.get(of(self.apexes.len())), self.axes.get(of(self.axes.len())));
        let numbers = [self.angles[of(self.angles.len())], self.most[of(self.most.len())]];
        apex.is_nan() || axis.is_nan() || numbers.iter().any(|number| number.is_nan())
    }
}

/// Triangles touched by each cone, nearest first. Each array has one row, or one per cone; `half_angle` is in degrees.
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
        return Err(PyValueError::new_err(format!("cone queries support only meshes, and shape {shape} is none")));
    }
    let cones = ConeArrays::of(&origins, &directions, &half_angle, &t_max, &shape)?;
    let count = cones.count;
    let found = each(py, threads, chunks(count, share(count)), |(start, count)| {
        let cones: Vec<_> = (start..start + count).map(|i| cones.get(i)).collect();
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

/// Share of each cone's directions that hit something, (N,): 0 for a cone without a direction, and NaN for one with
/// NaN. Arguments as [`cones`].
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn cone_coverage<'py>(
    py: Python<'py>,
    scene: &Bound<'py, CompiledScene>,
    origins: Triples<'py>,
    directions: Triples<'py>,
    half_angle: Numbers<'py>,
    t_max: Numbers<'py>,
    shape: Vec<usize>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let scene = scene.get().scene();
    let coverage = Coverage::new(scene).map_err(|shape| {
        PyValueError::new_err(format!("coverage supports only meshes and spheres, and shape {shape} is neither"))
    })?;
    let cones = ConeArrays::of(&origins, &directions, &half_angle, &t_max, &shape)?;
    let found = each(py, threads, chunks(cones.count, share(cones.count)), |(start, count)| {
        let share = |i| match cones.get(i) {
            Some(cone) => coverage.share(&cone, ConeFilter::default()),
            None if cones.is_nan(i) => f64::NAN,
            None => 0.0,
        };
        (start..start + count).map(share).collect::<Vec<_>>()
    })?;
    let shares = unwritten(py, &shape, None)?;
    {
        let mut to = shares.readwrite();
        for (to, &share) in to.as_slice_mut()?.iter_mut().zip(found.iter().flatten()) {
            *to = share;
        }
    }
    sealed(shares)
}
