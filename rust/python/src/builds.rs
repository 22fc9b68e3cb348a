//! Builds as Python sees them: with the interpreter detached, signals heard, and told how far they are.

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use raywright::scene::{self, DescriptionError, Surface};
use raywright::work::{Watch, Work};
use raywright::workers;

/// What is built for one scene: it, and before it prototypes that it needs and nobody has yet.
pub struct Builds {
    /// Called with the share of all that is done.
    progress: Option<Py<PyAny>>,
    /// How much there is to build in all.
    whole: usize,
    state: Mutex<State>,
}

struct State {
    /// How much is built.
    done: usize,
    /// When it was told last how far it is.
    told: Instant,
}

/// How much there is to build over shapes, prototypes in them aside.
pub fn size(shapes: &[scene::Shape]) -> usize {
    let of = |shape: &scene::Shape| match &shape.surface {
        Surface::Mesh(mesh) => mesh.faces.len(),
        Surface::Instances(instances) => instances.count(),
        Surface::Shape(_) => 1,
    };
    shapes.iter().map(of).sum()
}

impl Builds {
    /// Nobody is told more often.
    const TELLS: Duration = Duration::from_millis(100);

    /// Of so much in all. What `progress` raises ends them.
    pub fn new(progress: Option<Py<PyAny>>, whole: usize) -> Self {
        Self { progress, whole: whole.max(1), state: Mutex::new(State { done: 0, told: Instant::now() }) }
    }

    /// Makes something of this size. When a signal raises an exception, nobody waits for it any longer.
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
        let made = made.ok_or_else(|| PyRuntimeError::new_err("a build was left, and no signal raised"))?;
        self.state.lock().unwrap_or_else(PoisonError::into_inner).done += size;
        made.map_err(|e| PyValueError::new_err(e.to_string()))
    }

    /// Hears signals, and now and then tells how far it is.
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
