"""Textures that are volumes: the colors of a grid, where the faces of a mesh lie in it."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import attributes, media
from .mesh_files import Triangles
from .plugin import Plugin

Floats = NDArray[np.float64]

VOLUME = "volume"
# Longest edge relative to the least side of a cell, and the most faces.
_PART, _MOST_FACES = 0.5, 4_000_000


def held(plugin: Plugin) -> Plugin:
    """Return the volume that such a texture holds.

    Raises
    ------
    ValueError
        If it holds none, or one of a kind that is not read.
    """
    found = plugin.child(VOLUME)
    if found is None or found.type not in media.VOLUMES:
        plugin.fail(f"a volume must be within, of type {' or '.join(media.VOLUMES)}")
    return found


def grids_within(plugin: Plugin) -> list[Plugin]:
    """Return the grids that the materials and lights of a shape ask for by textures, each once."""
    textures = (one for one in attributes.all_within(plugin) if str(one.get("type")).lower() == VOLUME)
    found = (held(Plugin(values, plugin.where, plugin.context)) for values in textures)
    return list({id(one.values): one for one in found if one.type == "gridvolume"}.values())


def colored(triangles: Triangles, plugin: Plugin) -> tuple[Triangles, Floats]:
    """Return a mesh so fine that a grid is nearly even between its vertices, and their colors, (V, 3)."""
    volume = media.grid(plugin, media.WRAPS)
    assert volume.numbers is not None
    low, high = _ends(volume)
    cell = np.linalg.norm(volume.transform[:3, :3], axis=0) * (high - low) / volume.numbers.shape[:3]
    fine = _refined(triangles, _PART * float(cell.min()))
    return fine, colors_at(volume, fine.vertices)


def colors_at(volume: media.Volume, points: Floats) -> Floats:
    """Return the colors of a grid at points, (N, 3): in proportion between the middles of cells."""
    assert volume.numbers is not None
    numbers = np.atleast_3d(volume.numbers).astype(np.float64)
    numbers = numbers[..., None] if numbers.ndim == 3 else numbers
    size = np.array(numbers.shape[:3])
    low, high = _ends(volume)
    inverse = np.linalg.inv(volume.transform)
    cells = (points @ inverse[:3, :3].T + inverse[:3, 3] - low) / (high - low) * size - 0.5
    first = np.floor(cells).astype(int)
    part = cells - first
    total = np.zeros((len(points), 3))
    for corner in product((0, 1), repeat=3):
        at = first + corner
        at = at % size if volume.repeats else np.clip(at, 0, size - 1)
        weight = np.where(corner, part, 1 - part).prod(axis=1)
        total += weight[:, None] * numbers[tuple(at.T)]
    return total


def _ends(volume: media.Volume) -> tuple[Floats, Floats]:
    return (np.zeros(3), np.ones(3)) if volume.bounds is None else tuple(np.array(volume.bounds, float))


def _refined(triangles: Triangles, length: float) -> Triangles:
    """Return a mesh whose faces are quartered until no edge is longer."""
    import trimesh

    subdivide: Any = trimesh.remesh.subdivide
    vertices, faces, normals, uv = triangles
    given = {"normals": normals, "uv": uv}
    kept = {name: one for name, one in given.items() if one is not None}
    while 4 * len(faces) <= _MOST_FACES:
        corners = vertices[faces]
        if np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(initial=0.0) <= length:
            break
        vertices, faces, kept = subdivide(vertices, faces, vertex_attributes=kept)
    if "normals" in kept:
        kept["normals"] = kept["normals"] / np.linalg.norm(kept["normals"], axis=1, keepdims=True)
    return Triangles(vertices, faces, kept.get("normals"), kept.get("uv"))
