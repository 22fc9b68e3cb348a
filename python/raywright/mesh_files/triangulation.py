"""Polygons of mesh files as triangles."""

from __future__ import annotations

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
    counts = np.ascontiguousarray(counts, np.int64)
    if (counts == 3).all():
        return np.arange(3 * len(counts), dtype=np.int64).reshape(-1, 3)
    whole = np.ascontiguousarray(points, np.float64)
    return triangulate_polygons(whole, np.ascontiguousarray(corners, np.int64), counts)


def polygon_of(counts: Integers) -> Integers:
    """Return the number of the polygon of each triangle of `triangulate`, (T,)."""
    triangles = np.maximum(np.asarray(counts, np.int64) - 2, 0)
    # Repeating all by one number takes a fraction of the time.
    is_even = len(triangles) > 0 and bool((triangles == triangles[0]).all())
    return np.repeat(np.arange(len(triangles)), int(triangles[0]) if is_even else triangles)
