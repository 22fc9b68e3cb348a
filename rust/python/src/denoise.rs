//! Denoising by parts of the samples.

use numpy::{PyArray1, PyArray3, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::signals::heard;
use raywright::optics::Rgb;
use raywright::render::{self, denoise};

/// A picture in two halves of samples, each in two quarters. `quarters` are (4, H, W, 3); `variances`, those of the
/// halves' means, are (2, H, W, 3).
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct HalfArrays<'py> {
    quarters: PyReadonlyArrayDyn<'py, f32>,
    variances: PyReadonlyArrayDyn<'py, f32>,
    samples: f64,
    patch: usize,
}

impl HalfArrays<'_> {
    fn read(&self) -> PyResult<denoise::Halves> {
        let shape = self.quarters.shape();
        let &[4, height, width, 3] = shape else {
            return Err(PyValueError::new_err(format!("quarters are {shape:?}, expected (4, H, W, 3)")));
        };
        let [quarters, variances] = [pictures(&self.quarters)?, pictures(&self.variances)?];
        let ([a, b, c, d], [e, f]) = (
            quarters.try_into().map_err(|_| PyValueError::new_err("quarters must be four pictures"))?,
            <[Vec<Rgb>; 2]>::try_from(variances)
                .map_err(|_| PyValueError::new_err("variances must be two pictures"))?,
        );
        let pixels = width * height;
        if e.len() != pixels || f.len() != pixels || self.patch == 0 {
            return Err(PyValueError::new_err("variances must be (2, H, W, 3), and patches hold pixels"));
        }
        Ok(denoise::Halves {
            width,
            height,
            patch: self.patch,
            samples: self.samples,
            quarters: [a, b, c, d],
            variances: [e, f],
        })
    }
}

/// Pictures along the first dimension, each row by row.
fn pictures(array: &PyReadonlyArrayDyn<'_, f32>) -> PyResult<Vec<Vec<Rgb>>> {
    let (shape, values) = (array.shape(), array.as_slice()?);
    if shape.len() != 4 || shape[3] != 3 {
        return Err(PyValueError::new_err(format!("pictures are {shape:?}, expected (N, H, W, 3)")));
    }
    let rgb = |pixel: &[f32]| Rgb::new(f64::from(pixel[0]), f64::from(pixel[1]), f64::from(pixel[2]));
    let size = shape[1] * shape[2] * 3;
    Ok((0..shape[0]).map(|i| values[i * size..][..size].chunks(3).map(rgb).collect()).collect())
}

fn flat(pictures: impl IntoIterator<Item = Vec<Rgb>>) -> Vec<f32> {
    pictures.into_iter().flatten().flat_map(|rgb| rgb.to_array()).map(|x| x as f32).collect()
}

/// Quarters and variances of a film as arrays of (4, H, W, 3) and (2, H, W, 3).
pub(super) type QuarterArrays<'py> = (Bound<'py, PyArrayDyn<f32>>, Bound<'py, PyArrayDyn<f32>>);

/// The halves of a film, if it keeps them and has enough samples.
pub(super) fn halves<'py>(py: Python<'py>, film: &render::Film) -> PyResult<Option<QuarterArrays<'py>>> {
    let Some(halves) = film.halves() else { return Ok(None) };
    let (height, width) = (halves.height, halves.width);
    let quarters = PyArray1::from_vec(py, flat(halves.quarters)).reshape(&[4, height, width, 3][..])?;
    let variances = PyArray1::from_vec(py, flat(halves.variances)).reshape(&[2, height, width, 3][..])?;
    Ok(Some((quarters, variances)))
}

/// Filters each half of a picture in several ways, the first unfiltered, (2, ways, H, W, 3). `features` are two
/// independent pictures of auxiliary features, (2, H, W, 7).
#[pyfunction]
pub fn denoise_candidates<'py>(
    py: Python<'py>,
    halves: HalfArrays<'py>,
    features: PyReadonlyArrayDyn<'py, f64>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let halves = halves.read()?;
    let (height, width) = (halves.height, halves.width);
    if features.shape() != [2, height, width, denoise::FEATURES] {
        let shape = features.shape();
        return Err(PyValueError::new_err(format!("features are {shape:?}, expected (2, H, W, 7)")));
    }
    let (one, other) = features.as_slice()?.split_at(height * width * denoise::FEATURES);
    let features = [one.to_vec(), other.to_vec()];
    let found = heard(py, threads, |cancel| denoise::candidates(&halves, &features, cancel))?;
    let ways = found[0].len();
    PyArray1::from_vec(py, flat(found.into_iter().flatten())).reshape(&[2, ways, height, width, 3][..])
}

/// A picture, the errors of its pixels averaged over neighbors, its error with the ends of its interval, and whether
/// that is reliable.
type Settled<'py> = (Bound<'py, PyArray3<f32>>, Bound<'py, PyArray3<f32>>, (f64, f64, f64), bool);

/// Selects the best candidate for each half, (2, ways, H, W, 3); the first are the unfiltered halves.
#[pyfunction]
pub fn denoise_settle<'py>(
    py: Python<'py>,
    halves: HalfArrays<'py>,
    candidates: PyReadonlyArrayDyn<'py, f32>,
    threads: Option<usize>,
) -> PyResult<Settled<'py>> {
    let halves = halves.read()?;
    let (height, width) = (halves.height, halves.width);
    let &[2, ways, h, w, 3] = candidates.shape() else {
        return Err(PyValueError::new_err("candidates must be (2, ways, H, W, 3)"));
    };
    if ways == 0 || (h, w) != (height, width) {
        return Err(PyValueError::new_err("candidates must be as large as the picture"));
    }
    let rgb = |pixel: &[f32]| Rgb::new(f64::from(pixel[0]), f64::from(pixel[1]), f64::from(pixel[2]));
    let size = height * width * 3;
    let values = candidates.as_slice()?;
    let of = |half: usize, way: usize| -> Vec<Rgb> {
        values[(half * ways + way) * size..][..size].chunks(3).map(rgb).collect()
    };
    let candidates = [0, 1].map(|half| (0..ways).map(|way| of(half, way)).collect());
    let done = heard(py, threads, |_| denoise::settle(&halves, &candidates))?;
    let error = done.error;
    let picture = |pixels: Vec<f32>| PyArray1::from_vec(py, pixels).reshape([height, width, 3]);
    let off = render::roots(done.squares).into_flattened();
    Ok((picture(flat([done.means]))?, picture(off)?, (error.value, error.low, error.high), error.is_trusted()))
}
