"""The scenes on which textbooks compare accelerators, each with a camera."""

from __future__ import annotations

import numpy as np

from ..arrays import SeedLike, integer, seed_number
from ..cameras import Camera
from ..scene.instance import Shapes
from ..scene.scene import Scene
from .city import city
from .forest import forest
from .room import EYE, TARGET, room
from .soup import soup
from .stadium import teapot_in_stadium
from .terrain import terrain
from .turned import rotation, turned
from .wall import diagonal_wall

# Position and target of each scene's camera.
_VIEWS = {
    "stadium": ((0.0, 0.35, 0.75), (0.0, 0.1, 0.0)),
    "terrain": ((0.0, 16.0, 46.0), (0.0, 3.0, 0.0)),
    "straight_wall": ((0.0, 0.0, 12.0), (0.0, 0.0, 0.0)),
    "diagonal_wall": ((0.0, 0.0, 12.0), (0.0, 0.0, 0.0)),
    "soup": ((1.7, 1.4, 2.0), (0.5, 0.5, 0.5)),
    "city": ((-260.0, 190.0, 420.0), (0.0, 20.0, 0.0)),
    "room": (EYE, TARGET),
    "turned_room": (EYE, TARGET),
    "forest": ((0.0, 12.0, 60.0), (0.0, 3.0, 0.0)),
}
_FOV = 50.0


def classics(
    triangles: int = 50_000, seed: SeedLike = 0, width: int = 256, height: int = 256
) -> dict[str, tuple[Scene, Camera]]:
    """Return the scenes on which textbooks compare accelerators, and a camera for each.

    ``for name, (scene, camera) in rw.scenes.classics().items(): print(rw.report.accelerators(scene,
    camera))`` compares accelerators on all:

    - ``"stadium"``: all detail in one place, `teapot_in_stadium`. Grids are slow.
    - ``"terrain"``: detail evenly spread, `terrain`. Grids do well.
    - ``"straight_wall"`` and ``"diagonal_wall"``: `diagonal_wall` at 0 and at 45 degrees. Boxes fit the
      straight wall only.
    - ``"soup"``: random triangles, `soup`.
    - ``"city"``: large and small side by side, `city`.
    - ``"forest"``: a thousand copies of a few trees, `forest`: a thousand times as many visible triangles as
      stored ones, with one accelerator over triangles and one over copies.
    - ``"room"`` and ``"turned_room"``: long thin boxes seen from inside, `room`; and the same with its
      camera, rotated by 45 degrees about the y axis.

    Parameters
    ----------
    triangles : int
        Approximate number of triangles of each scene, at least 1000; in the forest, of the unique trees.
    seed : int, Generator or SeedSequence
        Seed of the scenes.
    width, height : int
        Size of the pictures in pixels.

    Returns
    -------
    dict of (Scene, Camera)

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If a number is of the wrong type.

    See Also
    --------
    report.accelerators : Compares accelerators.

    Examples
    --------
    >>> scenes = rw.scenes.classics(triangles=1000, width=8, height=8)
    >>> sorted(scenes)
    ['city', 'diagonal_wall', 'forest', 'room', 'soup', 'stadium', 'straight_wall', 'terrain', 'turned_room']
    """
    count, seed = integer("triangles", triangles, 1000), seed_number(seed, None)
    # Shares as they are by default: two thirds of a stadium are its teapot, half of a terrain its grass.
    divisions = max(round((count * 2 / 3 / 64) ** 0.5), 1)
    tiers = max(round((count / 3 / 384) ** 0.5 * 2), 1)
    around = max(round(count / 3 / (4 * tiers)), 3)
    made: dict[str, Shapes] = {
        "stadium": teapot_in_stadium(divisions, tiers, around),
        "terrain": terrain(max(round((count / 4) ** 0.5), 1), count // 2, seed),
        "straight_wall": diagonal_wall(count // 12, 0.0),
        "diagonal_wall": diagonal_wall(count // 12, 45.0),
        "soup": soup(count, seed=seed),
        "city": city(max(round((count / 540) ** 0.5), 1), seed),
        "room": room(count, seed),
        "turned_room": turned(room(count, seed), 45.0),
        "forest": forest(
            1000, max(count // 10_000, 2), count // max(count // 10_000, 2), seed=seed
        ).instances(),
    }
    result = {}
    for name, shapes in made.items():
        eye, target = (np.array(point, np.float64) for point in _VIEWS[name])
        if name == "turned_room":
            eye, target = (point @ rotation(45.0).T for point in (eye, target))
        result[name] = Scene(shapes), Camera(eye, target, fov=_FOV, width=width, height=height)
    return result
