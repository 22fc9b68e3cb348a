"""Meshes from pairs of arrays or tensors, as PyTorch3D and others have them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..arrays import indices, real_array
from ..shapes.mesh import Mesh
from .polygons import mesh_of_polygons


def of_pair(vertices: Any, faces: Any) -> Iterator[Mesh]:
    """Yield the mesh of (V, 3) vertices and (F, N) indices of them: triangles, quads or other polygons.

    Raises
    ------
    ValueError
        If an array has another shape, or an index is not below V.
    TypeError
        If vertices are not real numbers, or faces are not integers.
    """
    points = real_array("vertices", vertices)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"vertices of a (vertices, faces) pair must have shape (V, 3), got {points.shape}")
    corners = indices("faces", faces, len(points))
    if corners.ndim != 2 or corners.shape[1] < 3:
        told = f"(F, 3), or (F, N) for polygons of N corners, got {corners.shape}"
        raise ValueError(f"faces of a (vertices, faces) pair must have shape {told}")
    yield mesh_of_polygons(points, corners.reshape(-1), np.full(len(corners), corners.shape[1]))
