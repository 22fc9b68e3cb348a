//! Progress observers in Python, and interruption of renders.

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::time::Instant;

use super::python_integrator::Written;
use raywright::render::{HistoryRow, Malformed, Progress, RenderError};

/// Converts an error about bytes for Python.
pub(super) fn malformed(why: Malformed) -> PyErr {
    PyValueError::new_err(why.to_string())
}

/// Forwards the progress of a render to a Python function, and handles signals and other interruptions.
pub(super) struct Watcher<'a> {
    pub progress: Option<Py<PyAny>>,
    pub look: Option<Py<PyAny>>,
    /// Result of the last `look`: whether to pause the render after the pass.
    pub rests: bool,
    pub raised: Option<PyErr>,
    /// When to pause the render.
    pub pause: Option<Instant>,
    pub written: Option<&'a Written>,
}

impl Watcher<'_> {
    /// Converts the reason why the render ended for Python.
    pub fn error(&mut self, error: RenderError) -> PyErr {
        let raised = self.raised.take().or_else(|| self.written.and_then(Written::raised));
        raised.unwrap_or_else(|| match error {
            RenderError::Unsuited(why) => PyValueError::new_err(why),
            error => PyRuntimeError::new_err(error.to_string()),
        })
    }

    /// Continues unless an exception is raised, which is kept.
    fn unless_raised(&mut self, then: impl FnOnce(Python<'_>, Option<&Py<PyAny>>) -> PyResult<()>) -> ControlFlow<()> {
        let ask = |py: Python<'_>| {
            py.check_signals()?;
            let rests = match &self.look {
                Some(look) => look.call0(py)?.is_truthy(py)?,
                None => false,
            };
            then(py, self.progress.as_ref())?;
            Ok(rests)
        };
        let raised = self.written.and_then(Written::raised);
        match raised.map_or_else(|| Python::attach(ask), Err) {
            Ok(rests) => {
                self.rests = rests;
                ControlFlow::Continue(())
            }
            Err(raised) => {
                self.raised = Some(raised);
                ControlFlow::Break(())
            }
        }
    }
}

impl Progress for Watcher<'_> {
    fn pass(&mut self, row: &HistoryRow, trusted: bool) -> ControlFlow<()> {
        let HistoryRow { seconds, samples, error } = *row;
        self.unless_raised(|py, progress| {
            if let Some(progress) = progress {
                progress.call1(py, (seconds, samples, error, trusted))?;
            }
            Ok(())
        })
    }

    fn poll(&mut self) -> ControlFlow<()> {
        self.unless_raised(|_, _| Ok(()))
    }

    fn pauses(&mut self) -> bool {
        self.pause.is_some_and(|pause| Instant::now() >= pause)
    }

    fn rests(&mut self) -> bool {
        self.rests || self.pauses()
    }
}
