//! View factors of a scene, as arrays.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use super::query::CompiledScene;
use raywright::exchange::{Aim, Fronts, areas, matrix, shared_planes, sparse};
use raywright::work::{Stopped, Watch, Work};
use raywright::workers::watched;

/// Areas, factors by row, sampled pairs and their errors, numbers of closed-form, hidden and sampled pairs, rays, and
/// flags of rows that are sampled and in a closed enclosure.
type Dense<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray2<f64>>,
    (Bound<'py, PyArray2<i64>>, Bound<'py, PyArray1<f64>>),
    (u64, u64, u64),
    u64,
    Bound<'py, PyArray1<bool>>,
);

/// Areas; row starts, faces, factors and their errors; and rays.
type ByRays<'py> = (
    Bound<'py, PyArray1<f64>>,
    (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i32>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f32>>),
    u64,
);

/// View factors between all faces: in closed form if nothing is between, by rays otherwise.
#[pyfunction]
pub fn view_factor_matrix<'py>(
    py: Python<'py>,
    scene: &Bound<'py, CompiledScene>,
    rays: (u32, u32),
    errors: (Option<f64>, Option<f64>),
    seed: u64,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Dense<'py>> {
    let scene = &scene.get().0;
    let aim = Aim { rays: rays.0, row_rays: rays.1, error: errors.0, relative: errors.1, seed };
    let found = told(py, threads, progress, |work| matrix(scene, &aim, work))?;
    let areas = areas(scene);
    let count = areas.len();
    let pairs = found.sampled.iter().flat_map(|sampled| sampled.faces.map(i64::from));
    let [closed, hidden, sampled] = found.counts;
    Ok((
        PyArray1::from_vec(py, areas),
        PyArray1::from_vec(py, found.factors).reshape([count, count])?,
        (
            PyArray1::from_vec(py, pairs.collect()).reshape([found.sampled.len(), 2])?,
            PyArray1::from_iter(py, found.sampled.iter().map(|sampled| sampled.error)),
        ),
        (closed, hidden, sampled),
        found.rays,
        PyArray1::from_vec(py, found.closed),
    ))
}

/// View factors between all faces, each row by rays.
#[pyfunction]
pub fn view_factor_rows<'py>(
    py: Python<'py>,
    scene: &Bound<'py, CompiledScene>,
    rays: u32,
    error: Option<f64>,
    seed: u64,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<ByRays<'py>> {
    let scene = &scene.get().0;
    let aim = Aim { rays: 0, row_rays: rays, error, relative: None, seed };
    let found = told(py, threads, progress, |work| sparse(scene, &aim, work))?;
    let rows = (
        PyArray1::from_vec(py, found.starts),
        PyArray1::from_vec(py, found.faces),
        PyArray1::from_vec(py, found.values),
        PyArray1::from_vec(py, found.errors),
    );
    Ok((PyArray1::from_vec(py, areas(scene)), rows, found.rays))
}

/// Pairs of coplanar overlapping faces, their common areas, whether both face the same way and, if requested, whether
/// they touch front to front; and the areas of all faces.
type Coincident<'py> = (
    Bound<'py, PyArray2<i64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<f64>>,
);

/// Coplanar overlapping faces.
#[pyfunction]
pub fn coincident_faces<'py>(
    py: Python<'py>,
    scene: &Bound<'py, CompiledScene>,
    touching: bool,
) -> PyResult<Coincident<'py>> {
    let scene = &scene.get().0;
    let (found, touch, areas) = py.detach(|| {
        let found = shared_planes(scene);
        let fronts = if touching { Fronts::among(scene, &found) } else { Fronts::default() };
        let touch: Vec<bool> = found.iter().map(|shared| fronts.touch(shared.faces)).collect();
        (found, touch, areas(scene))
    });
    let faces = found.iter().flat_map(|shared| shared.faces.map(i64::from)).collect();
    Ok((
        PyArray1::from_vec(py, faces).reshape([found.len(), 2])?,
        PyArray1::from_iter(py, found.iter().map(|shared| shared.area)),
        PyArray1::from_iter(py, found.iter().map(|shared| shared.is_same)),
        PyArray1::from_vec(py, touch),
        PyArray1::from_vec(py, areas),
    ))
}

/// Runs work on the pool with this number of threads, without the interpreter lock. Signals are handled, and `progress`
/// is called with the finished share ten times a second; an exception from either ends it.
fn told<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(Work<'_>) -> Result<T, Stopped> + Send,
) -> PyResult<T> {
    let watch = Watch::default();
    let (mut raised, mut looks) = (None, 0u32);
    let look = |py: Python<'_>, share: f32, looks: u32| {
        py.check_signals()?;
        match &progress {
            Some(progress) if looks.is_multiple_of(5) => progress.call1(py, (share,)).map(drop),
            _ => Ok(()),
        }
    };
    let done = py.detach(|| {
        watched(
            threads,
            |_| work(Work::of(&watch)),
            || {
                looks = looks.wrapping_add(1);
                raised = Python::attach(|py| look(py, watch.share(), looks)).err();
                if raised.is_some() {
                    watch.stop();
                }
                raised.is_none()
            },
        )
    });
    match (raised, done) {
        (Some(error), _) => Err(error),
        (None, Ok(Ok(found))) => Ok(found),
        (None, Ok(Err(Stopped))) => Err(PyRuntimeError::new_err("work was canceled without a signal")),
        (None, Err(why)) => Err(PyRuntimeError::new_err(why)),
    }
}
