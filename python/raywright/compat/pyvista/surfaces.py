"""Surfaces of pyvista as triangles."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray

from ..switch import Kept
from ..trimesh_ray.intersector import RayMeshIntersector

# Attribute of a mesh that caches its triangles.
_OWN = "_raywright_surface"


class Surface(NamedTuple):
    """A surface as triangles.

    Attributes
    ----------
    intersector : RayMeshIntersector
        Of the triangles.
    cells : (F,) int64
        The cell of each triangle.
    """

    intersector: RayMeshIntersector
    cells: NDArray[np.int64]


def surface_of(name: str, mesh: Any) -> Surface:
    """Return the triangles of a ``pyvista.PolyData`` in its current state.

    Raises
    ------
    TypeError
        If it is something else.
    """
    import pyvista

    if not isinstance(mesh, pyvista.PolyData):
        raise TypeError(f"{name} must be a pyvista.PolyData, got {type(mesh).__name__}")
    parts = (mesh.GetPoints(), mesh.GetVerts(), mesh.GetLines(), mesh.GetPolys(), mesh.GetStrips())
    # VTK's modification times count all changes of all objects, so no two are equal.
    key = tuple(part.GetMTime() for part in parts if part is not None)
    own = vars(mesh).get(_OWN)
    if own is None or own.key != key:
        faces, cells = _triangles(mesh, pyvista)
        made = trimesh.Trimesh(np.asarray(mesh.points), faces, process=False, validate=False)
        own = vars(mesh)[_OWN] = Kept(Surface(RayMeshIntersector(made), cells), key)
    surface: Surface = own.value
    return surface


def _triangles(mesh: Any, pyvista: Any) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the corners of triangles, (F, 3), and the cell of each."""
    # Cells are numbered vertices first, then lines, polygons and strips.
    before = mesh.GetNumberOfVerts() + mesh.GetNumberOfLines()
    if mesh.is_all_triangles and not before and not mesh.n_strips and mesh.n_cells:
        return np.asarray(mesh.regular_faces, np.int64), np.arange(mesh.n_cells)
    areas = pyvista.PolyData()
    if mesh.n_points:
        areas.SetPoints(mesh.GetPoints())
        areas.SetPolys(mesh.GetPolys())
        areas.SetStrips(mesh.GetStrips())
    areas.cell_data["cell"] = np.arange(before, mesh.n_cells)
    parts = areas.triangulate()
    if not parts.n_cells:
        return np.empty((0, 3), np.int64), np.empty(0, np.int64)
    return np.asarray(parts.regular_faces, np.int64), np.asarray(parts.cell_data["cell"], np.int64)
