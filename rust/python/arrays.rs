//! numpy arrays as slices of numbers or of vectors.

use numpy::{Element, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::math::{DVec3, Vec3};

/// An (N,3) array of either float type.
#[derive(FromPyObject)]
pub enum Triples<'py> {
    /// float64.
    Double(PyReadonlyArray2<'py, f64>),
    /// float32.
    Single(PyReadonlyArray2<'py, f32>),
}

/// The rows of a [`Triples`], which threads may share.
#[derive(Clone, Copy)]
pub enum Rows<'a> {
    /// float64.
    Double(&'a [[f64; 3]]),
    /// float32.
    Single(&'a [[f32; 3]]),
}

impl Triples<'_> {
    /// Its rows; `name` is the argument's, for the error if it is not what the package promised.
    pub fn rows(&self, name: &str) -> PyResult<Rows<'_>> {
        Ok(match self {
            Self::Double(array) => Rows::Double(rows(name, array)?),
            Self::Single(array) => Rows::Single(rows(name, array)?),
        })
    }
}

impl Rows<'_> {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Double(rows) => rows.len(),
            Self::Single(rows) => rows.len(),
        }
    }

    /// One of them.
    #[inline(always)]
    pub fn get(&self, i: usize) -> DVec3 {
        match self {
            Self::Double(rows) => DVec3::from_array(rows[i]),
            Self::Single(rows) => Vec3::from_array(rows[i]).as_dvec3(),
        }
    }

    /// All of them, rounded to f32.
    pub fn to_single(self) -> Vec<Vec3> {
        match self {
            Self::Double(rows) => rows.iter().map(|&r| DVec3::from_array(r).as_vec3()).collect(),
            Self::Single(rows) => rows.iter().map(|&r| Vec3::from_array(r)).collect(),
        }
    }
}

/// The rows of an (N,K) array.
pub fn rows<'a, T: Element, const K: usize>(name: &str, array: &'a PyReadonlyArray2<'_, T>) -> PyResult<&'a [[T; K]]> {
    match array.as_slice() {
        Ok(all) if array.shape()[1] == K => Ok(all.as_chunks().0),
        _ => {
            Err(PyValueError::new_err(format!("{name} has shape {:?}, expected C-contiguous (N, {K})", array.shape())))
        }
    }
}

/// The numbers of an (N,) array.
pub fn numbers<'a, T: Element>(name: &str, array: &'a PyReadonlyArray1<'_, T>) -> PyResult<&'a [T]> {
    array.as_slice().map_err(|_| PyValueError::new_err(format!("{name} must be C-contiguous")))
}
