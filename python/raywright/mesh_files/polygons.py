"""Meshes of polygons, whose values stay those of the polygons."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..io.quiet import warn_caller
from ..shapes.mesh import Mesh
from .triangulation import polygon_of, triangulate

Integers = NDArray[np.integer[Any]]


def mesh_of_polygons(
    points: NDArray[Any],
    corners: Integers,
    counts: ArrayLike,
    cells: Integers | None = None,
    polygon_data: Mapping[str, NDArray[Any]] | None = None,
    vertex_data: Mapping[str, NDArray[Any]] | None = None,
    **looks: Any,
) -> Mesh:
    """Return a mesh of polygons, triangulated as `triangulate` does.

    Parameters
    ----------
    points : (V, 3) array
    corners : (C,) int array
        Vertices of all polygons, one polygon after the other.
    counts : (P,) int array
        Number of corners of each polygon.
    cells : (P,) int array, optional
        The cell of each polygon; each is one if not given.
    polygon_data, vertex_data : dict of arrays, optional
        Values of polygons and of points.
    **looks
        Other arguments of `Mesh`.
    """
    counts = np.asarray(counts, np.int64)
    if (counts == 3).all():
        faces = np.asarray(corners).reshape(-1, 3)
        return Mesh(points, faces, **looks, **_values(vertex_data, polygon_data, cells))
    corners = np.asarray(corners)
    try:
        places = triangulate(np.asarray(points, np.float64), corners.astype(np.int64, copy=False), counts)
    except ValueError:
        is_out = (corners < 0) | (corners >= len(points))
        if not is_out.any():
            raise
        at = int(np.argmax(is_out))
        which = int(np.searchsorted(np.cumsum(counts), at, "right"))
        told = f"face {which} has vertex {corners[at]}, but there are {len(points)} vertices"
        raise ValueError(told) from None
    # In the types that meshes store, so that `Mesh` neither converts nor copies them.
    faces, polygon = corners.astype(np.uint32)[places], polygon_of(counts)
    for array in (faces, polygon):
        array.setflags(write=False)
    data = {name: array[polygon] for name, array in (polygon_data or {}).items()}
    owner = polygon if cells is None else cells[polygon]
    return Mesh(points, faces, **looks, **_values(vertex_data, data, owner))


def _values(vertex_data: Any, face_data: Any, cells: Any) -> dict[str, Any]:
    return {"vertex_attributes": vertex_data, "face_attributes": face_data, "cells": cells}


class LeftOut:
    """Parts of an object that are left out, for one warning."""

    def __init__(self, source: str) -> None:
        self._source = source
        self._kinds: dict[str, None] = {}

    def add(self, kind: str) -> None:
        """Note that something is left out."""
        self._kinds[kind] = None

    def values(self, given: Mapping[str, Any], count: int, what: str) -> dict[str, NDArray[Any]]:
        """Return the arrays with `count` rows of real numbers or bool, and note the others."""
        kept = {}
        for name, value in given.items():
            array = np.asarray(value)
            if array.ndim and len(array) == count and array.dtype.kind in "iufb":
                kept[name] = array
            else:
                self.add(f"{what} {name!r}, which is not {count} rows of real numbers")
        return kept

    def told(self) -> str:
        """Return all that was noted."""
        return ", ".join(self._kinds) or "nothing"

    def warn(self) -> None:
        """Warn of all that was noted, if anything was."""
        if self._kinds:
            warn_caller(f"left out of {self._source}: {self.told()}")
