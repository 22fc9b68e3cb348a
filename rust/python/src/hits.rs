//! Arrays of hits: new ones, or those given by the caller.

use numpy::{Element, PyArrayDyn, PyReadwriteArrayDyn};
use pyo3::prelude::*;

use super::arrays::{unwritten, writable};
use super::hit_parts::{HitParts, Rounded, To};
use raywright::scene::Scene;

/// Which parts of hits are asked for, a bit each, in the order of [`Hits`].
pub(super) const ALL: u32 = 0b11111;

/// An array of either float type.
#[derive(FromPyObject, IntoPyObject)]
pub(super) enum Floats<'py> {
    Double(Bound<'py, PyArrayDyn<f64>>),
    Single(Bound<'py, PyArrayDyn<f32>>),
}

type Integers<'py> = Bound<'py, PyArrayDyn<i32>>;

/// t, `shape_id`, primitive and uv, and in a scene with instances instance; none of what is not asked for.
pub(super) type Hits<'py> =
    (Option<Floats<'py>>, Option<Integers<'py>>, Option<Integers<'py>>, Option<Floats<'py>>, Option<Integers<'py>>);

/// A [`Floats`] while it is written to.
enum Written<'py> {
    Double(PyReadwriteArrayDyn<'py, f64>),
    Single(PyReadwriteArrayDyn<'py, f32>),
}

impl<'py> Floats<'py> {
    fn writable(&self, name: &str, lead: &[usize], width: Option<usize>) -> PyResult<Written<'py>> {
        Ok(match self {
            Self::Double(array) => Written::Double(writable(name, array, lead, width)?),
            Self::Single(array) => Written::Single(writable(name, array, lead, width)?),
        })
    }
}

impl Written<'_> {
    /// Where numbers are written, by the entries of rows.
    fn to<'a, T: Rounded>(
        &'a mut self,
        double: impl FnOnce(&'a mut [f64]) -> &'a mut [T],
        single: impl FnOnce(&'a mut [f32]) -> &'a mut [T::Single],
    ) -> PyResult<To<'a, T>> {
        Ok(match self {
            Self::Double(array) => To::Double(double(array.as_slice_mut()?)),
            Self::Single(array) => To::Single(single(array.as_slice_mut()?)),
        })
    }
}

/// Output arrays for a batch of rays, and their leading shape.
pub(super) struct HitArrays<'a, 'py> {
    arrays: Hits<'py>,
    lead: &'a [usize],
}

/// An array that is asked for: the given one, or a new one.
fn asked<'py, T: Element>(
    py: Python<'py>,
    is_asked: bool,
    given: Option<Bound<'py, PyArrayDyn<T>>>,
    lead: &[usize],
) -> PyResult<Option<Bound<'py, PyArrayDyn<T>>>> {
    is_asked.then(|| given.map_or_else(|| unwritten(py, lead, None), Ok)).transpose()
}

impl<'a, 'py> HitArrays<'a, 'py> {
    /// In arrays that are given, or else in new ones, of the parts that `fields` has.
    pub fn new(
        py: Python<'py>,
        scene: &Scene,
        lead: &'a [usize],
        out: Option<Hits<'py>>,
        fields: u32,
    ) -> PyResult<Self> {
        let is_asked = |part: u32| fields >> part & 1 == 1;
        let (t, shape, primitive, uv, instance) = out.unwrap_or((None, None, None, None, None));
        let floats = |part, given: Option<Floats<'py>>, width| {
            let new = || unwritten(py, lead, width).map(Floats::Double);
            is_asked(part).then(|| given.map_or_else(new, Ok)).transpose()
        };
        let (t, uv) = (floats(0, t, None)?, floats(3, uv, Some(2))?);
        let (shape, primitive) = (asked(py, is_asked(1), shape, lead)?, asked(py, is_asked(2), primitive, lead)?);
        let instance = asked(py, is_asked(4) && scene.geometry().has_instances(), instance, lead)?;
        Ok(Self { arrays: (t, shape, primitive, uv, instance), lead })
    }

    /// The arrays after a function has written them. What leads back into the scene cannot be written any more.
    pub fn written(self, write: impl FnOnce(HitParts<'_>) -> PyResult<()>) -> PyResult<Hits<'py>> {
        let (t, shape, primitive, uv, instance) = &self.arrays;
        let lead = self.lead;
        let integers = |name: &str, array: &Option<Integers<'py>>| {
            array.as_ref().map(|array| writable(name, array, lead, None)).transpose()
        };
        let mut to_t = t.as_ref().map(|t| t.writable("out.t", lead, None)).transpose()?;
        let mut to_uv = uv.as_ref().map(|uv| uv.writable("out.uv", lead, Some(2))).transpose()?;
        let mut to_shape = integers("out.shape_id", shape)?;
        let mut to_primitive = integers("out.primitive", primitive)?;
        let mut to_instance = integers("out.instance", instance)?;
        {
            write(HitParts {
                count: lead.iter().product(),
                t: to_t.as_mut().map(|t| t.to(|all| all, |all| all)).transpose()?,
                uv: to_uv
                    .as_mut()
                    .map(|uv| uv.to(|all| all.as_chunks_mut().0, |all| all.as_chunks_mut().0))
                    .transpose()?,
                shape: to_shape.as_mut().map(|to| to.as_slice_mut()).transpose()?,
                primitive: to_primitive.as_mut().map(|to| to.as_slice_mut()).transpose()?,
                instance: to_instance.as_mut().map(|to| to.as_slice_mut()).transpose()?,
            })?;
        }
        for array in [to_shape, to_primitive, to_instance].into_iter().flatten() {
            let _ = array.make_nonwriteable();
        }
        Ok(self.arrays)
    }
}
