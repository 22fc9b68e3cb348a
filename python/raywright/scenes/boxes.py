"""Many boxes as one mesh: what walls, rooms and cities are made of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)
# Anticlockwise from outside; the bits of i are the coordinates of corner i.
_QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
_FACES = np.concatenate([_QUADS[:, [0, 1, 2]], _QUADS[:, [0, 2, 3]]])


def boxes(centers: Array, halves: Array, turns: Array | None = None) -> tuple[Array, NDArray[np.int64]]:
    """Return boxes as vertices and faces, 8 and 12 of each, box after box; wound anticlockwise from outside.

    Parameters
    ----------
    centers : (N, 3) float64
    halves : (N, 3) float64
        Half of each box's length along its own axes.
    turns : (N, 3, 3) float64, optional
        The boxes' own axes as rows; those of the world if not given. They must be right-handed.
    """
    corners = _CUBE * halves[:, np.newaxis]
    corners = centers[:, np.newaxis] + (corners if turns is None else corners @ turns)
    faces = _FACES + 8 * np.arange(len(corners))[:, np.newaxis, np.newaxis]
    return corners.reshape(-1, 3), faces.reshape(-1, 3)
