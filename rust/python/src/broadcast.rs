//! Broadcast arrays, read a chunk of rays at a time without expanding them.

use numpy::ndarray::Axis;
use numpy::{Element, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::PyResult;
use pyo3::exceptions::PyValueError;

/// Maps rays to the rows of an array that is broadcast along some dimensions.
#[derive(Clone, Debug)]
pub struct Repeats {
    /// Dimensions, merged where possible, with their strides in rows: 0 if the dimension is broadcast. The last stride
    /// is 0 or 1.
    axes: Vec<(usize, usize)>,
}

impl Repeats {
    /// The rows of `row` entries in an array's memory and, if they are broadcast, the row of each ray.
    pub fn of<'a, T: Element>(
        name: &str,
        array: &'a PyReadonlyArrayDyn<'_, T>,
        row: usize,
    ) -> PyResult<(&'a [T], Option<Self>)> {
        let wrong =
            || PyValueError::new_err(format!("{name} must be C-contiguous, or broadcast from a C-contiguous array"));
        if array.is_c_contiguous() {
            return Ok((array.as_slice().map_err(|_| wrong())?, None));
        }
        let mut view = array.as_array();
        let shape = view.shape().to_vec();
        let lead = shape.len() - usize::from(row > 1);
        for axis in 0..lead {
            if shape[axis] > 1 && view.strides()[axis] == 0 {
                view.collapse_axis(Axis(axis), 0);
            }
        }
        let mut axes: Vec<(usize, usize)> = Vec::with_capacity(lead);
        let mut step = 1;
        for axis in (0..lead).rev().filter(|&axis| shape[axis] > 1) {
            let (length, repeats) = (shape[axis], view.shape()[axis] == 1);
            match axes.last_mut() {
                Some((inner, 0)) if repeats => *inner *= length,
                Some((inner, within)) if !repeats && *within * *inner == step => *inner *= length,
                _ => axes.push((length, if repeats { 0 } else { step })),
            }
            step *= view.shape()[axis];
        }
        axes.reverse();
        Ok((view.to_slice().ok_or_else(wrong)?, Some(Self { axes })))
    }

    /// Copies the rows of a range of rays.
    pub fn rows<T: Copy>(&self, rows: &[T], start: usize, count: usize) -> Vec<T> {
        let mut to = Vec::with_capacity(count);
        let Some((&(length, step), outer)) = self.axes.split_last() else { return vec![rows[0]; count] };
        while to.len() < count {
            let at = start + to.len();
            let (mut rest, within) = (at / length, at % length);
            let mut base = 0;
            for &(length, step) in outer.iter().rev() {
                base += rest % length * step;
                rest /= length;
            }
            let some = (length - within).min(count - to.len());
            match step {
                0 => to.extend(std::iter::repeat_n(rows[base], some)),
                _ => to.extend_from_slice(&rows[base + within..][..some]),
            }
        }
        to
    }
}

/// Values of a range of rays: the single one, one per ray, or broadcast.
pub fn some_of<T: Copy>(repeats: Option<&Repeats>, all: &[T], start: usize, count: usize) -> Vec<T> {
    match repeats {
        Some(repeats) => repeats.rows(all, start, count),
        None if all.len() == 1 => all.to_vec(),
        None => all[start..][..count].to_vec(),
    }
}
