"""All triangles of a scene where they stand."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..scene.instance import AnyShape, Instance
from ..scene.scene import Scene
from ..shapes.mesh import Mesh, rounding
from .places import Floats


def triangles(scene: Scene, tolerance: float | None) -> tuple[Floats, NDArray[np.uint32], float]:
    """Return the corners of all meshes, copies included, the faces, and how close corners are one.

    Returns
    -------
    vertices, faces, tolerance
        (V, 3) float64, (F, 3) uint32, and the distance that was given, or the least that rounding makes of a
        mesh.

    Raises
    ------
    ValueError
        If something is not a mesh, or moves; the error names the shape.
    """
    distances: list[float] = []
    corners, faces, count = [np.zeros((0, 3))], [np.zeros((0, 3), np.uint32)], 0
    for i, shape in enumerate(scene.shapes):
        for mesh in meshes_in(shape, f"shape {i}"):
            corners.append(mesh.vertices.astype(np.float64))
            faces.append(mesh.faces + np.uint32(count))
            count += len(mesh.vertices)
            if tolerance is None and len(mesh.faces):
                distances.append(rounding(mesh))
    least = min(distances, default=0.0) if tolerance is None else tolerance
    return np.concatenate(corners), np.concatenate(faces), least


def meshes_in(shape: AnyShape, name: str) -> Iterator[Mesh]:
    """Yield the meshes that a shape is made of, where they stand.

    Raises
    ------
    ValueError
        If something in it is not a mesh, or moves.
    """
    if isinstance(shape, Mesh):
        yield shape
    elif isinstance(shape, Instance):
        if shape.transform_end is not None:
            raise ValueError(f"{name} moves, so its cross section changes")
        for i, inner in enumerate(shape.shapes):
            for mesh in meshes_in(inner, f"{name}, shape {i} in it,"):
                for matrix in shape.transform.reshape(-1, 4, 4):
                    yield mesh.transformed(matrix)
    else:
        raise ValueError(f"{name} must be a mesh to be cut, got a {type(shape).__name__}")
