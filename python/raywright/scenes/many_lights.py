"""A room with thousands of lamps."""

from __future__ import annotations

import numpy as np

from ..arrays import SeedLike, integer, seed_number
from ..cameras import Camera
from ..materials import Diffuse
from ..scene.scene import Scene
from ..shapes.mesh import Mesh
from .room import EYE, SIZE, TARGET, room

# Half the side of a lamp, and the total power of all lamps.
_HALF, _POWER = 0.01, 400.0


def many_lights(
    lights: int = 2000, seed: SeedLike = 0, width: int = 512, height: int = 512
) -> tuple[Scene, Camera]:
    """Return the room of `room` lit by many small lamps of all colors, and a camera.

    Only a few of them matter at each point: a choice by power alone wastes samples on distant lamps and on
    those that face away.

    Parameters
    ----------
    lights : int
        Number of lamps, at least 1.
    seed : int, Generator or SeedSequence
        Where they are.
    width, height : int
        Size of the picture in pixels.

    Returns
    -------
    scene : Scene
        Shapes: those of the room, then the lamps, each a square.
    camera : Camera

    See Also
    --------
    scenes.room : The room.

    Examples
    --------
    >>> scene, camera = rw.scenes.many_lights(lights=10, width=8, height=8)
    >>> sum(shape.emission is not None for shape in scene.shapes)
    10
    """
    count, seed = integer("lights", lights, 1), seed_number(seed, None)
    shell = room(20_000, seed)
    rng = np.random.default_rng(seed)
    places = rng.uniform(0.1 * SIZE, 0.9 * SIZE, (count, 3))
    colors = rng.uniform(0.2, 1.0, (count, 3)) * (_POWER / count / (4 * _HALF**2 * np.pi))
    lamps = []
    for place, color, way in zip(places, colors, rng.normal(size=(count, 3)), strict=True):
        normal = way / np.linalg.norm(way)
        side = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
        side *= _HALF / np.linalg.norm(side)
        other = np.cross(normal, side)
        corners = [place - side - other, place + side - other, place + side + other, place - side + other]
        lamps.append(Mesh(corners, [[0, 1, 2], [0, 2, 3]], material=Diffuse(0.0), emission=color))
    return Scene([*shell, *lamps]), Camera(EYE, TARGET, fov=60.0, width=width, height=height)
