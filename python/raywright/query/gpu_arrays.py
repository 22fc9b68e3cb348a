"""A scene's tree and triangles as arrays without pointers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._core import FlatScene
from ..arrays import sealed

NODE = np.dtype([("lower", "<f4", 3), ("index", "<u4"), ("upper", "<f4", 3), ("count", "<u4")])
TRIANGLE = np.dtype(
    [
        ("corner", "<f4", 3),
        ("primitive", "<u4"),
        ("edge", "<f4", 3),
        ("largest", "<f4"),
        ("other", "<f4", 3),
        ("instance", "<u4"),
    ]
)
INSTANCE = np.dtype(
    [
        ("matrix", "<f4", (3, 4)),
        ("node", "<u4"),
        ("end", "<u4"),
        ("primitive", "<u4"),
        ("reserved", "<u4"),
    ]
)


@dataclass(frozen=True, eq=False, repr=False)
class GpuArrays:
    """A scene's binary tree and its triangles as arrays without pointers: `Scene.gpu_arrays` makes it.

    The arrays are read-only, little-endian and without gaps, so a graphics processor can use their bytes
    directly. All lengths are in box units: a point p of the scene has the coordinates ``(p - center) *
    scale``, between -2 and 2.

    Attributes
    ----------
    nodes : (K,) structured, 32 bytes each
        The tree in depth-first order. Fields and bytes:

        - ``lower``, 0 to 11: three float32, the least corner of the box, rounded down;
        - ``index``, 12 to 15: uint32; for a leaf, the index of its first entry in `triangles`; for an inner
          node, the index of the first node after its subtree, which may be `own`;
        - ``upper``, 16 to 27: three float32, the greatest corner of the box, rounded up;
        - ``count``, 28 to 31: uint32, the number of entries of a leaf, 0 for an inner node.

        The first child of an inner node i is i + 1. The second child is the node after the subtree of the
        first: i + 2 if that is a leaf, otherwise its ``index``. Traversal needs no stack: after a node whose
        box is hit comes i + 1, after a missed leaf i + 1, and after a missed inner node its ``index``; it
        ends at `own`.
    triangles : (M,) structured, 48 bytes each
        Entries of the leaves, leaf after leaf; a split face may have several entries. Its fields:

        - ``corner``, 0 to 11: three float32, the corner at which the shortest edge starts, in winding order;
        - ``primitive``, 12 to 15: uint32, the number among all primitives of the scene; see `first`;
        - ``edge``, 16 to 27: three float32, from `corner` to the next corner;
        - ``largest``, 28 to 31: float32, the largest coordinate of both edges, in magnitude;
        - ``other``, 32 to 43: three float32, from `corner` to the previous corner;
        - ``instance``, 44 to 47: uint32, one plus the index in `instances` for a copy of an `Instance`, 0
          otherwise.

        Differences are computed in float64 and rounded once. A primitive other than a triangle, such as a
        sphere or a copy, has a ``largest`` of -1, and its box from ``corner`` to ``edge``.
    instances : (I,) structured, 64 bytes each
        Static copies. The copied shapes have their own tree after the scene's, in the same arrays, with their
        own box units and primitive numbers. Fields:

        - ``matrix``, 0 to 47: (3, 4) float32, by rows, from the box units around the copy to those inside: a
          ray is at ``matrix[:, :3] @ o + matrix[:, 3]`` there and goes along ``matrix[:, :3] @ d``, with the
          same t;
        - ``node``, 48 to 51: uint32, the root of the tree inside;
        - ``end``, 52 to 55: uint32, the first node after that tree, where its traversal ends;
        - ``primitive``, 56 to 59: uint32, the copy's own number;
        - ``reserved``, 60 to 63: uint32, 0.
    own : int
        Number of nodes of the scene's own tree, where its traversal ends.
    unbounded : (U,) uint32
        Infinite primitives, such as a `Plane`, which are in no leaf.
    first : (S + 1,) int64
        Index of the first primitive of each of the scene's shapes, and the number of all primitives.
    center : (3,) float64
        Origin of the box units, in the scene's coordinates.
    scale : float
        Factor from the scene's units to box units: a power of two.
    depth : int
        Depth of the tree: the number of entries that a stack needs.

    See Also
    --------
    Scene.gpu_arrays : Makes it.

    Examples
    --------
    >>> flat = rw.Scene(rw.Sphere((4, 0, 0), radius=1)).gpu_arrays()
    >>> flat.own, flat.center.tolist(), flat.scale
    (1, [4.0, 0.0, 0.0], 1.0)
    >>> flat.bytes
    80
    """

    nodes: NDArray[np.void]
    triangles: NDArray[np.void]
    instances: NDArray[np.void]
    own: int
    unbounded: NDArray[np.uint32]
    first: NDArray[np.int64]
    center: NDArray[np.float64]
    scale: float
    depth: int

    @property
    def bytes(self) -> int:
        """Bytes of nodes, triangles and instances."""
        return self.nodes.nbytes + self.triangles.nbytes + self.instances.nbytes

    def __repr__(self) -> str:
        return f"GpuArrays({len(self.nodes)} nodes, {len(self.triangles)} triangles, depth {self.depth})"


def flat_arrays(flat: FlatScene) -> GpuArrays:
    """Return the arrays of a scene that the core has laid out flat."""
    kinds = ((flat.nodes, NODE), (flat.triangles, TRIANGLE), (flat.instances, INSTANCE))
    nodes, triangles, instances = (
        sealed(np.ascontiguousarray(rows).view(kind).reshape(-1)) for rows, kind in kinds
    )
    first = sealed(np.asarray(flat.first, np.int64))
    unbounded, center = sealed(flat.unbounded), sealed(flat.centre)
    own = flat.own[0]
    return GpuArrays(nodes, triangles, instances, own, unbounded, first, center, flat.scale, flat.depth)
