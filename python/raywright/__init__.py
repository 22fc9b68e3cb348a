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
from .lights import ConstantEnvironment, PointLight
from .materials import (
    BlinnPhong,
    BumpMap,
    Conductor,
    Dielectric,
    Diffuse,
    Mask,
    MetallicRough,
    Mirror,
    Mix,
    NormalMap,
    OrenNayar,
    Phong,
    Plastic,
    ThinDielectric,
    TwoSided,
    metals,
)
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
from .textures import (
    Checker,
    FBm,
    ImageTexture,
    Marble,
    MixTexture,
    Noise,
    ObjectTransform,
    ProductTexture,
    Stripes,
    UvTransform,
    VertexColors,
    Wood,
)

if TYPE_CHECKING:
    from . import report

__all__ = [
    "BSP",
    "BVH",
    "AcceleratorInfo",
    "AllHits",
    "BlinnPhong",
    "Box",
    "BruteForce",
    "BumpMap",
    "Camera",
    "Checker",
    "ClosestPoints",
    "Conductor",
    "Cone",
    "ConeTouches",
    "ConstantEnvironment",
    "Cylinder",
    "Dielectric",
    "Diffuse",
    "Disk",
    "Ellipsoid",
    "ErrorEstimate",
    "FBm",
    "Grid",
    "Hits",
    "Image",
    "ImageTexture",
    "Implicit",
    "Instance",
    "KdTree",
    "Marble",
    "Mask",
    "Mesh",
    "MetallicRough",
    "Mirror",
    "Mix",
    "MixTexture",
    "NestedGrid",
    "Noise",
    "NormalMap",
    "ObjectTransform",
    "Octree",
    "OrenNayar",
    "Paraboloid",
    "Path",
    "Phong",
    "Plane",
    "Plastic",
    "PointLight",
    "Polygon",
    "ProductTexture",
    "QueryCost",
    "Scene",
    "Sphere",
    "Stripes",
    "Surface",
    "ThinDielectric",
    "Torus",
    "TwoSided",
    "UvTransform",
    "VertexColors",
    "Wood",
    "check_writable",
    "metals",
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
