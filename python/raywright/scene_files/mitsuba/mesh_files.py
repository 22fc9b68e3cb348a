"""Meshes as in Mitsuba: of OBJ, PLY and its own files, its rectangle and its cube."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ... import _core
from ...mesh_files.meshes import load_whole
from ...shapes.mesh import Mesh, stretched
from .plugin import Plugin
from .serialized import Stored, read_serialized
from .transforms import Matrix

Floats = NDArray[np.float64]

_FACES = (
    # Normal of each face of the cube, and its corners with the coordinates (0, 1), (1, 1), (1, 0), (0, 0).
    ((0, -1, 0), ((1, -1, -1), (1, -1, 1), (-1, -1, 1), (-1, -1, -1))),
    ((0, 1, 0), ((1, 1, -1), (-1, 1, -1), (-1, 1, 1), (1, 1, 1))),
    ((1, 0, 0), ((1, -1, -1), (1, 1, -1), (1, 1, 1), (1, -1, 1))),
    ((0, 0, 1), ((1, -1, 1), (1, 1, 1), (-1, 1, 1), (-1, -1, 1))),
    ((-1, 0, 0), ((-1, -1, 1), (-1, 1, 1), (-1, 1, -1), (-1, -1, -1))),
    ((0, 0, -1), ((1, 1, -1), (1, -1, -1), (-1, -1, -1), (-1, 1, -1))),
)


class Triangles(NamedTuple):
    """The arrays of a mesh: (V, 3), (F, 3), and if there are any (V, 3) normals and (V, 2) coordinates."""

    vertices: Floats
    faces: NDArray[np.int64]
    normals: Floats | None = None
    uv: Floats | None = None

    def placed(self, matrix: Matrix, flipped: bool) -> Triangles:
        """Return them where a matrix puts them; `flipped`, with the other side outside.

        A matrix that mirrors turns faces round if there are normals, so that outside stays outside.
        """
        linear = matrix[:3, :3]
        vertices = self.vertices @ linear.T + matrix[:3, 3]
        normals = self.normals
        turned = flipped
        if normals is not None:
            normals = _unit(normals @ np.linalg.inv(linear))
            turned = flipped != bool(np.linalg.det(linear) < 0)
            normals = -normals if flipped else normals
        return Triangles(vertices, self.faces[:, [0, 2, 1]] if turned else self.faces, normals, self.uv)

    def noise(self, matrix: Matrix) -> float:
        """Return how far apart corners may be, where a matrix puts them, that rounding has parted before."""
        faces = np.ascontiguousarray(self.faces, np.uint32)
        return stretched(_core.weld_rounding(np.ascontiguousarray(self.vertices), faces), matrix[:3, :3])

    @property
    def box(self) -> Floats:
        """The least and the greatest corner of all faces, (2, 3)."""
        corners = self.vertices[self.faces].reshape(-1, 3)
        return np.stack([corners.min(axis=0), corners.max(axis=0)])

    def mirrored(self) -> NDArray[np.bool_]:
        """Return of each face, (F,), whether u, v and the normal are left-handed on it."""
        if self.uv is None:
            return np.zeros(len(self.faces), bool)
        corners, at = self.vertices[self.faces], self.uv[self.faces]
        own = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        outside = own if self.normals is None else self.normals[self.faces].sum(axis=1)
        (ua, va), (ub, vb) = (at[:, 1] - at[:, 0]).T, (at[:, 2] - at[:, 0]).T
        return np.asarray((ua * vb - va * ub) * np.einsum("ij,ij->i", own, outside) < 0)


def rectangle() -> Triangles:
    """Return the square from (-1, -1, 0) to (1, 1, 0), which looks along +z."""
    uv = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    vertices = np.column_stack([2 * uv - 1, np.zeros(4)])
    return Triangles(vertices, np.array([(0, 1, 2), (0, 2, 3)]), np.tile((0.0, 0.0, 1.0), (4, 1)), uv)


def cube() -> Triangles:
    """Return the cube from (-1, -1, -1) to (1, 1, 1), with own coordinates on each face."""
    vertices = np.array([corner for _, corners in _FACES for corner in corners], np.float64)
    normals = np.repeat(np.array([normal for normal, _ in _FACES], np.float64), 4, axis=0)
    uv = np.tile([(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)], (6, 1))
    faces = (np.arange(6)[:, None, None] * 4 + np.array([(0, 1, 2), (3, 0, 2)])).reshape(-1, 3)
    return Triangles(vertices, faces, normals, uv)


def of_file(plugin: Plugin) -> tuple[Triangles, bool]:
    """Return the mesh of an ``obj``, ``ply`` or ``serialized``, and whether it is still to be made smooth.

    Meshes with `smooth` are smoothed in place.
    """
    path = plugin.path()
    mesh: Mesh | Stored
    if plugin.type == "serialized":
        mesh = read_serialized(path, plugin.integer("shape_index", 0))
        if not len(mesh.faces):
            plugin.fail(f"{path} holds no faces")
    else:
        mesh = load_whole(path, plugin.type)
    vertices, faces = mesh.vertices.astype(np.float64), mesh.faces.astype(np.int64)
    if not np.isfinite(vertices[faces]).all():
        plugin.fail(f"{path} has corners that are not finite")
    uv = None if mesh.uv is None else mesh.uv.astype(np.float64)
    if plugin.switch("flip_tex_coords", plugin.type == "obj") and uv is not None:
        uv = np.column_stack([uv[:, 0], 1 - uv[:, 1]])
    flat, given = plugin.switch("face_normals", False), mesh.normals
    normals = None if flat or given is None else _unit(given.astype(np.float64))
    return Triangles(vertices, faces, normals, uv), not flat and given is None


def smooth_normals(vertices: Floats, faces: NDArray[np.int64]) -> Floats:
    """Return normals of vertices, (V, 3): those of the faces around, weighted by their angles there.

    Thürmer and Wüthrich, "Computing Vertex Normals from Polygonal Facets" (1998).
    """
    corners = vertices[faces]
    own = _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    total = np.zeros_like(vertices)
    for k in range(3):
        a, b = (_unit(corners[:, (k + step) % 3] - corners[:, k]) for step in (1, 2))
        # Kahan's angle, which stays accurate where the cosine is near 1.
        angle = 2 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1))
        np.add.at(total, faces[:, k], own * angle[:, None])
    return _unit(total)


def _unit(vectors: Floats) -> Floats:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0))
