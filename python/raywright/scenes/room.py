"""A room of long thin boxes, as architects draw them."""

from __future__ import annotations

import numpy as np

from ..arrays import SeedLike, integer, seed_number
from ..shapes.mesh import Mesh
from .boxes import Array, boxes

SIZE = np.array([8.0, 3.0, 5.0])
"""The room's length, height and depth, in meters."""

EYE, TARGET, LAMP = np.array([[0.05, 0.55, 0.93], [0.7, 0.4, 0.3], [0.55, 0.9, 0.55]]) * SIZE
"""Where a camera stands well, where it looks, and where a lamp hangs."""


def room(triangles: int = 70_000, seed: SeedLike = 0) -> list[Mesh]:
    """Return a closed room, to be seen from inside, all of long thin boxes: boards, slats and loose beams.

    It is 8 m long, 3 m high (y) and 5 m deep, with a corner in the origin. Its six sides consist of parallel
    boards, an eighth of all boxes. The others are beams at random places, some of which stick out; their size
    decreases with their number, so a ray sees equally far in every room. Seven of eight beams are parallel to
    the axes, as in buildings; the others are braces at any angle, which fill little of their bounding box.

    Parameters
    ----------
    triangles : int
        Approximate number of triangles: 12 for each box, and at least 8 boxes.
    seed : int, Generator or SeedSequence
        Seed of the places of the beams.

    Returns
    -------
    list of Mesh
        One mesh; its vertices are float32.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If a number is of the wrong type.

    See Also
    --------
    scenes.many_lights : The room with lamps.

    Examples
    --------
    >>> room = rw.scenes.room(triangles=960)
    >>> len(room[0].faces)
    960
    """
    count = max(integer("triangles", triangles, 1) // 12, 8)
    rng = np.random.default_rng(seed_number(seed, None))
    panels = [_boards(axis, end, count // 8) for axis in range(3) for end in (0.0, SIZE[axis])]
    beams = count - 6 * (count // 8)
    scale = min((1500 / beams) ** 0.5, 3)
    half = 0.004 * scale * rng.uniform(0.5, 1.5, (beams, 3))
    half[:, 0] = scale * rng.uniform(0.15, 0.75, beams)
    turn = np.eye(3)[np.array([[0, 1, 2], [1, 2, 0], [2, 0, 1]])[rng.integers(3, size=beams)]]
    braces = np.linalg.qr(rng.normal(size=turn[::8].shape))[0]
    # Right-handed, so that no box is turned inside out.
    turn[::8] = braces * np.sign(np.linalg.det(braces))[:, np.newaxis, np.newaxis]
    loose = rng.uniform(0, 1, (beams, 3)) * SIZE
    centers = np.concatenate([*(center for center, _ in panels), loose])
    halves = np.concatenate([*(half for _, half in panels), half])
    turns = np.concatenate([np.broadcast_to(np.eye(3), (len(centers) - beams, 3, 3)), turn])
    vertices, faces = boxes(centers, halves, turns)
    return [Mesh(vertices.astype(np.float32), faces)]


def _boards(axis: int, end: float, count: int) -> tuple[Array, Array]:
    """Return one side of the room, across `axis` at `end`: centers and halves of boards side by side."""
    across = (axis + 1) % 3
    center, half = np.tile(SIZE / 2, (count, 1)), np.tile(SIZE / 2, (count, 1))
    center[:, axis], half[:, axis] = end, 0.025
    half[:, across] = SIZE[across] / count / 2
    center[:, across] = (2 * np.arange(count) + 1) * half[:, across]
    return center, half
