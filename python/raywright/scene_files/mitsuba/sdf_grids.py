"""Meshes of signed distance grids."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .errors import SceneError

Floats = NDArray[np.float64]

# Subdivisions of a grid cell along each axis before the surface is extracted, and the most cells after it.
_FINER, _MOST_CELLS = 3, 8_000_000
# The six tetrahedra of a cube about its diagonal from corner 0 to corner 7; bits are x, y and z.
_TETRAHEDRA = ((0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7))


class Surface(NamedTuple):
    """Where the distance is 0: (V, 3), (F, 3) and (V, 3) normals, which point to where it grows."""

    vertices: Floats
    faces: NDArray[np.int64]
    normals: Floats


def surface(grid: Floats) -> Surface:
    """Return where a grid is 0 that is linear between its points along each axis, and fills the unit cube.

    Cells are cut in three along each axis, and these in six tetrahedra (Doi and Koide, "An Efficient Method
    of Triangulating Equi-Valued Surfaces", 1991). Corners lie on the surface itself, and between them it is
    missed by at most an eighth of a cell's third squared, times its curvature.

    Raises
    ------
    ValueError
        If it is 0 nowhere, or a number is not finite.
    """
    if min(grid.shape) < 2:
        raise SceneError(f"a grid must have at least 2 points along each axis, got {grid.shape[::-1]}")
    if not np.isfinite(grid).all():
        raise SceneError("a grid must be finite")
    finer = _FINER
    while finer > 1 and np.prod([(n - 1) * finer for n in grid.shape], dtype=np.float64) > _MOST_CELLS:
        finer -= 1
    fine = grid
    for axis in range(3):
        fine = _refined(fine, axis, finer)
    corners = np.stack(
        [
            fine[z : fine.shape[0] - 1 + z, y : fine.shape[1] - 1 + y, x : fine.shape[2] - 1 + x]
            for z in (0, 1)
            for y in (0, 1)
            for x in (0, 1)
        ],
        -1,
    )
    crossed = (corners.min(-1) < 0) & (corners.max(-1) >= 0)
    if not crossed.any():
        raise SceneError("a grid must have numbers on both sides of 0")
    cells = np.argwhere(crossed)
    stride = np.array([fine.shape[1] * fine.shape[2], fine.shape[2], 1])
    steps = [((k >> 2) & 1) * stride[0] + ((k >> 1) & 1) * stride[1] + (k & 1) * stride[2] for k in range(8)]
    points = (cells @ stride)[:, None] + np.array(steps)
    faces = _tetrahedra(points, fine.reshape(-1))
    edges, which = np.unique(np.sort(faces.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    vertices = _on_edges(edges, grid, fine, finer)
    normals = _gradients(grid, vertices)
    corner = which.reshape(-1, 3)
    a, b, c = (vertices[corner[:, k]] for k in range(3))
    turned = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals[corner].sum(1)) < 0
    corner[turned] = corner[turned][:, ::-1]
    solid = (corner[:, 0] != corner[:, 1]) & (corner[:, 1] != corner[:, 2]) & (corner[:, 0] != corner[:, 2])
    return Surface(vertices, corner[solid], normals)


def _refined(grid: Floats, axis: int, times: int) -> Floats:
    count = grid.shape[axis]
    at = np.arange((count - 1) * times + 1) / times
    low = np.minimum(at.astype(np.int64), count - 2)
    share = (at - low).reshape([-1 if k == axis else 1 for k in range(3)])
    return np.asarray(np.take(grid, low, axis) * (1 - share) + np.take(grid, low + 1, axis) * share)


def _tetrahedra(points: NDArray[np.int64], values: Floats) -> NDArray[np.int64]:
    """Return triangles, (F, 3, 2): each corner lies on the edge between two points."""
    found = []
    for tetrahedron in _TETRAHEDRA:
        corners = points[:, tetrahedron]
        below = values[corners] < 0
        count = below.sum(1)
        # The single corner on its side comes first; of two and two, the two below.
        order = np.argsort(np.where((count == 3)[:, None], below, ~below), axis=1, kind="stable")
        a, b, c, d = np.take_along_axis(corners, order, 1).T
        one = (count == 1) | (count == 3)
        found.append(_triangles((a, b), (a, c), (a, d))[one])
        two = count == 2
        found += [_triangles((a, c), (a, d), (b, d))[two], _triangles((a, c), (b, d), (b, c))[two]]
    return np.concatenate(found)


def _triangles(*edges: tuple[NDArray[np.int64], NDArray[np.int64]]) -> NDArray[np.int64]:
    return np.asarray(np.stack([np.stack(edge, -1) for edge in edges], 1), np.int64)


def _on_edges(edges: NDArray[np.int64], grid: Floats, fine: Floats, finer: int) -> Floats:
    """Return where the grid is 0 on edges between fine points, as x, y and z in the unit cube."""
    ends = [np.stack(np.unravel_index(edges[:, k], fine.shape), -1)[:, ::-1] / finer for k in range(2)]
    values = [fine.reshape(-1)[edges[:, k]] for k in range(2)]
    swapped = (values[0] >= 0)[:, None]
    below, above = np.where(swapped, ends[1], ends[0]), np.where(swapped, ends[0], ends[1])
    low, high = np.zeros(len(edges)), np.ones(len(edges))
    scale = np.array(grid.shape[::-1]) - 1.0
    # Along a diagonal the grid is a cubic. Bisection finds its zero to 1e-9 of the edge.
    for _ in range(30):
        middle = 0.5 * (low + high)
        inside = _between(grid, below + (above - below) * middle[:, None])[0] < 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.asarray((below + (above - below) * (0.5 * (low + high))[:, None]) / scale)


def _between(grid: Floats, at: Floats) -> tuple[Floats, Floats]:
    """Return the grid at places in its cells, x, y and z, and its derivatives there, (N, 3)."""
    low = np.clip(at.astype(np.int64), 0, np.array(grid.shape[::-1]) - 2)
    x, y, z = (at - low).T
    i, j, k = low.T
    value = np.zeros(len(at))
    slope = np.zeros((len(at), 3))
    for c in range(8):
        dx, dy, dz = c & 1, (c >> 1) & 1, c >> 2
        here = grid[k + dz, j + dy, i + dx]
        wx, wy, wz = (share if d else 1 - share for d, share in ((dx, x), (dy, y), (dz, z)))
        value += here * wx * wy * wz
        slope += (here * np.stack([(2 * dx - 1) * wy * wz, (2 * dy - 1) * wx * wz, (2 * dz - 1) * wx * wy])).T
    return value, slope


def _gradients(grid: Floats, vertices: Floats) -> Floats:
    """Return normals that go evenly from cell to cell: gradients of central differences, between points."""
    scale = np.array(grid.shape[::-1]) - 1.0
    at = vertices * scale
    parts = np.gradient(grid)
    slopes = np.stack([_between(part, at)[0] for part in reversed(parts)], -1) * scale
    length = np.linalg.norm(slopes, axis=1, keepdims=True)
    return np.asarray(np.divide(slopes, length, out=np.zeros_like(slopes), where=length > 0))
