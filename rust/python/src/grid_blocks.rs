//! Grids of numbers, stored by the core.

use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;

use raywright::scene::media::{Blocks, Building};

/// Numbers on a grid, one or three per point; blocks of zeros take no memory.
#[pyclass(frozen, module = "raywright._core")]
pub struct GridBlocks(pub Kept);

/// The stored grid.
pub enum Kept {
    Grey(Arc<Blocks<1>>),
    Coloured(Arc<Blocks<3>>),
}

#[pymethods]
impl GridBlocks {
    /// Creates a grid with this size, one or three numbers per point, from parts: the start of each and its numbers as
    /// an array.
    #[new]
    fn new(size: [usize; 3], coloured: bool, parts: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(if coloured {
            Kept::Coloured(Arc::new(built(size, parts)?))
        } else {
            Kept::Grey(Arc::new(built(size, parts)?))
        }))
    }

    /// Memory in bytes.
    fn bytes(&self) -> usize {
        match &self.0 {
            Kept::Grey(blocks) => blocks.bytes(),
            Kept::Coloured(blocks) => blocks.bytes(),
        }
    }

    /// Lower and upper corners of the stored blocks, (N, 2, 3).
    fn kept<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<i64>>> {
        let kept: Vec<[[usize; 3]; 2]> = match &self.0 {
            Kept::Grey(blocks) => blocks.kept().collect(),
            Kept::Coloured(blocks) => blocks.kept().collect(),
        };
        let flat: Vec<i64> = kept.iter().flatten().flatten().map(|&n| n as i64).collect();
        PyArray1::from_vec(py, flat).reshape([kept.len(), 2, 3])
    }

    /// Numbers of a part, point by point.
    fn part<'py>(&self, py: Python<'py>, low: [usize; 3], high: [usize; 3]) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let size = match &self.0 {
            Kept::Grey(blocks) => blocks.size(),
            Kept::Coloured(blocks) => blocks.size(),
        };
        if (0..3).any(|axis| low[axis] > high[axis] || high[axis] > size[axis]) {
            return Err(PyValueError::new_err("part must be inside the grid"));
        }
        let part = [0, 1, 2].map(|axis| low[axis]..high[axis]);
        let numbers = match &self.0 {
            Kept::Grey(blocks) => blocks.part(part).into_flattened(),
            Kept::Coloured(blocks) => blocks.part(part).into_flattened(),
        };
        Ok(PyArray1::from_vec(py, numbers))
    }

    /// Greatest number.
    fn greatest(&self) -> f32 {
        match &self.0 {
            Kept::Grey(blocks) => blocks.range(blocks.size().map(|n| 0..n))[1][0],
            Kept::Coloured(blocks) => blocks.range(blocks.size().map(|n| 0..n))[1].into_iter().fold(0.0, f32::max),
        }
    }

    /// Returns whether all numbers equal those of another.
    fn same(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Kept::Grey(a), Kept::Grey(b)) => a == b,
            (Kept::Coloured(a), Kept::Coloured(b)) => a == b,
            _ => false,
        }
    }
}

fn built<const C: usize>(size: [usize; 3], parts: &Bound<'_, PyAny>) -> PyResult<Blocks<C>> {
    let mut building = Building::new(size).map_err(PyValueError::new_err)?;
    for part in parts.try_iter()? {
        let (from, numbers): ([usize; 3], PyReadonlyArrayDyn<'_, f32>) = part?.extract()?;
        let &[x, y, z, ..] = numbers.shape() else {
            return Err(PyValueError::new_err("a part must have three axes"));
        };
        let all = numbers.as_slice().map_err(|_| PyValueError::new_err("a part must be C-contiguous"))?;
        building.put(from, [x, y, z], all.as_chunks::<C>().0).map_err(PyValueError::new_err)?;
    }
    Ok(building.finish())
}
