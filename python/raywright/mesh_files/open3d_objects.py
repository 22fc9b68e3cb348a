"""Meshes from the objects of Open3D."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..shapes.mesh import Mesh
from .look import Look, color_look
from .polygons import LeftOut


def of_legacy(mesh: Any) -> Iterator[Mesh]:
    """Yield the mesh of an open3d.geometry.TriangleMesh, with its vertex normals and colors."""
    look = color_look(np.asarray(mesh.vertex_colors)) if mesh.has_vertex_colors() else Look()
    normals = np.asarray(mesh.vertex_normals) if mesh.has_vertex_normals() else None
    points, faces = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    yield Mesh(points, faces, normals, None, look.material, None, look.colors)


def of_tensors(mesh: Any) -> Iterator[Mesh]:
    """Yield the mesh of an open3d.t.geometry.TriangleMesh, with normals, colors and other attributes.

    Tensors of other devices are copied.

    Warns
    -----
    RuntimeWarning
        Once, for attributes that are no rows of real numbers.
    """
    left_out = LeftOut("open3d.t.geometry.TriangleMesh")
    of_vertices, of_faces = _arrays(mesh.vertex), _arrays(mesh.triangle)
    points = of_vertices.pop("positions", np.empty((0, 3), np.float32))
    faces = of_faces.pop("indices", np.empty((0, 3), np.int64))
    normals, colors, uv = (of_vertices.pop(name, None) for name in ("normals", "colors", "texture_uvs"))
    # Open3D works them out; they say no more than the faces.
    of_faces.pop("normals", None)
    look = Look() if colors is None else color_look(colors)
    vertex_attributes = left_out.values(of_vertices, len(points), "vertex attribute")
    face_attributes = left_out.values(of_faces, len(faces), "triangle attribute")
    left_out.warn()
    yield Mesh(
        points, faces, normals, uv, look.material, None, look.colors, None, vertex_attributes, face_attributes
    )


def _arrays(tensors: Any) -> dict[str, NDArray[Any]]:
    return {str(name): tensor.cpu().numpy() for name, tensor in tensors.items()}
