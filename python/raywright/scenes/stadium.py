"""The teapot in the stadium: most of the triangles in next to none of the room."""

from __future__ import annotations

import numpy as np

from ..arrays import integer, positive
from ..materials import Diffuse
from ..shapes.mesh import Mesh
from .teapot import teapot

# Half extents of the field, in meters; depth and height of a tier.
_FIELD = np.array([60.0, 40.0])
_DEPTH, _RISE = 0.8, 0.45


def teapot_in_stadium(
    divisions: int = 20, tiers: int = 40, around: int = 96, width: float = 0.3
) -> list[Mesh]:
    """Return a teapot in the middle of a stadium: it occupies one or two cells of a uniform grid.

    The stadium is a field of 120 m by 80 m, an ellipse, surrounded by rows of seats, a wall, and a roof
    around the open middle, all oriented inwards. The teapot stands on the field. y is up.

    Parameters
    ----------
    divisions : int
        Divisions of the teapot's patches; it has about 64 triangles times their square.
    tiers : int
        Number of rows of seats.
    around : int
        Number of pieces of each row, 3 at least; four triangles each.
    width : float
        Width of the teapot from handle to spout, in meters.

    Returns
    -------
    list of Mesh
        The stadium, then the teapot.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If a number is of the wrong type.

    See Also
    --------
    scenes.teapot : The teapot alone.

    Examples
    --------
    >>> stadium, teapot = rw.scenes.teapot_in_stadium(divisions=2, tiers=2, around=8)
    >>> len(stadium.faces) > len(teapot.faces) / 10
    True
    """
    tiers, around = integer("tiers", tiers, 1), integer("around", around, 3)
    width = positive("width", width)
    # Distance beyond the field and height: riser and seat by turns, then the wall and the roof.
    steps = np.repeat(np.arange(tiers + 1), 2)
    out = np.array([*_DEPTH * steps[1:-1], _DEPTH * tiers, _DEPTH * tiers / 3])
    up = np.array([*_RISE * steps[2:], _RISE * tiers + 8, _RISE * tiers + 12])
    angle = np.arange(around) * (2 * np.pi / around)
    circle = np.stack([np.cos(angle), np.zeros(around), np.sin(angle)], axis=1)
    rings = circle * (np.array([_FIELD[0], 0, _FIELD[1]]) + out[:, np.newaxis, np.newaxis])
    rings[..., 1] = up[:, np.newaxis]
    first = circle * [_FIELD[0], 0, _FIELD[1]]
    vertices = np.concatenate([np.zeros((1, 3)), first, rings.reshape(-1, 3)])
    k = np.arange(around)
    field = np.stack([np.zeros(around, np.int64), 1 + (k + 1) % around, 1 + k], axis=1)
    i, j = (a.reshape(-1) for a in np.meshgrid(np.arange(len(rings)), k, indexing="ij"))
    a, b, c, d = (1 + p * around + q % around for p, q in ((i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)))
    stands = np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3)
    hall = Mesh(vertices, np.concatenate([field, stands]), material=Diffuse(0.5))
    pot = teapot(divisions, Diffuse((0.7, 0.7, 0.75)))
    low, high = np.array(pot.bounds)
    scale = width / float(high[0] - low[0])
    return [hall, pot.transformed(np.diag([scale, scale, scale, 1.0]))]
