"""Polygons of mesh files as triangles."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import triangulate_polygons

Integers = NDArray[np.int64]


def triangulate(points: NDArray[np.floating[Any]], corners: Integers, counts: Integers) -> Integers:
    """Return the triangles of polygons as (T, 3) positions in `corners`, in the order of the polygons.

    A polygon of n corners yields n - 2 triangles, and one with fewer than three yields none. It becomes a fan
    from its first corner if all triangles of the fan turn the way the polygon does, as those of convex ones
    do. Any other is triangulated by ear clipping with exact decisions: a simple polygon in a plane is covered
    exactly once, so it keeps its area. Holes may be connected to the outline by edges that are passed twice.

    Parameters
    ----------
    points : (V, 3) array
        Vertices.
    corners : (C,) int array
        Vertices of all polygons, one polygon after the other. Each must be the index of a point.
    counts : (P,) int array
        Number of corners of each polygon; their sum is C.

    Returns
    -------
    (T, 3) int64 array
        Positions in `corners`: ``corners[triangles]`` are the faces, and values given for each corner are
        taken by the same positions. `polygon_of` tells whose they are.
    """
    counts = np.asarray(counts, np.int64)
    if (counts == 3).all():
        return np.arange(3 * len(counts), dtype=np.int64).reshape(-1, 3)
    triangles = _fans(counts)
    many = counts > 3
    # Triangles of polygons with more than three corners, and where those of each polygon begin.
    chosen = triangles if many.all() else triangles[np.repeat(many, np.maximum(counts - 2, 0))]
    pieces = counts[many] - 2
    if not len(chosen):
        return triangles
    other = ~_turn_alike(np.asarray(points, np.float64), corners, chosen, pieces)
    if not other.any():
        return triangles
    clipped = np.flatnonzero(many)[other]
    starts = np.cumsum(counts) - counts
    positions = _ranges(starts[clipped], counts[clipped])
    own = np.ascontiguousarray(points[corners[positions]], np.float64)
    found = positions[triangulate_polygons(own, counts[clipped])]
    places = np.cumsum(np.maximum(counts - 2, 0)) - np.maximum(counts - 2, 0)
    triangles[_ranges(places[clipped], counts[clipped] - 2)] = found
    return triangles


def polygon_of(counts: Integers) -> Integers:
    """Return the number of the polygon of each triangle of `triangulate`, (T,)."""
    return np.repeat(np.arange(len(counts)), np.maximum(np.asarray(counts, np.int64) - 2, 0))


def _fans(counts: Integers) -> Integers:
    """Return the triangles from the first corner of each polygon."""
    pieces = np.maximum(counts - 2, 0)
    first = np.repeat(np.cumsum(counts) - counts, pieces)
    second = first + _ranges(np.ones_like(pieces), pieces)
    return np.stack([first, second, second + 1], axis=1)


def _ranges(starts: Integers, counts: Integers) -> Integers:
    """Return so many consecutive numbers from each start on."""
    offsets = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.repeat(starts, counts) + offsets


def _turn_alike(
    points: NDArray[np.float64], corners: Integers, triangles: Integers, pieces: Integers
) -> NDArray[np.bool_]:
    """Return of each polygon whether all its triangles turn the way their sum does, (P,).

    The sum of the normals of a fan, each as long as twice the area of its triangle, is the polygon's (Newell).
    """
    a, b, c = (points[corners[triangles[:, k]]] for k in range(3))
    with np.errstate(all="ignore"):
        normals = np.cross(b - a, c - a)
        begins = np.cumsum(pieces) - pieces
        total = np.repeat(np.add.reduceat(normals, begins, axis=0), pieces, axis=0)
        alike = np.einsum("ij,ij->i", normals, total) > 0
    return np.logical_and.reduceat(alike, begins)
