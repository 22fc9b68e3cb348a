"""Height fields of Mitsuba 0.6, as meshes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .errors import SceneError
from .mesh_files import Triangles

Floats = NDArray[np.float64]


def surface(heights: Floats) -> Triangles:
    """Return the surface over the square from (-1, -1) to (1, 1) with these heights at the points of a grid.

    Between four points Mitsuba has a bilinear patch. Here that is four triangles about its middle, which meet
    it along its edges and in the middle, and stray from it by at most a sixteenth of a - b - c + d.

    Parameters
    ----------
    heights : (H, W) float64
        The first row is at y = -1.

    Returns
    -------
    Triangles
        With normals of vertices that go evenly from patch to patch, and coordinates from 0 to 1.

    Raises
    ------
    ValueError
        If there are fewer than 2 rows or columns, or a height is not finite.
    """
    if heights.ndim != 2 or min(heights.shape) < 2:
        raise SceneError(f"a height field must have at least 2 rows and 2 columns, got {heights.shape}")
    if not np.isfinite(heights).all():
        raise SceneError("a height field must be finite")
    rows, columns = heights.shape
    v, u = (np.broadcast_to(x, heights.shape) for x in _steps(rows, columns))
    at_corners = _normals(heights)
    middles = [_middles(of) for of in (u, v, heights, at_corners)]
    parts = [
        np.concatenate([a.reshape(rows * columns, -1), b.reshape((rows - 1) * (columns - 1), -1)])
        for a, b in zip((u, v, heights, at_corners), middles, strict=True)
    ]
    uv = np.hstack(parts[:2])
    normals = parts[3] / np.linalg.norm(parts[3], axis=1, keepdims=True)
    row, column = np.mgrid[: rows - 1, : columns - 1]
    a = row * columns + column
    b, c, d = a + 1, a + columns + 1, a + columns
    middle = rows * columns + row * (columns - 1) + column
    sides = [np.stack([one, other, middle], -1) for one, other in ((a, b), (b, c), (c, d), (d, a))]
    faces = np.stack(sides, 2).reshape(-1, 3)
    return Triangles(np.hstack([2 * uv - 1, parts[2]]), faces, normals, uv)


def _steps(rows: int, columns: int) -> tuple[Floats, Floats]:
    return np.linspace(0, 1, rows)[:, None], np.linspace(0, 1, columns)[None]


def _middles(of: Floats) -> Floats:
    return 0.25 * (of[:-1, :-1] + of[:-1, 1:] + of[1:, :-1] + of[1:, 1:])


def _normals(heights: Floats) -> Floats:
    """Return unit normals at the points, (H, W, 3): of those of the patches around, the mean."""
    rows, columns = heights.shape
    # Slopes of each patch's two edges along x, and of its two along y.
    along_x = np.diff(heights, axis=1) * (columns - 1) / 2
    along_y = np.diff(heights, axis=0) * (rows - 1) / 2
    total = np.zeros((*heights.shape, 3))
    for i in (0, 1):
        for j in (0, 1):
            x, y = along_x[i : rows - 1 + i], along_y[:, j : columns - 1 + j]
            normal = np.stack([-x, -y, np.ones_like(x)], -1)
            total[i : rows - 1 + i, j : columns - 1 + j] += normal / np.linalg.norm(
                normal, axis=-1, keepdims=True
            )
    return np.asarray(total / np.linalg.norm(total, axis=-1, keepdims=True))
