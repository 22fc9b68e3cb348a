//! Progressive radiosity, as arrays.

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{numbers, rows};
use super::query::CompiledScene;
use super::signals::heard;
use raywright::exchange::{Enclosure, Shots, Sides};
use raywright::optics::Rgb;
use raywright::parallel;
use raywright::scene::Patches;

/// Patches of a scene, and the replicates of a solution.
#[pyclass(module = "raywright._core")]
pub struct RadiosityShots {
    scene: Py<CompiledScene>,
    /// A scene with only the lights that are not surfaces.
    lamps: Option<Py<CompiledScene>>,
    enclosure: Enclosure,
    seed: u64,
    replicates: Vec<Shots>,
}

fn colours(name: &str, array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Rgb>> {
    Ok(rows::<f64, 3>(name, array)?.iter().map(|row| Rgb::from_array(*row)).collect())
}

#[pymethods]
impl RadiosityShots {
    /// `cuts` (F,) gives the number of strips of each primitive; `looks`, emission and reflectance by side, override
    /// the scene's.
    #[new]
    #[pyo3(signature = (scene, lamps, cuts, both, looks=None, threads=None))]
    fn new(
        py: Python<'_>,
        scene: Py<CompiledScene>,
        lamps: Option<Py<CompiledScene>>,
        cuts: PyReadonlyArray1<'_, u32>,
        both: bool,
        looks: Option<(PyReadonlyArray2<'_, f64>, PyReadonlyArray2<'_, f64>)>,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let patches = Patches::new(numbers("cuts", &cuts)?.to_vec()).map_err(PyValueError::new_err)?;
        let sides = if both { Sides::Both } else { Sides::Front };
        let compiled = &scene.get().0;
        let enclosure = heard(py, threads, |_| Enclosure::new(compiled, patches, sides))?;
        let enclosure = enclosure.map_err(PyValueError::new_err)?;
        let enclosure = match looks {
            None => enclosure,
            Some((emission, reflectance)) => enclosure
                .with(colours("emission", &emission)?, colours("reflectance", &reflectance)?)
                .map_err(PyValueError::new_err)?,
        };
        Ok(Self { scene, lamps, enclosure, seed: 0, replicates: Vec::new() })
    }

    /// Restarts this number of replicates, and traces rays for the lights that are not surfaces.
    fn begin(
        &mut self,
        py: Python<'_>,
        seed: u64,
        replicates: u32,
        light_rays: u64,
        threads: Option<usize>,
    ) -> PyResult<()> {
        self.seed = seed;
        let (scene, enclosure) = (&self.scene.get().0, &self.enclosure);
        let lamps = self.lamps.as_ref().map(|lamps| (&lamps.get().0, light_rays));
        self.replicates = heard(py, threads, |cancel| {
            let one = |replicate| Shots::new(scene, lamps, enclosure, (seed, replicate as u32), cancel);
            parallel::map(replicates as usize, one)
        })?;
        Ok(())
    }

    /// Shoots all unshot power; `rays` is the number per replicate if all power were unshot.
    fn shoot_all(&mut self, py: Python<'_>, rays: u64, threads: Option<usize>) -> PyResult<()> {
        let (scene, enclosure, seed) = (&self.scene.get().0, &self.enclosure, self.seed);
        let replicates = &mut self.replicates;
        heard(py, threads, |cancel| {
            parallel::each_mut(replicates, &|_, one| one.shoot_all(scene, enclosure, rays, seed, cancel));
        })
    }

    /// Shoots this number of sides of patches, each time the one with the most unshot power.
    fn shoot_greatest(&mut self, py: Python<'_>, count: u32, rays: u64, threads: Option<usize>) -> PyResult<()> {
        let (scene, enclosure, seed) = (&self.scene.get().0, &self.enclosure, self.seed);
        let replicates = &mut self.replicates;
        heard(py, threads, |cancel| {
            parallel::each_mut(replicates, &|_, one| one.shoot_greatest(scene, enclosure, (count, rays), seed, cancel));
        })
    }

    /// Area of each patch, (P,), m².
    #[getter]
    fn areas<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.enclosure.areas())
    }

    /// Emitted radiosity of each side, (S,3), W/m².
    #[getter]
    fn emission<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.enclosure.emission())
    }

    /// Reflectance of each side, (S,3).
    #[getter]
    fn reflectance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.enclosure.reflectance())
    }

    /// Corners of each patch, (P,3,3); NaN if it is not a triangle.
    #[getter]
    fn corners<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let (geometry, patches) = (self.scene.get().0.geometry(), self.enclosure.patches());
        let corners = (0..patches.count() as u32).flat_map(|patch| {
            let cell = patches.cell(patch);
            let is_triangle = geometry.shape(cell.primitive).is_none();
            let at =
                move |uv| if is_triangle { geometry.position(cell.primitive, uv).to_array() } else { [f64::NAN; 3] };
            cell.corners.into_iter().flat_map(at)
        });
        PyArray1::from_vec(py, corners.collect()).reshape([patches.count(), 3, 3])
    }

    /// Incident power of each side, (R,S,3), W.
    #[getter]
    fn arrived<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let all = self.replicates.iter().flat_map(|one| one.arrived().iter().flat_map(|power| power.to_array()));
        PyArray1::from_vec(py, all.collect()).reshape([self.replicates.len(), self.enclosure.sources(), 3])
    }

    /// Unshot power of each side, (R,S,3), W.
    #[getter]
    fn unshot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let all = self.replicates.iter().flat_map(|one| one.unshot().iter().flat_map(|power| power.to_array()));
        PyArray1::from_vec(py, all.collect()).reshape([self.replicates.len(), self.enclosure.sources(), 3])
    }

    /// Energy balance: emitted, unshot, escaped, and absorbed by black sides, (R,4,3), W.
    #[getter]
    fn books<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let all = self.replicates.iter().flat_map(|one| {
            let unshot: Rgb = one.unshot().iter().copied().sum();
            let (escaped, behind) = one.lost();
            [one.emitted(), unshot, escaped, behind].into_iter().flat_map(Rgb::to_array)
        });
        PyArray1::from_vec(py, all.collect()).reshape([self.replicates.len(), 4, 3])
    }

    /// Number of rays of all replicates.
    #[getter]
    fn rays(&self) -> u64 {
        self.replicates.iter().map(Shots::rays).sum()
    }
}

fn table<'py>(py: Python<'py>, rows: &[Rgb]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    PyArray1::from_iter(py, rows.iter().flat_map(|row| row.to_array())).reshape([rows.len(), 3])
}
