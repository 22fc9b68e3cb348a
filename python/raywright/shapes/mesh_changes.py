"""Meshes with other vertices, faces or marks than before."""

from __future__ import annotations

from numpy.typing import ArrayLike

from ..arrays import rows, triangles
from ..descriptions import changed
from .mesh import Mesh


def moved(mesh: object, name: str, vertices: ArrayLike) -> Mesh:
    """Return the mesh with its vertices elsewhere, and all else as it is, given normals too."""
    if not isinstance(mesh, Mesh):
        raise ValueError(f"{name} must be None for shapes other than meshes, got a {type(mesh).__name__}")
    return changed(mesh, vertices=rows(name, vertices, 3, len(mesh.vertices)))


def wound(mesh: Mesh, faces: ArrayLike, normals: ArrayLike | None) -> Mesh:
    """Return the mesh with other faces and normals of the same vertices, and all else as it is."""
    count = len(mesh.vertices)
    pointing = None if normals is None else rows("normals", normals, 3, count)
    return changed(mesh, faces=triangles("faces", faces, count), normals=pointing)


def continued(mesh: Mesh) -> Mesh:
    """Return the mesh, marked as a part of the same object as the mesh before it."""
    object.__setattr__(mesh, "_continues", True)
    return mesh
