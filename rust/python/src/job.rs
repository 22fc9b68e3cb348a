//! Render jobs of the Python package.

use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::cameras::AnyCamera;
use super::integrators::AnyIntegrator;
use super::python_integrator::Written;
use super::query::CompiledScene;
use super::samplers;
use super::watcher::{Watcher, malformed};
use raywright::integrators::{Integrator, Transparent};
use raywright::render::{Request, Settings, Until};
use raywright::scene::Camera;

/// Everything that determines a picture except the scene, which is compiled when needed: read once.
#[pyclass(module = "raywright._core", frozen)]
pub struct Job {
    camera: AnyCamera,
    integrator: ChosenIntegrator,
    settings: Settings,
    /// True if the background is transparent where the camera sees it directly.
    transparent: bool,
}

/// An integrator of the package, or one written in Python.
enum ChosenIntegrator {
    Own(Box<dyn Integrator>),
    Written { integrator: Py<PyAny>, described: Py<PyAny>, seed: u64 },
}

/// The integrator of a running job; exceptions of one written in Python belong to this run alone.
pub(super) enum Working<'a> {
    Own(&'a dyn Integrator),
    Written(Box<Written>),
}

impl Working<'_> {
    pub fn get(&self) -> &dyn Integrator {
        match self {
            Self::Own(own) => *own,
            Self::Written(written) => &**written,
        }
    }

    pub fn written(&self) -> Option<&Written> {
        if let Self::Written(written) = self { Some(written) } else { None }
    }
}

impl Job {
    /// The integrator, for one call.
    pub(super) fn integrator(&self, py: Python<'_>) -> Working<'_> {
        match &self.integrator {
            ChosenIntegrator::Own(own) => Working::Own(&**own),
            ChosenIntegrator::Written { integrator, described, seed } => {
                Working::Written(Box::new(Written::new(integrator.clone_ref(py), described.clone_ref(py), *seed)))
            }
        }
    }

    /// Settings with these stopping criteria and threads.
    pub(super) fn settings(&self, until: Until, threads: Option<usize>) -> Settings {
        Settings { until, threads, ..self.settings.clone() }
    }

    /// Runs `work` with the integrator, wrapped for a transparent background if requested.
    pub(super) fn showing<T>(&self, integrator: &dyn Integrator, work: impl FnOnce(&dyn Integrator) -> T) -> T {
        if self.transparent { work(&Transparent(integrator)) } else { work(integrator) }
    }

    pub(super) fn camera(&self) -> &dyn Camera {
        &*self.camera.0
    }
}

#[pymethods]
impl Job {
    /// `scene` is the Python description, for integrators written in Python.
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        scene: Py<PyAny>,
        camera: AnyCamera,
        integrator: &Bound<'_, PyAny>,
        seed: u64,
        adaptive: bool,
        clamp: Option<f64>,
        sampler: &Bound<'_, PyAny>,
        filter: &Bound<'_, PyAny>,
        transparent: bool,
        apart: bool,
    ) -> PyResult<Self> {
        let (sampler, filter) = (samplers::sampler(sampler)?, samplers::filter(filter)?.into());
        let base = integrator.py().import("raywright.integrators.base")?.getattr("Integrator")?;
        let integrator = if integrator.is_instance(&base)? {
            ChosenIntegrator::Written { integrator: integrator.clone().unbind(), described: scene, seed }
        } else {
            ChosenIntegrator::Own(integrator.extract::<AnyIntegrator>()?.0)
        };
        Ok(Self {
            camera,
            integrator,
            settings: Settings { seed, adaptive, apart, clamp, sampler, filter, ..Settings::default() },
            transparent,
        })
    }

    /// Side of the patches of pixels whose samples the integrator takes together.
    fn patch(&self, py: Python<'_>, scene: &Bound<'_, CompiledScene>) -> u32 {
        self.integrator(py).get().patch(&scene.get().0)
    }

    /// Takes the samples of a request of `Rendering.request`, and returns the bytes for `Rendering.take`.
    fn expose(
        &self,
        py: Python<'_>,
        scene: &Bound<'_, CompiledScene>,
        request: &[u8],
        threads: Option<usize>,
    ) -> PyResult<Py<PyBytes>> {
        let (integrator, settings) = (self.integrator(py), self.settings(Until::default(), threads));
        let mut watcher = Watcher {
            progress: None,
            look: None,
            rests: false,
            raised: None,
            pause: None,
            written: integrator.written(),
        };
        let (scene, camera) = (&scene.get().0, self.camera());
        let request = Request::from_bytes(request, camera.width(), camera.height()).map_err(malformed)?;
        let result = py.detach(|| {
            self.showing(integrator.get(), |shown| request.expose(scene, camera, shown, &settings, &mut watcher))
        });
        let answer = result.map_err(|error| watcher.error(error))?;
        Ok(PyBytes::new(py, &answer).unbind())
    }
}
