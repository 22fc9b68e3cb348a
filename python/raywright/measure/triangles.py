"""All triangles of a scene where they stand."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..scene.instance import AnyShape, Instance
from ..scene.scene import Scene
from ..shapes.mesh import Mesh
from .places import Floats


def triangles(scene: Scene) -> tuple[Floats, NDArray[np.int64]]:
    """Return the corners of all meshes, copies included, with equal corners joined, and the faces.

    Faces with a corner that is NaN or infinite are left out.

    Returns
    -------
    vertices, faces
        (V, 3) float64, and (F, 3) int64.

    Raises
    ------
    ValueError
        If something is no mesh, or moves; tells which shape.
    """
    corners, faces, count = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)], 0
    for i, shape in enumerate(scene.shapes):
        for mesh in _meshes(shape, f"shape {i}"):
            corners.append(mesh.vertices.astype(np.float64))
            faces.append(mesh.faces.astype(np.int64) + count)
            count += len(mesh.vertices)
    every, which = np.concatenate(corners), np.concatenate(faces)
    which = which[np.isfinite(every[which]).all(axis=(1, 2))]
    # Adding 0 makes -0 equal to 0.
    joined, place = np.unique(every + 0.0, axis=0, return_inverse=True)
    return joined, place.reshape(-1)[which]


def _meshes(shape: AnyShape, name: str) -> Iterator[Mesh]:
    if isinstance(shape, Mesh):
        yield shape
    elif isinstance(shape, Instance):
        if shape.transform_end is not None:
            raise ValueError(f"{name} moves: it has no one cross section")
        for i, inner in enumerate(shape.shapes):
            for mesh in _meshes(inner, f"{name}, shape {i} in it,"):
                for matrix in shape.transform.reshape(-1, 4, 4):
                    yield mesh.transformed(matrix)
    else:
        raise ValueError(f"{name} is no mesh but a {type(shape).__name__}: only meshes can be cut")
