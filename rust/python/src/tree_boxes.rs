//! Boxes of a scene's tree, as arrays.

use numpy::{PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;

use super::arrays::{sealed, unwritten};
use super::query::CompiledScene;

/// Depth (K,), primitives (K,) and corners (K,24) of all boxes.
type BoxArrays<'py> = (Bound<'py, PyArrayDyn<i32>>, Bound<'py, PyArrayDyn<i32>>, Bound<'py, PyArrayDyn<f64>>);

/// Boxes of all nodes of the scene's accelerator, from the root down; inner nodes have −1 primitives. `None` if it has
/// no boxes.
#[pyfunction]
pub fn tree_boxes<'py>(py: Python<'py>, scene: &Bound<'py, CompiledScene>) -> PyResult<Option<BoxArrays<'py>>> {
    let scene = scene.get().scene();
    let Some(trees) = py.detach(|| scene.accelerator().boxes()) else { return Ok(None) };
    let mut all: Vec<_> = trees.iter().flat_map(|tree| tree.nodes.iter().map(move |node| (node, tree))).collect();
    all.sort_by_key(|(node, _)| node.depth);
    let count = all.len();
    let (depth, primitives) = (unwritten(py, &[count], None)?, unwritten(py, &[count], None)?);
    let corners = unwritten(py, &[count], Some(24))?;
    {
        let (mut depth, mut primitives, mut corners) = (depth.readwrite(), primitives.readwrite(), corners.readwrite());
        let rows = corners.as_slice_mut()?.as_chunks_mut::<24>().0;
        let places = depth.as_slice_mut()?.iter_mut().zip(primitives.as_slice_mut()?).zip(rows);
        for (((depth, primitives), row), (node, tree)) in places.zip(all) {
            *depth = node.depth as i32;
            *primitives = node.primitives.map_or(-1, |count| count as i32);
            *row = std::array::from_fn(|i| tree.corners(&node.aabb)[i / 3][i % 3]);
        }
    }
    Ok(Some((sealed(depth)?, sealed(primitives)?, sealed(corners)?)))
}
