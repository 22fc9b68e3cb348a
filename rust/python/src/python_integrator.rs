//! Integrators written in Python.

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, PoisonError};

use super::arrays::vectors;
use raywright::integrators::{CameraSample, Integrator, Job, Session, Worker};
use raywright::math::DVec3;
use raywright::optics::Rgb;
use raywright::workers::Cancel;

/// `raywright.integrators.Integrator`. An exception that it raises ends the render.
pub struct Written {
    integrator: Py<PyAny>,
    /// `raywright.Scene`.
    scene: Py<PyAny>,
    seed: u64,
    raised: Mutex<Option<PyErr>>,
}

impl Written {
    /// Creates one for this scene.
    pub fn new(integrator: Py<PyAny>, scene: Py<PyAny>, seed: u64) -> Self {
        Self { integrator, scene, seed, raised: Mutex::new(None) }
    }

    /// Takes the exception that it has raised.
    pub fn raised(&self) -> Option<PyErr> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn ask(&self, py: Python<'_>, samples: &[CameraSample], radiance: &mut [Rgb]) -> PyResult<()> {
        let query = py.import("raywright.query.interactions")?;
        let random = py.import("raywright.integrators.rng")?;
        let vectors_of = |of: fn(&CameraSample) -> DVec3| {
            let rows: Vec<f64> = samples.iter().flat_map(|s| of(s).to_array()).collect();
            PyArray1::from_vec(py, rows).reshape([samples.len(), 3])
        };
        let time = PyArray1::from_iter(py, samples.iter().map(|s| s.ray.time));
        let rays =
            query.getattr("Rays")?.call1((vectors_of(|s| s.ray.origin)?, vectors_of(|s| s.ray.direction)?, time))?;
        let pixel = PyArray1::from_iter(py, samples.iter().map(|s| s.sampler.pixel()));
        let sample = PyArray1::from_iter(py, samples.iter().map(|s| s.sampler.number()));
        let rng = random.getattr("Rng")?.call1((self.seed, pixel, sample))?;
        let given = self.integrator.bind(py).call_method1("radiance", (self.scene.bind(py), rays, rng))?;
        let named = [("dtype", "float64"), ("order", "C")];
        let options = PyDict::new(py);
        for (name, value) in named {
            options.set_item(name, value)?;
        }
        let array = py.import("numpy")?.getattr("asarray")?.call((given.clone(),), Some(&options))?;
        let shape: Vec<usize> = array.getattr("shape")?.extract()?;
        if shape != [samples.len(), 3] {
            let kind = self.integrator.bind(py).get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "{kind}.radiance must return an array of shape ({}, 3), got {} of shape {shape:?}",
                samples.len(),
                given.get_type().name()?
            )));
        }
        let array: PyReadonlyArrayDyn<'_, f64> = array.extract()?;
        for (to, row) in radiance.iter_mut().zip(vectors::<f64, 3>("radiance", &array)?) {
            *to = Rgb::from_array(*row);
        }
        Ok(())
    }
}

impl Integrator for Written {
    fn begin<'a>(&'a self, _job: Job<'a>, _cancel: &Cancel) -> Box<dyn Session + 'a> {
        Box::new(At(self))
    }

    /// Such an integrator gets red, green and blue, and the index of refraction for yellow light.
    fn takes_waves(&self) -> bool {
        true
    }

    fn runs_on_caller(&self) -> bool {
        true
    }
}

#[derive(Clone, Copy)]
struct At<'a>(&'a Written);

impl Session for At<'_> {
    fn worker(&self) -> Box<dyn Worker + '_> {
        Box::new(*self)
    }
}

impl Worker for At<'_> {
    fn radiance(&mut self, samples: &mut [CameraSample], cancel: &Cancel, radiance: &mut [Rgb]) {
        if cancel.is_raised() {
            return;
        }
        if let Err(error) = Python::attach(|py| self.0.ask(py, samples, radiance)) {
            self.0.raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            cancel.raise();
        }
    }
}
