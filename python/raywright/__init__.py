"""Ray tracing for Python: exact hits from numpy arrays, and pictures that say how wrong they still are."""

from typing import TYPE_CHECKING, Any

from . import scenes
from ._core import AcceleratorInfo, simd
from .accelerators import BSP, BVH, BruteForce, Grid, KdTree, NestedGrid, Octree
from .camera import Camera
from .cones import ConeTouches
from .hits import AllHits, ClosestPoints, Hits, QueryCost
from .image import ErrorEstimate, Image
from .instance import Instance
from .integrators import Path
from .io.pictures import check_writable
from .lights import (
    ConstantEnvironment,
    DirectionalLight,
    Emission,
    EnvironmentMap,
    PointLight,
    ProjectorLight,
    SpotLight,
    SunSky,
)
from .materials import Diffuse
from .mesh import Mesh
from .rendering import render
from .scene import Scene
from .shapes import (
    Box,
    Cone,
    Cylinder,
    Disk,
    Ellipsoid,
    Implicit,
    Paraboloid,
    Plane,
    Polygon,
    Sphere,
    Torus,
)
from .surface import Surface

if TYPE_CHECKING:
    from . import report

__all__ = [
    "BSP",
    "BVH",
    "AcceleratorInfo",
    "AllHits",
    "Box",
    "BruteForce",
    "Camera",
    "ClosestPoints",
    "Cone",
    "ConeTouches",
    "ConstantEnvironment",
    "Cylinder",
    "Diffuse",
    "DirectionalLight",
    "Disk",
    "Ellipsoid",
    "Emission",
    "EnvironmentMap",
    "ErrorEstimate",
    "Grid",
    "Hits",
    "Image",
    "Implicit",
    "Instance",
    "KdTree",
    "Mesh",
    "NestedGrid",
    "Octree",
    "Paraboloid",
    "Path",
    "Plane",
    "PointLight",
    "Polygon",
    "ProjectorLight",
    "QueryCost",
    "Scene",
    "Sphere",
    "SpotLight",
    "SunSky",
    "Surface",
    "Torus",
    "check_writable",
    "render",
    "report",
    "scenes",
    "simd",
]


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        # Reports are for those who ask for them: nothing else waits for their import.
        if name == "report":
            from importlib import import_module

            return import_module(".report", __name__)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
