//! Builds without the interpreter lock, with signal handling and progress reports.

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use raywright::scene::{self, DescriptionError, Surface};
use raywright::work::{Watch, Work};
use raywright::workers;

/// The builds of one scene: the scene's, and before it those of prototypes that are not cached.
pub struct Builds {
    /// Called with the finished share of all builds.
    progress: Option<Py<PyAny>>,
    /// Total size of the builds.
    whole: usize,
    state: Mutex<State>,
}

struct State {
    /// Size of finished builds.
    done: usize,
    /// Time of the last progress report.
    told: Instant,
}

/// Size of a build over shapes, without prototypes.
pub fn size(shapes: &[scene::Shape]) -> usize {
    let of = |shape: &scene::Shape| match &shape.surface {
        Surface::Mesh(mesh) => mesh.faces.len(),
        Surface::Instances(instances) => instances.count(),
        Surface::Shape(_) => 1,
    };
    shapes.iter().map(of).sum()
}

impl Builds {
    /// Minimum interval between progress reports.
    const TELLS: Duration = Duration::from_millis(100);

    /// Creates builds of a total size. Exceptions raised by `progress` end them.
    pub fn new(progress: Option<Py<PyAny>>, whole: usize) -> Self {
        Self { progress, whole: whole.max(1), state: Mutex::new(State { done: 0, told: Instant::now() }) }
    }

    /// Runs a build of this size. If a signal handler raises an exception, the build is abandoned.
    pub fn build<T: Send + 'static>(
        &self,
        py: Python<'_>,
        size: usize,
        make: impl FnOnce(Work<'_>) -> Result<T, DescriptionError> + Send + 'static,
    ) -> PyResult<T> {
        let watch = Arc::new(Watch::default());
        let (watched, mut raised) = (Arc::clone(&watch), None);
        let look = || match Python::attach(|py| self.look(py, size, watched.share())) {
            Ok(()) => true,
            Err(error) => {
                watched.stop();
                raised = Some(error);
                false
            }
        };
        let work = move || make(Work::of(&watch));
        let made = py.detach(|| workers::unless_left(None, work, look)).map_err(PyRuntimeError::new_err)?;
        if let Some(error) = raised {
            return Err(error);
        }
        let made = made.ok_or_else(|| PyRuntimeError::new_err("a build was canceled without a signal"))?;
        self.state.lock().unwrap_or_else(PoisonError::into_inner).done += size;
        made.map_err(|e| PyValueError::new_err(e.to_string()))
    }

    /// Handles signals and reports progress now and then.
    fn look(&self, py: Python<'_>, size: usize, share: f32) -> PyResult<()> {
        py.check_signals()?;
        let Some(progress) = &self.progress else { return Ok(()) };
        let share = {
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            if state.told.elapsed() < Self::TELLS {
                return Ok(());
            }
            state.told = Instant::now();
            (state.done as f64 + f64::from(share) * size as f64) / self.whole as f64
        };
        progress.call1(py, (share.min(1.0),))?;
        Ok(())
    }
}
