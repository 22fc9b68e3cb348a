"""Arguments in Open3D's form."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from ...arrays import integer, last_axis
from .tensors import array_of


def parts_of(mesh: Any) -> tuple[Any, Any]:
    """Return the vertices and triangles of a mesh."""
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):
        return mesh.vertex["positions"], mesh.triangle["indices"]
    faces = getattr(mesh, "triangles", None) if not hasattr(mesh, "faces") else mesh.faces
    if not hasattr(mesh, "vertices") or faces is None:
        raise TypeError(f"mesh must have vertices and triangles, got {type(mesh).__name__}")
    return mesh.vertices, faces


def ends_of(rays: Any) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the origins and directions of (..., 6) rays."""
    array = last_axis("rays", array_of("rays", rays), 6)
    return array[..., :3], array[..., 3:]


def points_of(query_points: Any) -> NDArray[Any]:
    """Return (..., 3) points as an array."""
    return last_axis("query_points", array_of("query_points", query_points), 3)


def threads_of(nthreads: int) -> int | None:
    """Return a number of threads; None for all cores, which 0 means."""
    return integer("nthreads", nthreads, 0) or None
