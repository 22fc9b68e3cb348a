"""Meshes from the objects of manifold3d."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..shapes.mesh import Mesh


def of_manifold(given: Any) -> Iterator[Mesh]:
    """Yield the mesh of a manifold3d.Mesh, Mesh64 or Manifold.

    Properties besides the position are the vertex attribute "properties", and the original faces that
    triangles come from, where it knows them, the face attribute "face_id". Of a Manifold, the double
    precision that it computes in is kept.
    """
    mesh = given
    if hasattr(given, "to_mesh"):
        mesh = given.to_mesh64() if hasattr(given, "to_mesh64") else given.to_mesh()
    values = np.asarray(mesh.vert_properties)
    faces = np.asarray(mesh.tri_verts).reshape(-1, 3)
    properties = {"properties": values[:, 3:]} if values.ndim == 2 and values.shape[1] > 3 else {}
    ids = np.asarray(getattr(mesh, "face_id", ()))
    face_attributes = {"face_id": ids} if len(ids) == len(faces) and len(ids) else {}
    yield Mesh(
        values.reshape(len(values), -1)[:, :3],
        faces,
        vertex_attributes=properties,
        face_attributes=face_attributes,
    )
