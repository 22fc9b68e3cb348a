//! Work that Ctrl-C ends.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use raywright::workers::{Cancel, watched};

/// Does work on the pool of so many threads without the interpreter, while signals are heard: what one of them raises
/// ends it.
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
