"""Meshes from the objects of trimesh."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..io.quiet import warn_caller
from ..shapes.mesh import Mesh
from ..shapes.mesh_changes import continued
from .looks import look_of
from .polygons import LeftOut


def of_scene(scene: Any, loaded: bool = False) -> Iterator[Mesh]:
    """Yield a mesh for each node of a trimesh.Scene that holds one; `loaded`: nobody has looked at it yet.

    Points and curves are left out.

    Warns
    -----
    RuntimeWarning
        Once, for all that is left out.
    """
    order = {name: i for i, name in enumerate(scene.geometry)}
    placed = [scene.graph[node] for node in scene.graph.nodes_geometry]
    made: dict[str, tuple[Mesh, ...]] = {}
    left_out = LeftOut("trimesh.Scene")
    for _, name in placed:
        if not hasattr(scene.geometry[name], "faces"):
            left_out.add(f"{name!r}, a {type(scene.geometry[name]).__name__}")
    left_out.warn()
    for matrix, name in sorted(placed, key=lambda place: order[place[1]]):
        geometry = scene.geometry[name]
        if not hasattr(geometry, "faces"):
            continue
        if name not in made:
            made[name] = tuple(of_trimesh(geometry, loaded, name))
        moved = not np.array_equal(matrix, np.eye(4))
        for one in made[name]:
            yield one.transformed(matrix) if moved else one


def of_trimesh(mesh: Any, loaded: bool = False, name: object = None) -> Iterator[Mesh]:
    """Yield a mesh with its looks for each material of the faces of a trimesh.Trimesh; mostly that is one."""
    vertices = np.asarray(mesh.vertices)
    faces = np.asarray(mesh.faces)
    uv = getattr(mesh.visual, "uv", None)
    if uv is not None and np.shape(uv) != (len(vertices), 2):
        uv = None
    normals = _given_normals(mesh, loaded)
    called = name if isinstance(name, str) else None
    left_out = LeftOut("trimesh.Trimesh")
    of_vertices = left_out.values(mesh.vertex_attributes, len(vertices), "vertex attribute")
    of_faces = left_out.values(mesh.face_attributes, len(faces), "face attribute")
    if getattr(mesh.visual, "kind", None) == "face" and _differ(mesh.visual.face_colors):
        left_out.add("colors of faces, for which the main one stands")
    left_out.warn()
    for i, (visual, which) in enumerate(_by_material(mesh.visual, len(faces))):
        look = look_of(visual, len(vertices))
        made = Mesh(
            vertices,
            faces[which],
            normals,
            uv,
            look.material,
            look.emission,
            look.colors,
            called,
            of_vertices,
            {key: array[which] for key, array in of_faces.items()},
            which if isinstance(which, np.ndarray) and len(which) < len(faces) else None,
        )
        yield continued(made) if i else made


def _differ(colors: Any) -> bool:
    """Return whether some faces have other colors than the first."""
    rows = np.asarray(colors)
    return bool(len(rows)) and bool((rows != rows[0]).any())


def _by_material(visual: Any, count: int) -> Iterator[tuple[Any, NDArray[np.int64] | slice]]:
    """Yield the looks of a mesh with which faces have them, by the number of the material."""
    materials = getattr(getattr(visual, "material", None), "materials", None)
    if materials is None:
        yield visual, slice(None)
        return
    if not len(materials):
        yield _Plain(), slice(None)
        return
    which = getattr(visual, "face_materials", None)
    if which is None:
        if len(materials) > 1:
            warn_caller(
                f"a mesh has {len(materials)} materials but no face_materials: all of its faces get the first"
            )
        which = np.zeros(count, np.int64)
    which = np.asarray(which).reshape(-1)
    if len(which) != count or (len(which) and not 0 <= which.min() <= which.max() < len(materials)):
        raise ValueError(
            f"face_materials must be {count} numbers of {len(materials)} materials, one per face, got "
            + (f"{len(which)}" if len(which) != count else f"{which.min()} to {which.max()}")
        )
    for number in np.unique(which):
        yield _Plain(materials[number]), np.flatnonzero(which == number)


class _Plain:
    """A visual of trimesh, with one material or none."""

    kind = "texture"

    def __init__(self, material: Any = None) -> None:
        self.material = material


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
