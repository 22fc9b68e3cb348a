"""Scenes that are ready to render, and those on which accelerators are compared."""

from __future__ import annotations

from ..public_names import public_names
from .ball import material_ball
from .city import city
from .classics import classics
from .cornell import cornell_box
from .films import oil_on_water, soap_bubble
from .forest import Forest, forest
from .glass import glass_spheres
from .knot import torus_knot
from .many_lights import many_lights
from .plates import veach_plates
from .room import room
from .soup import soup
from .stadium import teapot_in_stadium
from .studio import studio
from .teapot import teapot
from .terrain import terrain
from .turned import turned
from .wall import diagonal_wall
from .whitted import whitted_spheres

__all__ = [
    "Forest",
    "city",
    "classics",
    "cornell_box",
    "diagonal_wall",
    "forest",
    "glass_spheres",
    "many_lights",
    "material_ball",
    "oil_on_water",
    "room",
    "soap_bubble",
    "soup",
    "studio",
    "teapot",
    "teapot_in_stadium",
    "terrain",
    "torus_knot",
    "turned",
    "veach_plates",
    "whitted_spheres",
]
__dir__ = public_names(__name__)
