//! Arrays of hits: new ones, or those given by the caller.

use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::arrays::{unwritten, writable};
use super::columns::HitParts;
use raywright::scene::Scene;

/// t, shape_id, primitive and uv, and in a scene with instances instance.
pub(super) type Hits<'py> = (
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<i32>>,
    Bound<'py, PyArrayDyn<i32>>,
    Bound<'py, PyArrayDyn<f64>>,
    Option<Bound<'py, PyArrayDyn<i32>>>,
);

/// Mutable parts of all arrays; the last holds instance numbers if the scene has instances.
pub(super) type AllParts<'a> = (HitParts<'a>, Option<&'a mut [i32]>);

/// Output arrays for a batch of rays, and their leading shape.
pub(super) struct HitArrays<'a, 'py> {
    arrays: Hits<'py>,
    lead: &'a [usize],
}

impl<'a, 'py> HitArrays<'a, 'py> {
    /// Uses the given arrays, or creates new ones.
    pub fn new(py: Python<'py>, scene: &Scene, lead: &'a [usize], out: Option<Hits<'py>>) -> PyResult<Self> {
        let (t, shape, primitive, uv, instance) = match out {
            Some(out) => out,
            None => {
                let numbers = (unwritten(py, lead, None)?, unwritten(py, lead, None)?);
                (unwritten(py, lead, None)?, numbers.0, numbers.1, unwritten(py, lead, Some(2))?, None)
            }
        };
        let instance = match scene.geometry().has_instances() {
            true => Some(instance.map_or_else(|| unwritten(py, lead, None), Ok)?),
            false => None,
        };
        Ok(Self { arrays: (t, shape, primitive, uv, instance), lead })
    }

    /// Writes the arrays by a function and returns them. Arrays of indices into the scene become read-only.
    pub fn written(self, write: impl FnOnce(AllParts<'_>) -> PyResult<()>) -> PyResult<Hits<'py>> {
        let (t, shape, primitive, uv, instance) = &self.arrays;
        let lead = self.lead;
        let (mut to_t, mut to_shape) =
            (writable("out.t", t, lead, None)?, writable("out.shape_id", shape, lead, None)?);
        let mut to_primitive = writable("out.primitive", primitive, lead, None)?;
        let mut to_uv = writable("out.uv", uv, lead, Some(2))?;
        let mut to_instance = instance.as_ref().map(|to| writable("out.instance", to, lead, None)).transpose()?;
        {
            let (ts, shapes) = (to_t.as_slice_mut()?, to_shape.as_slice_mut()?);
            let (primitives, uvs) = (to_primitive.as_slice_mut()?, to_uv.as_slice_mut()?.as_chunks_mut().0);
            let instances = to_instance.as_mut().map(|to| to.as_slice_mut()).transpose()?;
            write(((ts, shapes, primitives, uvs), instances))?;
        }
        let _ = (to_shape.make_nonwriteable(), to_primitive.make_nonwriteable());
        let _ = to_instance.map(|to| to.make_nonwriteable());
        Ok(self.arrays)
    }
}
