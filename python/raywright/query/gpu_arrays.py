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

    The arrays are read-only, little-endian and without gaps, so that their bytes can go to a graphics
    processor as they are. All lengths are in box units: a point p of the scene is at ``(p - centre) * scale``
    there, between -2 and 2.

    Attributes
    ----------
    nodes : (K,) structured, 32 bytes each
        The tree, each node before all that is below it. Its fields, at these bytes:

        - ``lower``, 0 to 11: three float32, the least corner of the box, rounded down;
        - ``index``, 12 to 15: uint32, of a leaf the first of its entries in `triangles`, of an inner node the
          number of the node that comes after all below it, which of the last is `own`;
        - ``upper``, 16 to 27: three float32, the greatest corner of the box, rounded up;
        - ``count``, 28 to 31: uint32, how many entries a leaf has, 0 for an inner node.

        The first child of an inner node i is i + 1, and the second is the node after all that is below the
        first: i + 2 if that is a leaf, and its ``index`` if not. A walk needs no stack: from a node whose box
        is hit it goes on to i + 1, from another to i + 1 if it is a leaf and to its ``index`` if not, and it
        ends at `own`.
    triangles : (M,) structured, 48 bytes each
        Entries of the leaves, leaf after leaf; a split face may have several entries. Its fields:

        - ``corner``, 0 to 11: three float32, the corner from which the shortest edge goes, as it is wound;
        - ``primitive``, 12 to 15: uint32, the number among all primitives of the scene; see `first`;
        - ``edge``, 16 to 27: three float32, from there to the next corner;
        - ``largest``, 28 to 31: float32, the largest coordinate of both edges, in magnitude;
        - ``other``, 32 to 43: three float32, from there to the one before;
        - ``instance``, 44 to 47: uint32, of a copy of an `Instance` one more than its place in `instances`,
          of anything else 0.

        Differences are taken in float64 and rounded once. A primitive that is no triangle, a sphere or a
        copy, has a ``largest`` of -1, and its box from ``corner`` to ``edge``.
    instances : (I,) structured, 64 bytes each
        Copies that stand still. The shapes that are copied have a tree of their own behind the scene's, in
        the same arrays, in box units and with primitive numbers of their own. Their fields:

        - ``matrix``, 0 to 47: (3, 4) float32, by rows, from the box units around the copy to those inside: a
          ray is at ``matrix[:, :3] @ o + matrix[:, 3]`` there and goes along ``matrix[:, :3] @ d``, with the
          same t;
        - ``node``, 48 to 51: uint32, the root of the tree inside;
        - ``end``, 52 to 55: uint32, the node after the last of that tree, where a walk of it ends;
        - ``primitive``, 56 to 59: uint32, the copy's own number;
        - ``reserved``, 60 to 63: uint32, 0.
    own : int
        Number of `nodes` of the scene's own tree: a walk of it ends there.
    unbounded : (U,) uint32
        Infinite primitives, as a `Plane`: they are in no leaf.
    first : (S + 1,) int64
        The number of the first primitive of each of the scene's shapes, and how many there are in all.
    center : (3,) float64
        The middle of box units, in the scene's own.
    scale : float
        Factor from the scene's units to box units: a power of two.
    depth : int
        The longest way from the root to a leaf, in steps: a stack needs so many entries.

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
