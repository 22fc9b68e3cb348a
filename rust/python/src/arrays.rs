//! Conversion of numpy arrays to slices of numbers or vectors.

use numpy::{
    Element, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArrayDyn, PyReadwriteArrayDyn,
    PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::PyTypeInfo;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyFloat, PyTuple};

use super::broadcast::Repeats;
use raywright::math::{DVec3, Vec3};
use raywright::scene::Vertices;

/// A (..., 3) array of either float type.
pub enum Triples<'py> {
    /// float64.
    Double(PyReadonlyArrayDyn<'py, f64>),
    /// float32.
    Single(PyReadonlyArrayDyn<'py, f32>),
}

impl<'py> FromPyObject<'_, 'py> for Triples<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(array) = object.cast::<PyArrayDyn<f64>>() {
            return Ok(Self::Double(array.try_readonly()?));
        }
        match object.cast::<PyArrayDyn<f32>>() {
            Ok(array) => Ok(Self::Single(array.try_readonly()?)),
            Err(_) => Err(PyTypeError::new_err("expected an array of float32 or float64")),
        }
    }
}

impl<'py> Triples<'py> {
    /// An object that needs no conversion, with its leading shape: exactly a numpy array, of a float type, aligned,
    /// C-contiguous and of shape (..., 3). `None` for all others.
    pub fn plain(object: &Bound<'py, PyAny>) -> Option<(Self, Vec<usize>)> {
        fn lead<T: Element>(array: &Bound<'_, PyArrayDyn<T>>) -> Option<Vec<usize>> {
            let (&last, lead) = array.shape().split_last()?;
            (last == 3 && array.is_c_contiguous() && array.data().is_aligned()).then(|| lead.to_vec())
        }
        if !object.get_type().is(PyUntypedArray::type_object(object.py())) {
            return None;
        }
        if let Ok(array) = object.cast::<PyArrayDyn<f32>>() {
            let lead = lead(array)?;
            return Some((Self::Single(array.try_readonly().ok()?), lead));
        }
        let array = object.cast::<PyArrayDyn<f64>>().ok()?;
        let lead = lead(array)?;
        Some((Self::Double(array.try_readonly().ok()?), lead))
    }
}

/// The rows of a [`Triples`], shareable between threads.
#[derive(Clone, Copy)]
pub enum TripleRows<'a> {
    /// float64.
    Double(&'a [[f64; 3]]),
    /// float32.
    Single(&'a [[f32; 3]]),
}

/// A row of three numbers.
pub trait Row: Copy {
    /// Converts the row to a vector.
    fn vector(self) -> DVec3;
    /// Converts a vector to a row, rounded to its type.
    fn of(vector: DVec3) -> Self;
}

impl Row for [f64; 3] {
    #[inline(always)]
    fn vector(self) -> DVec3 {
        DVec3::from_array(self)
    }
    #[inline(always)]
    fn of(vector: DVec3) -> Self {
        vector.to_array()
    }
}

impl Row for [f32; 3] {
    #[inline(always)]
    fn vector(self) -> DVec3 {
        Vec3::from_array(self).as_dvec3()
    }
    #[inline(always)]
    fn of(vector: DVec3) -> Self {
        vector.as_vec3().to_array()
    }
}

impl Triples<'_> {
    /// Its rows and, if they are broadcast, the row of each ray.
    pub fn repeated(&self, name: &str) -> PyResult<(TripleRows<'_>, Option<Repeats>)> {
        let shape = match self {
            Self::Double(array) => array.shape(),
            Self::Single(array) => array.shape(),
        };
        if shape.last() != Some(&3) {
            return Err(PyValueError::new_err(format!("{name} has shape {shape:?}, expected (..., 3)")));
        }
        Ok(match self {
            Self::Double(array) => {
                let (rows, repeats) = Repeats::of(name, array, 3)?;
                (TripleRows::Double(rows.as_chunks().0), repeats)
            }
            Self::Single(array) => {
                let (rows, repeats) = Repeats::of(name, array, 3)?;
                (TripleRows::Single(rows.as_chunks().0), repeats)
            }
        })
    }

    /// Its rows; `name` is the argument's, for the error if the layout is wrong.
    pub fn rows(&self, name: &str) -> PyResult<TripleRows<'_>> {
        Ok(match self {
            Self::Double(array) => TripleRows::Double(vectors(name, array)?),
            Self::Single(array) => TripleRows::Single(vectors(name, array)?),
        })
    }
}

impl<'a> TripleRows<'a> {
    /// A range of rows, or the single row for all.
    pub fn some(self, start: usize, count: usize) -> Self {
        match self {
            TripleRows::Single(rows) => {
                TripleRows::Single(if rows.len() == 1 { rows } else { &rows[start..][..count] })
            }
            TripleRows::Double(rows) => {
                TripleRows::Double(if rows.len() == 1 { rows } else { &rows[start..][..count] })
            }
        }
    }
}

impl TripleRows<'_> {
    /// Number of rows.
    pub fn len(&self) -> usize {
        match self {
            Self::Double(rows) => rows.len(),
            Self::Single(rows) => rows.len(),
        }
    }

    /// A row as a vector.
    #[inline(always)]
    pub fn get(&self, i: usize) -> DVec3 {
        match self {
            Self::Double(rows) => rows[i].vector(),
            Self::Single(rows) => rows[i].vector(),
        }
    }

    /// All rows as vertices, without rounding.
    pub fn vertices(self) -> Vertices {
        match self {
            Self::Double(rows) => Vertices::Double(rows.iter().map(|&r| DVec3::from_array(r)).collect()),
            Self::Single(_) => Vertices::Single(self.to_single()),
        }
    }

    /// All rows, rounded to f32.
    pub fn to_single(self) -> Vec<Vec3> {
        match self {
            Self::Double(rows) => rows.iter().map(|&r| DVec3::from_array(r).as_vec3()).collect(),
            Self::Single(rows) => rows.iter().map(|&r| Vec3::from_array(r)).collect(),
        }
    }
}

/// One number for all rays, or an array with one per ray.
pub enum Numbers<'py> {
    /// A float.
    One([f64; 1]),
    /// A float64 array of any shape.
    Each(PyReadonlyArrayDyn<'py, f64>),
}

impl<'py> FromPyObject<'_, 'py> for Numbers<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match object.cast::<PyFloat>() {
            Ok(number) => Ok(Self::One([number.value()])),
            Err(_) => Ok(Self::Each(object.extract()?)),
        }
    }
}

impl Numbers<'_> {
    /// All numbers, or the single one and, if they are broadcast, the index of each ray.
    pub fn repeated(&self, name: &str) -> PyResult<(&[f64], Option<Repeats>)> {
        match self {
            Self::One(number) => Ok((number, None)),
            Self::Each(array) => Repeats::of(name, array, 1),
        }
    }

    /// All numbers, or the single one; `name` is the argument's.
    pub fn slice(&self, name: &str) -> PyResult<&[f64]> {
        match self {
            Self::One(number) => Ok(number),
            Self::Each(array) => contiguous(name, array),
        }
    }
}

fn contiguous<'a, T: Element>(name: &str, array: &'a PyReadonlyArrayDyn<'_, T>) -> PyResult<&'a [T]> {
    match array.as_slice() {
        Ok(all) if array.is_c_contiguous() => Ok(all),
        _ => Err(PyValueError::new_err(format!("{name} must be C-contiguous"))),
    }
}

/// Vectors of a (..., K) array.
pub fn vectors<'a, T: Element, const K: usize>(
    name: &str,
    array: &'a PyReadonlyArrayDyn<'_, T>,
) -> PyResult<&'a [[T; K]]> {
    match array.shape().last() {
        Some(&k) if k == K => Ok(contiguous(name, array)?.as_chunks().0),
        _ => Err(PyValueError::new_err(format!("{name} has shape {:?}, expected (..., {K})", array.shape()))),
    }
}

/// Rows of an (N, 2) array of either float type, rounded to f32.
pub fn pairs(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Vec<[f32; 2]>> {
    if let Ok(doubles) = array.extract::<PyReadonlyArray2<'_, f64>>() {
        return Ok(rows::<f64, 2>(name, &doubles)?.iter().map(|row| row.map(|x| x as f32)).collect());
    }
    Ok(rows::<f32, 2>(name, &array.extract()?)?.to_vec())
}

/// Rows of an (N, K) array.
pub fn rows<'a, T: Element, const K: usize>(name: &str, array: &'a PyReadonlyArray2<'_, T>) -> PyResult<&'a [[T; K]]> {
    match array.as_slice() {
        Ok(all) if array.shape()[1] == K => Ok(all.as_chunks().0),
        _ => {
            Err(PyValueError::new_err(format!("{name} has shape {:?}, expected C-contiguous (N, {K})", array.shape())))
        }
    }
}

/// Numbers of an (N,) array.
pub fn numbers<'a, T: Element>(name: &str, array: &'a PyReadonlyArray1<'_, T>) -> PyResult<&'a [T]> {
    array.as_slice().map_err(|_| PyValueError::new_err(format!("{name} must be C-contiguous")))
}

/// An uninitialized array with leading shape `lead`, and `width` entries per row if it is given. The caller must write
/// every entry. Zeroing would add a single-threaded pass over memory.
pub fn unwritten<'py, T: Element>(
    py: Python<'py>,
    lead: &[usize],
    width: Option<usize>,
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    // For small arrays zeroing is faster than the call of a Python function.
    const SMALL: usize = 4096;
    static EMPTY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let shape: Vec<usize> = lead.iter().copied().chain(width).collect();
    if shape.iter().product::<usize>() <= SMALL {
        return Ok(PyArrayDyn::zeros(py, shape, false));
    }
    let empty = EMPTY.import(py, "numpy", "empty")?;
    Ok(empty.call1((PyTuple::new(py, shape)?, T::get_dtype(py)))?.cast_into()?)
}

/// Borrows an array for writing. It must have the shape that [`unwritten`] would give it, be C-contiguous, and not
/// overlap with arrays that are read. `name` is the argument's.
pub fn writable<'py, T: Element>(
    name: &str,
    array: &Bound<'py, PyArrayDyn<T>>,
    lead: &[usize],
    width: Option<usize>,
) -> PyResult<PyReadwriteArrayDyn<'py, T>> {
    let is_fit = array.is_c_contiguous() && array.shape().iter().eq(lead.iter().chain(&width));
    if !is_fit {
        let shape = array.shape();
        return Err(PyValueError::new_err(format!("{name} has shape {shape:?}, expected C-contiguous, of {lead:?}")));
    }
    let why = "is read-only, or shares memory with an argument";
    array.try_readwrite().map_err(|_| PyValueError::new_err(format!("{name} cannot be written to: it {why}")))
}

/// Makes the array read-only.
pub fn sealed<'py, T: Element>(array: Bound<'py, PyArrayDyn<T>>) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    array.try_readwrite()?.make_nonwriteable();
    Ok(array)
}
