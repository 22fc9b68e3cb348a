//! Statistics of an accelerator.

use pyo3::prelude::*;

use raywright::accel::Info;

/// Statistics of the compiled accelerator.
#[pyclass(frozen, module = "raywright._core")]
pub struct AcceleratorInfo(pub Info);

#[pymethods]
impl AcceleratorInfo {
    #[getter]
    fn kind(&self) -> &str {
        &self.0.kind
    }
    #[getter]
    fn precision(&self) -> &'static str {
        self.0.precision
    }
    #[getter]
    fn primitives(&self) -> usize {
        self.0.primitives
    }
    #[getter]
    fn nodes(&self) -> usize {
        self.0.nodes
    }
    #[getter]
    fn leaves(&self) -> usize {
        self.0.leaves
    }
    #[getter]
    fn depth(&self) -> usize {
        self.0.depth
    }
    #[getter]
    fn bytes(&self) -> usize {
        self.0.bytes
    }
    #[getter]
    fn build_seconds(&self) -> f64 {
        self.0.build_seconds
    }
    #[getter]
    fn sah_cost(&self) -> f64 {
        self.0.sah_cost
    }
    fn __repr__(&self) -> String {
        let Info { kind, primitives, nodes, leaves, depth, bytes, build_seconds, sah_cost, .. } = &self.0;
        format!(
            "AcceleratorInfo(kind={kind:?}, primitives={primitives}, nodes={nodes}, leaves={leaves}, depth={depth}, \
             bytes={bytes}, build_seconds={build_seconds:.4}, sah_cost={sah_cost:.2})"
        )
    }
}
