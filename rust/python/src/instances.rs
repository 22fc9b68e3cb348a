//! Instances of the Python package; prototypes are compiled once and cached.

use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, LazyLock, Mutex, Weak};

use super::accelerators;
use super::arrays::vectors;
use super::builds::{self, Builds};
use super::kinds::Class;
use raywright::math::Hit;
use raywright::scene::{self, Instances, Matrix, Precision, Prototype, Surface};
use raywright::workers;

/// `raywright.Instance`.
#[derive(FromPyObject)]
struct Instance<'py> {
    shapes: Bound<'py, PyTuple>,
    transform: PyReadonlyArrayDyn<'py, f64>,
    transform_end: Option<PyReadonlyArrayDyn<'py, f64>>,
    accelerator: Bound<'py, PyAny>,
}

/// Options of a scene for its prototypes.
#[derive(Clone, Copy)]
pub struct Wishes<'a> {
    /// Precision of vertices.
    pub precision: Precision,
    /// Build effort.
    pub quality: &'a str,
    /// True for spectral rendering.
    pub waves: bool,
    /// Builds in progress.
    pub builds: &'a Builds,
}

/// Cache key of a prototype: the identities of its shapes, its accelerator's description, and the scene's options.
#[derive(Clone, PartialEq, Eq, Hash)]
struct InstanceKey {
    shapes: Vec<usize>,
    accelerator: String,
    precision: Precision,
    quality: String,
    waves: bool,
}

/// Cache of prototypes held by some scene. An object is identified by its address, which is not reused while the
/// prototype lives, because its owners keep its shapes alive ([`CompiledScene::kept`]).
static GROUPS: LazyLock<Mutex<HashMap<InstanceKey, Weak<Prototype>>>> = LazyLock::new(Mutex::default);

/// Rows of (4, 4) or (N, 4, 4) matrices without the last row of each.
fn matrices(name: &str, array: &PyReadonlyArrayDyn<'_, f64>) -> PyResult<Vec<Matrix>> {
    let rows = vectors::<f64, 4>(name, array)?;
    if !rows.len().is_multiple_of(4) {
        return Err(PyValueError::new_err(format!("{name} has {} rows, expected four for each matrix", rows.len())));
    }
    Ok(rows.as_chunks::<4>().0.iter().map(|&[x, y, z, _]| [x, y, z]).collect())
}

static INSTANCE: Class = Class::new("scene.instance", "Instance");

/// Returns whether a description is an instance.
pub fn is_instance(shape: &Bound<'_, PyAny>) -> PyResult<bool> {
    INSTANCE.has(shape)
}

/// Reads the shapes of a prototype; objects that must live as long as nested prototypes are added to the last argument.
type ReadShapes<'a> = &'a dyn Fn(&[Bound<'_, PyAny>], &mut Vec<Py<PyAny>>) -> PyResult<Vec<scene::Shape>>;

/// Reads an instance. `read_shapes` reads its shapes; objects that must live as long as the prototype are added to
/// `kept`.
pub fn read(
    instance: &Bound<'_, PyAny>,
    wishes: Wishes<'_>,
    kept: &mut Vec<Py<PyAny>>,
    read_shapes: ReadShapes<'_>,
) -> PyResult<scene::Shape> {
    let py = instance.py();
    let Instance { shapes, transform, transform_end, accelerator } = instance.extract()?;
    let prototype = prototype(&shapes, &accelerator, wishes, kept, read_shapes)?;
    let start = matrices("transform", &transform)?;
    let end = transform_end.as_ref().map(|end| matrices("transform_end", end)).transpose()?;
    let instances = in_pool(py, || match end {
        None => Instances::new(prototype, &start),
        Some(end) => Instances::moving(prototype, start.into_iter().zip(end).map(|(a, b)| [a, b]).collect()),
    })?;
    let instances = instances.map_err(|e| PyValueError::new_err(e.to_string()))?;
    if instances.count() >= 1 << 31 {
        return Err(PyValueError::new_err(format!(
            "an instance has {} copies, expected fewer than 2^31",
            instances.count()
        )));
    }
    Ok(scene::Shape { surface: Surface::Instances(instances), ..scene::Shape::default() })
}

/// The prototype of an instance, possibly cached.
fn prototype(
    shapes: &Bound<'_, PyTuple>,
    accelerator: &Bound<'_, PyAny>,
    wishes: Wishes<'_>,
    kept: &mut Vec<Py<PyAny>>,
    read_shapes: ReadShapes<'_>,
) -> PyResult<Arc<Prototype>> {
    let py = shapes.py();
    let key = InstanceKey {
        shapes: shapes.iter().map(|s| s.as_ptr() as usize).collect(),
        accelerator: accelerator.repr()?.to_str()?.to_owned(),
        precision: wishes.precision,
        quality: wishes.quality.to_owned(),
        waves: wishes.waves,
    };
    // Kept before the lookup, so that from here on no other objects can have these addresses.
    kept.push(shapes.clone().into_any().unbind());
    let known = || GROUPS.lock().expect("nobody panics here");
    if let Some(prototype) = known().get(&key).and_then(Weak::upgrade) {
        return Ok(prototype);
    }
    let inner = read_shapes(&shapes.iter().collect::<Vec<_>>(), kept)?;
    let build = accelerators::read(accelerator, wishes.quality)?;
    let size = builds::size(&inner);
    let prototype = Arc::new(wishes.builds.build(py, size, |work| Prototype::watched(inner, build, work))?);
    let mut known = known();
    known.retain(|_, prototype| prototype.strong_count() > 0);
    known.insert(key, Arc::downgrade(&prototype));
    Ok(prototype)
}

/// Size of a build over shapes: faces, instances and others, and the contents of prototypes once.
pub fn size(shapes: &[Bound<'_, PyAny>], seen: &mut HashSet<usize>) -> PyResult<usize> {
    let mut size = 0;
    for shape in shapes {
        if is_instance(shape)? {
            let Instance { shapes, transform, .. } = shape.extract()?;
            size += if transform.ndim() == 3 { transform.len() / 16 } else { 1 };
            if seen.insert(shapes.as_ptr() as usize) {
                size += self::size(&shapes.iter().collect::<Vec<_>>(), seen)?;
            }
        } else {
            size += if shape.hasattr("faces")? { shape.getattr("faces")?.len()? } else { 1 };
        }
    }
    Ok(size)
}

fn in_pool<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| workers::pool(None).map(|pool| pool.install(work))).map_err(PyRuntimeError::new_err)
}

/// The first of some matrices, (4, 4) or (N, 4, 4), that has no inverse, and the reason; None if all have one.
#[pyfunction]
pub fn singular_transform(py: Python<'_>, transform: PyReadonlyArrayDyn<'_, f64>) -> PyResult<Option<(usize, String)>> {
    let matrices = matrices("transform", &transform)?;
    let checked = in_pool(py, || scene::check_transforms(&matrices))?;
    Ok(checked.err().map(|bad| (bad.index, bad.why.to_string())))
}

/// The copy that was hit and what in it; −1 and `number` where it is none.
pub fn located(scene: &scene::Scene, hit: &Hit, number: i32) -> (i32, i32) {
    if !hit.is_hit() || scene.geometry().instances_of(scene.geometry().locate(hit.primitive).0).is_none() {
        return (-1, number);
    }
    (number, hit.inner as i32)
}
