"""Queries of what a scene is compiled to: its accelerator, its size, its extent."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..accelerators import Accelerator
from .compilable import Compilable
from .gpu_arrays import GpuArrays, flat_arrays
from .trees import TreeBoxes


class StructureQueries(Compilable):
    """Queries of the compiled scene itself; the first one compiles it."""

    _accelerator: Accelerator
    _quality: Literal["low", "medium", "high"]

    @property
    def accelerator_info(self) -> _core.AcceleratorInfo:
        """Statistics of the built accelerator: kind, nodes, leaves, depth, bytes, build_seconds, sah_cost.

        Its `precision` is that of the vertices that it holds, "single" or "double"; instances have their own.
        """
        return self._compiled().accelerator

    @property
    def bytes(self) -> int:
        """Memory of the compiled scene in bytes: accelerators, faces, vertices with attributes, transforms.

        Textures are not included.
        """
        return self._compiled().bytes

    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """Least and greatest corner of the shapes, (2, 3) float64; None for an empty scene.

        Infinite shapes, such as a `Plane`, do not count.
        """
        return self._compiled().bounds

    def tree_boxes(self) -> TreeBoxes:
        """Return the boxes of the accelerator's nodes, from the root down.

        Returns
        -------
        TreeBoxes
            All nodes, each level after the one above.

        Raises
        ------
        ValueError
            If the accelerator has no boxes: grids, BSP trees and `BruteForce` have none.

        See Also
        --------
        report.tree : Plot the boxes of a tree.
        Scene.gpu_arrays : The tree as arrays for graphics processors.

        Examples
        --------
        >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
        >>> boxes = scene.tree_boxes()
        >>> boxes.depth[:3].tolist(), boxes.corners.shape[1:]
        ([0, 1, 1], (8, 3))
        >>> int(boxes.primitives[boxes.leaf].sum()) >= 40 * 8 * 2
        True
        """
        boxes = _core.tree_boxes(self._compiled())
        if boxes is None:
            kind = type(self._accelerator).__name__
            raise ValueError(f"a {kind} has no tree of boxes: use BVH, KdTree or Octree")
        depth, primitives, corners = boxes
        return TreeBoxes(depth, primitives, corners.reshape(-1, 8, 3))

    def gpu_arrays(self) -> GpuArrays:
        """Return the scene as arrays without pointers, for graphics processors.

        A binary tree is built for it: with the options of the accelerator if that is a `BVH`, with the
        default options otherwise. A later `refit` does not change the arrays.

        Returns
        -------
        GpuArrays
            Nodes of 32 bytes, triangles of 48, and where they are.

        See Also
        --------
        Scene.tree_boxes : The boxes of the accelerator.
        Scene.on_device : Hold the scene on a graphics processor.

        Examples
        --------
        >>> flat = rw.Scene(rw.scenes.torus_knot(along=40, around=8)).gpu_arrays()
        >>> len(flat.triangles), flat.nodes.dtype.itemsize
        (640, 32)
        """
        return flat_arrays(_core.FlatScene(self._compiled(), self._accelerator, self._quality, True))
