"""Meshes from meshio's objects."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..shapes.mesh import Mesh
from .cell_faces import FLAT, FLAT_PARTS, VOLUME, boundary
from .polygons import LeftOut, mesh_of_polygons

Integers = NDArray[np.integer[Any]]


def of_meshio(mesh: Any) -> Iterator[Mesh]:
    """Yield the surface of a meshio.Mesh: its flat cells, and faces of volume cells that no other cell has.

    Cells are counted through all blocks, and those of faces of volumes are the volumes. Points of two
    coordinates lie at z = 0. Points, lines and kinds of cells that are not known are left out.

    Raises
    ------
    ValueError
        If points have neither two nor three coordinates, or no cell has faces.

    Warns
    -----
    RuntimeWarning
        Once, for all that is left out.
    """
    left_out = LeftOut("meshio.Mesh")
    points = np.asarray(mesh.points)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise ValueError(f"points of a meshio.Mesh must have shape (N, 2) or (N, 3), got {points.shape}")
    if points.shape[1] == 2:
        points = np.concatenate([points, np.zeros((len(points), 1), points.dtype)], axis=1)
    corners, counts, ids = _polygons(mesh, points, left_out)
    if not len(counts) and len(mesh.cells):
        kinds = ", ".join(dict.fromkeys(block.type for block in mesh.cells))
        raise ValueError(f"cells of a meshio.Mesh must have faces, got {kinds}")
    total = sum(len(block.data) for block in mesh.cells)
    per_cell = {name: _joined(blocks) for name, blocks in mesh.cell_data.items()}
    data = {name: array[ids] for name, array in left_out.values(per_cell, total, "cell data").items()}
    of_points = left_out.values(mesh.point_data, len(points), "point data")
    left_out.warn()
    cells = None if len(ids) == total and np.array_equal(ids, np.arange(total)) else ids
    yield mesh_of_polygons(points, corners, counts, cells, data, of_points)


def _polygons(mesh: Any, points: NDArray[Any], left_out: LeftOut) -> tuple[Integers, Integers, Integers]:
    """Return the corners of all polygons, how many each has, and which cell each is of."""
    corners, counts, ids = [np.empty(0, np.int64)], [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    volumes = []
    first = 0
    for block in mesh.cells:
        kind, own = block.type, np.arange(first, first + len(block.data))
        first += len(own)
        if kind.startswith("polygon") or kind in FLAT:
            is_even = isinstance(block.data, np.ndarray) and block.data.ndim == 2
            data = [block.data.reshape(-1)] if is_even else list(map(np.asarray, block.data))
            corners.append(np.concatenate([np.empty(0, np.int64), *data]))
            size = block.data.shape[1] if is_even else [len(polygon) for polygon in data]
            counts.append(np.zeros(len(own), np.int64) + np.asarray(size, np.int64))
            ids.append(own)
        elif kind in FLAT_PARTS:
            nodes = np.asarray(block.data)
            for part in FLAT_PARTS[kind]:
                corners.append(nodes[:, part].reshape(-1))
                counts.append(np.full(len(nodes), len(part)))
                ids.append(own)
        elif kind in VOLUME:
            volumes.append((kind, np.asarray(block.data, np.int64), own))
        else:
            left_out.add(f"cells of type {kind!r}")
    flat = [np.concatenate(part).astype(np.int64) for part in (corners, counts, ids)]
    if not volumes:
        return flat[0], flat[1], flat[2]
    outer = boundary(volumes, points, flat[0], flat[1])
    whole = [np.concatenate(pair) for pair in zip(flat, outer, strict=True)]
    return whole[0], whole[1], whole[2]


def _joined(blocks: Any) -> Any:
    """Return the values of all blocks one after the other; None if their rows differ."""
    arrays = [np.asarray(block) for block in blocks]
    alike = len({array.shape[1:] for array in arrays}) == 1
    return np.concatenate(arrays) if alike else None
