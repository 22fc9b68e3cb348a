"""Curved shapes and polygons, each solved in its own form: nothing is cut into triangles."""

from __future__ import annotations

from ..public_names import public_names
from .box import Box
from .cone import Cone
from .cylinder import Cylinder
from .disk import Disk
from .ellipsoid import Ellipsoid
from .implicit import Implicit
from .paraboloid import Paraboloid
from .plane import Plane
from .polygon import Polygon
from .shape import Shape as Shape
from .sphere import Sphere
from .torus import Torus

__all__ = [
    "Box",
    "Cone",
    "Cylinder",
    "Disk",
    "Ellipsoid",
    "Implicit",
    "Paraboloid",
    "Plane",
    "Polygon",
    "Sphere",
    "Torus",
]
__dir__ = public_names(__name__)
