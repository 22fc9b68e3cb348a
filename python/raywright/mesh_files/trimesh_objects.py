"""Meshes from the objects of trimesh."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..shapes.mesh import Mesh
from .looks import look_of


def of_scene(scene: Any, loaded: bool = False) -> Iterator[Mesh]:
    """Yield a mesh for each node of a trimesh.Scene that holds one; `loaded`: nobody has looked at it yet."""
    order = {name: i for i, name in enumerate(scene.geometry)}
    placed = [scene.graph[node] for node in scene.graph.nodes_geometry]
    made: dict[str, Mesh] = {}
    for matrix, name in sorted(placed, key=lambda place: order[place[1]]):
        geometry = scene.geometry[name]
        if not hasattr(geometry, "faces"):
            continue  # points or curves
        if name not in made:
            made[name] = of_trimesh(geometry, loaded, name)
        moved = not np.array_equal(matrix, np.eye(4))
        yield made[name].transformed(matrix) if moved else made[name]


def of_trimesh(mesh: Any, loaded: bool = False, name: object = None) -> Mesh:
    """Return a trimesh.Trimesh as a mesh, with its looks."""
    vertices = np.asarray(mesh.vertices)
    faces = np.asarray(mesh.faces)
    uv = getattr(mesh.visual, "uv", None)
    if uv is not None and np.shape(uv) != (len(vertices), 2):
        uv = None
    look = look_of(mesh.visual, len(vertices))
    shines = (look.material, look.emission, look.colors)
    called = name if isinstance(name, str) else None
    return Mesh(vertices, faces, _given_normals(mesh, loaded), uv, *shines, called)


def _given_normals(mesh: Any, loaded: bool) -> NDArray[np.float64] | None:
    """Vertex normals that came with the mesh, not those that trimesh worked out because someone looked."""
    if "vertex_normals" not in mesh._cache:
        return None
    normals = np.asarray(mesh._cache["vertex_normals"])
    if normals.shape != (len(mesh.vertices), 3):
        return None
    if loaded:
        return normals  # nobody else has looked
    own = _angle_weighted(np.asarray(mesh.faces), mesh.face_normals, mesh.face_angles, len(normals))
    return None if np.allclose(normals, own, rtol=0, atol=1e-10) else normals


def _angle_weighted(faces: Any, face_normals: Any, angles: Any, count: int) -> NDArray[np.float64]:
    """Vertex normals as trimesh works them out: the faces' own, weighted by their angle at the vertex."""
    weighted = angles[:, :, np.newaxis] * face_normals[:, np.newaxis]
    total = [np.bincount(faces.reshape(-1), weighted[..., k].reshape(-1), count) for k in range(3)]
    result = np.stack(total, axis=1).astype(np.float64, copy=False)
    length = np.linalg.norm(result, axis=1, keepdims=True)
    np.divide(result, length, out=result, where=length > 0)
    return result
