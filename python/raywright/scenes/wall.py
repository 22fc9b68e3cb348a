"""A wall of long thin boards: easy for boxes along the axes, and hard once it is turned."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import integer, number
from ..shapes.mesh import Mesh
from .boxes import boxes

_THICK = 0.02


def diagonal_wall(boards: int = 800, angle: float = 45.0, layers: int = 4) -> list[Mesh]:
    """Return a wall of long thin boards, turned in its own plane: at 45 degrees all of them lie diagonally.

    The wall is a square of 10 by 10 around the origin, across the z axis: layers of boards one behind the
    other, alternately vertical and horizontal, each as long as the wall, with gaps as wide as the boards. At
    0 degrees the boards fill their bounding boxes; rotated, each fills a small part, and the boxes of
    neighbors overlap almost completely.

    Parameters
    ----------
    boards : int
        Number of boards in all; at least one per layer, and 12 triangles per board.
    angle : float
        Rotation of the wall about the z axis in degrees, anticlockwise as seen from +z.
    layers : int
        Number of layers, at least 1.

    Returns
    -------
    list of Mesh
        One mesh. The same arguments make the same wall; of another angle, the same wall turned.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If a number is of the wrong type.

    See Also
    --------
    scenes.turned : Turns any meshes.

    Examples
    --------
    >>> wall = rw.scenes.diagonal_wall(boards=8)
    >>> len(wall[0].faces)
    96
    """
    layers = integer("layers", layers, 1)
    boards = integer("boards", boards, layers)
    angle = math.radians(number("angle", angle))
    # Boards spread evenly: the first layers take one more if there is a remainder.
    counts = np.full(layers, boards // layers) + (np.arange(layers) < boards % layers)
    centers, halves = np.zeros((boards, 3)), np.empty((boards, 3))
    start = 0
    for layer, count in enumerate(counts.tolist()):
        mine = slice(start, start + count)
        across, along = layer % 2, 1 - layer % 2
        centers[mine, across] = 10 * (np.arange(count) + 0.5) / count - 5
        centers[mine, 2] = 4 * _THICK * (layer - (layers - 1) / 2)
        halves[mine, across], halves[mine, along], halves[mine, 2] = 2.5 / count, 5.0, _THICK
        start += count
    vertices, faces = boxes(centers, halves)
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    return [Mesh(vertices @ turn.T, faces)]
