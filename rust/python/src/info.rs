//! Statistics of built accelerators, for people to read.

use pyo3::prelude::*;

use raywright::accel::Info;

/// Statistics of a built accelerator: `Scene.accelerator_info` returns it.
///
/// Attributes
/// ----------
/// kind : str
///     The structure, and how it was built.
/// precision : {"single", "double"}
///     Precision of the triangles' corners in its leaves.
/// primitives, nodes, leaves : int
///     Number of primitives that can be hit, of inner nodes, and of leaves.
/// depth : int
///     Steps from the root to the deepest leaf; 0 if the root is a leaf.
/// bytes : int
///     Memory held.
/// build_seconds : float
///     Wall-clock time of the build.
/// sah_cost : float
///     Expected cost of a random ray that meets the root's box, by the surface area heuristic (Goldsmith and Salmon
///     1987), in tests of a node or of a block of triangles.
///
/// See Also
/// --------
/// report.accelerators : Compare accelerators on the same rays.
///
/// Examples
/// --------
/// >>> info = rw.Scene(rw.Sphere()).accelerator_info
/// >>> info.primitives, info.kind.startswith("BVH")
/// (1, True)
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
