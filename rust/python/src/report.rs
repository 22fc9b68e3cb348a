//! Reports: routines compared side by side.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;

use super::arrays::rows;
use raywright::math::Vec3;
use raywright::shapes::triangle::routines::{Contest, SingleRay, TriangleHit};

/// The triangle routines on the same ray-triangle pairs.
#[pyclass(frozen, module = "raywright._core")]
pub struct KernelContest(Contest);

#[pymethods]
impl KernelContest {
    #[new]
    fn new(
        py: Python<'_>,
        origins: PyReadonlyArray2<'_, f32>,
        directions: PyReadonlyArray2<'_, f32>,
        corners: PyReadonlyArray2<'_, f32>,
    ) -> PyResult<Self> {
        let (origins, directions) = (rows::<f32, 3>("origins", &origins)?, rows::<f32, 3>("directions", &directions)?);
        let corners = rows::<f32, 9>("corners", &corners)?;
        let lengths = [origins.len(), directions.len(), corners.len()];
        if lengths != [lengths[0]; 3] {
            return Err(PyValueError::new_err(format!("origins, directions and corners have lengths {lengths:?}")));
        }
        Ok(Self(py.detach(|| {
            let vector = |&v: &[f32; 3]| Vec3::from_array(v);
            let rays = origins.iter().zip(directions);
            let rays: Vec<_> = rays.map(|(o, d)| SingleRay { origin: vector(o), direction: vector(d) }).collect();
            let triangles: Vec<[Vec3; 3]> =
                corners.iter().map(|c| [0, 3, 6].map(|i| Vec3::new(c[i], c[i + 1], c[i + 2]))).collect();
            Contest::new(&rays, &triangles)
        })))
    }

    #[getter]
    fn routines(&self) -> Vec<(&'static str, usize)> {
        self.0.contenders().map(|contender| (contender.name(), contender.bytes())).collect()
    }

    fn round(&self, py: Python<'_>) -> Vec<f64> {
        py.detach(|| self.0.round()).iter().map(|spent| spent.as_secs_f64()).collect()
    }

    #[allow(clippy::type_complexity)]
    fn answers<'py>(
        &self,
        py: Python<'py>,
        routine: usize,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>)> {
        const MISS: TriangleHit = TriangleHit { t: f64::INFINITY, u: 0.0, v: 0.0 };
        let contender = self.0.contenders().nth(routine).ok_or_else(|| {
            PyIndexError::new_err(format!("routine is {routine}, expected less than {}", self.0.contenders().len()))
        })?;
        let answers: Vec<_> = py.detach(|| contender.answers().into_iter().map(|a| a.unwrap_or(MISS)).collect());
        let t = PyArray1::from_iter(py, answers.iter().map(|a| a.t));
        let uv = PyArray1::from_iter(py, answers.iter().flat_map(|a| [a.u, a.v]));
        Ok((t, uv.reshape([answers.len(), 2])?))
    }
}
