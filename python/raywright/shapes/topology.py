"""Topology of a mesh from its faces alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .mesh import Mesh


def degenerate_faces(mesh: Mesh) -> int:
    """Return how many faces have no area, or a corner that is NaN or infinite; no ray hits these."""
    with np.errstate(invalid="ignore", over="ignore"):
        a, b, c = (mesh.vertices[mesh.faces[:, i]].astype(np.float64) for i in range(3))
        area = np.cross(b - a, c - a)
    return int(np.count_nonzero(~(area != 0).any(axis=1) | ~np.isfinite(area).all(axis=1)))


def is_watertight(mesh: Mesh) -> bool:
    """Return whether every edge lies between exactly two faces that run along it in opposite directions.

    Vertices at the same place count as one, so that seams of normals and texture do not matter.
    """
    faces = _welded(mesh).reshape(-1, 3)
    if not len(faces):
        return False
    starts = faces.reshape(-1).astype(np.int64)
    ends = faces[:, [1, 2, 0]].reshape(-1).astype(np.int64)
    count = int(faces.max()) + 1
    forward, backward = np.sort(starts * count + ends), np.sort(ends * count + starts)
    return bool((np.diff(forward) > 0).all() and np.array_equal(forward, backward))


def open_edges(mesh: Mesh) -> tuple[int, int]:
    """Return how many edges an odd number of faces share, and how many corners lie within edges of others."""
    found = _core.mesh_topology(mesh.vertices, mesh.faces, None)
    return len(found.cracks), len(found.junctions)


def _welded(mesh: Mesh) -> NDArray[np.int64]:
    _, index = np.unique(mesh.vertices + 0.0, axis=0, return_inverse=True)
    return np.asarray(index.reshape(-1)[mesh.faces], np.int64)
