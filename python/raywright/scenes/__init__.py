"""Scenes that are ready to render, and those on which accelerators are compared."""

from .city import city
from .classics import classics
from .cornell import cornell_box
from .forest import Forest, forest
from .knot import torus_knot
from .room import room
from .soup import soup
from .stadium import teapot_in_stadium
from .studio import studio
from .teapot import teapot
from .terrain import terrain
from .turned import turned
from .wall import diagonal_wall

__all__ = [
    "Forest",
    "city",
    "classics",
    "cornell_box",
    "diagonal_wall",
    "forest",
    "room",
    "soup",
    "studio",
    "teapot",
    "teapot_in_stadium",
    "terrain",
    "torus_knot",
    "turned",
]
