"""The Utah teapot."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import integer
from ..materials import Material
from ..shapes.mesh import Mesh

Array = NDArray[np.float64]

# Newell's control points (1975), in his units, z up. Round parts are given by their profile, four points from
# the top or the middle outwards: radius, offset of the two middle points of a quarter circle, height.
_ROUND = (
    ("rim", ((1.4, 0.784, 2.4), (1.3375, 0.749, 2.53125), (1.4375, 0.805, 2.53125), (1.5, 0.84, 2.4))),
    ("body", ((1.5, 0.84, 2.4), (1.75, 0.98, 1.875), (2.0, 1.12, 1.35), (2.0, 1.12, 0.9))),
    ("body", ((2.0, 1.12, 0.9), (2.0, 1.12, 0.45), (1.5, 0.84, 0.225), (1.5, 0.84, 0.15))),
    ("knob", ((0.0, 0.0, 3.15), (0.8, 0.45, 3.15), (0.0, 0.0, 2.85), (0.2, 0.112, 2.7))),
    ("lid", ((0.2, 0.112, 2.7), (0.4, 0.224, 2.55), (1.3, 0.728, 2.55), (1.3, 0.728, 2.4))),
    ("bottom", ((1.5, 0.84, 0.15), (1.5, 0.84, 0.075), (1.425, 0.798, 0.0), (0.0, 0.0, 0.0))),
)
# Handle and spout: one half of each; the other is its mirror image. Each row is a half turn around the tube:
# (x, z) of its first and last point, both at y = 0, and the y of the two points between.
_TUBES = (
    (
        ((-1.6, 2.025), (-1.5, 2.25), 0.3),
        ((-2.3, 2.025), (-2.5, 2.25), 0.3),
        ((-2.7, 2.025), (-3.0, 2.25), 0.3),
        ((-2.7, 1.8), (-3.0, 1.8), 0.3),
        ((-2.7, 1.575), (-3.0, 1.35), 0.3),
        ((-2.5, 1.125), (-2.65, 0.9375), 0.3),
        ((-2.0, 0.9), (-1.9, 0.6), 0.3),
    ),
    (
        ((1.7, 1.425), (1.7, 0.6), 0.66),
        ((2.6, 1.425), (3.1, 0.825), 0.66),
        ((2.3, 2.1), (2.4, 2.025), 0.25),
        ((2.7, 2.4), (3.3, 2.4), 0.25),
        ((2.8, 2.475), (3.525, 2.49375), 0.25),
        ((2.9, 2.475), (3.45, 2.5125), 0.15),
        ((2.8, 2.4), (3.2, 2.4), 0.15),
    ),
)


def teapot(divisions: int = 10, material: Material | None = None) -> Mesh:
    """Return the Utah teapot (Newell 1975) of 32 Bézier patches, with its bottom and with smooth normals.

    It stands on y = 0 around the y axis, 3.15 high and 4 deep, with the handle at x = -3 and the spout to
    the right. It is as Newell made it: the lid does not touch the rim, and handle and spout pierce the body.

    Parameters
    ----------
    divisions : int
        Number of pieces along the sides of each patch; there are about 64 triangles times its square.
    material : Material, optional
        ``Diffuse()`` if not given.

    Returns
    -------
    Mesh

    Raises
    ------
    ValueError
        If `divisions` is below 1.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    scenes.torus_knot : A closed mesh.

    Examples
    --------
    >>> teapot = rw.scenes.teapot(divisions=2)
    >>> teapot.bounds.round(2).tolist()
    [[-3.0, 0.0, -2.0], [3.43, 3.15, 2.0]]
    """
    n = integer("divisions", divisions, 1)
    control = patches()
    points, normals = surface(control, np.arange(n + 1) / n)
    count = len(points)
    # A degenerate side is exactly its point, despite rounding.
    for side in (0, -1):
        pole = (control[:, side] == control[:, side, :1]).all(axis=(1, 2))
        points[pole, side] = control[pole, side, :1]
    i, j = (a.reshape(-1) for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    a, b, c, d = (p * (n + 1) + q for p, q in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
    quads = np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3)
    faces = (quads + (n + 1) ** 2 * np.arange(count)[:, np.newaxis, np.newaxis]).reshape(-1, 3)
    vertices = points.reshape(-1, 3)
    # Beside a degenerate side, every second triangle has no area.
    corners = vertices[faces]
    whole = (corners != np.roll(corners, 1, axis=1)).any(axis=2).all(axis=1)
    upright = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    return Mesh(vertices @ upright, faces[whole], normals.reshape(-1, 3) @ upright, material=material)


def patches() -> Array:
    """Return the control points of the patches, z up: (32, 4, 4, 3).

    Derivatives along the first side, times those along the second, point out.
    """
    quarters = []
    for _, profile in _ROUND:
        patch = np.array([[[r, 0, z], [r, reach, z], [reach, r, z], [0, r, z]] for r, reach, z in profile])
        for _ in range(4):
            quarters.append(patch)
            patch = np.stack([-patch[..., 1], patch[..., 0], patch[..., 2]], axis=-1)
    halves = []
    for tube in _TUBES:
        rows = np.array([[[x, 0, z], [x, y, z], [u, y, w], [u, 0, w]] for (x, z), (u, w), y in tube])
        for patch in (rows[:4], rows[3:]):
            halves += [patch, patch[:, ::-1] * [1, -1, 1]]
    return np.stack(quarters + halves) + 0.0


def surface(control: Array, at: Array) -> tuple[Array, Array]:
    """Return points and unit normals of bicubic Bézier patches, at all pairs of parameters.

    Parameters
    ----------
    control : (P, 4, 4, 3) float64
    at : (K,) float64
        From 0 to 1.

    Returns
    -------
    points, normals : (P, K, K, 3) float64
    """
    s = 1 - at
    weights = np.stack([s**3, 3 * s**2 * at, 3 * s * at**2, at**3], axis=1)
    slopes = 3 * np.stack([-(s**2), s * (s - 2 * at), at * (2 * s - at), at**2], axis=1)
    points, along, across = (
        np.einsum("ui,vj,pijk->puvk", u, v, control)
        for u, v in ((weights, weights), (slopes, weights), (weights, slopes))
    )
    normals = np.cross(along, across)
    # At a degenerate side, on the axis, the surface is level.
    level = np.zeros_like(normals)
    level[..., 2] = np.sign(normals[..., 2].sum(axis=(1, 2)))[:, np.newaxis, np.newaxis]
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    return points, np.asarray(np.divide(normals, length, out=level, where=length > 1e-12))
