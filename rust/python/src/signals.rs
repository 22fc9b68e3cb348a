//! Interruptible work (Ctrl-C).

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use raywright::workers::{Cancel, watched};

/// Runs work on the pool with this number of threads, without the interpreter lock and with signal handling; an
/// exception from a signal handler ends it.
pub fn heard<T: Send>(py: Python<'_>, threads: Option<usize>, work: impl FnOnce(&Cancel) -> T + Send) -> PyResult<T> {
    let mut raised = None;
    let done = py.detach(|| {
        watched(threads, work, || {
            raised = Python::attach(|py| py.check_signals()).err();
            raised.is_none()
        })
    });
    raised.map_or_else(|| done.map_err(PyRuntimeError::new_err), Err)
}
