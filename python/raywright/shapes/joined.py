"""Several meshes as one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..io.quiet import warn_caller
from .attributes import Attributes
from .mesh import Mesh


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Return one mesh with the vertices and faces of several, one after the other.

    It has the normals, coordinates, colors and attributes that all of them have, and the material and the
    emission of the first. Cells are counted on from object to object.

    Warns
    -----
    RuntimeWarning
        If their materials or emissions differ.
    """
    first = meshes[0]
    if any((mesh.material, mesh.emission) != (first.material, first.emission) for mesh in meshes):
        warn_caller(
            f"{len(meshes)} meshes with different materials become one with that of the first; "
            "raywright.Scene keeps them apart"
        )
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces.astype(np.int64) + start for mesh, start in zip(meshes, starts, strict=False)]
    optional = {
        field: np.concatenate([getattr(mesh, field) for mesh in meshes])
        for field in ("normals", "uv", "colors")
        if all(getattr(mesh, field) is not None for mesh in meshes)
    }
    names = {mesh.name for mesh in meshes}
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate(faces),
        material=first.material,
        emission=first.emission,
        name=first.name if len(names) == 1 else None,
        vertex_attributes=_common([mesh.vertex_attributes for mesh in meshes]),
        face_attributes=_common([mesh.face_attributes for mesh in meshes]),
        cells=_cells(meshes),
        **optional,
    )


def _common(each: Sequence[Attributes]) -> dict[str, NDArray[Any]]:
    """Return the attributes that all have with rows of one shape."""
    return {
        name: np.concatenate([attributes[name] for attributes in each])
        for name, array in each[0].items()
        if all(name in other and other[name].shape[1:] == array.shape[1:] for other in each)
    }


def _cells(meshes: Sequence[Mesh]) -> NDArray[np.int64] | None:
    if all(mesh.cells is None for mesh in meshes):
        return None
    found, start, end = [], 0, 0
    for mesh in meshes:
        own = np.arange(len(mesh.faces)) if mesh.cells is None else mesh.cells
        start = start if mesh._continues else end
        found.append(own + start)
        end = max(end, start + int(own.max(initial=-1)) + 1)
    return np.concatenate(found)
