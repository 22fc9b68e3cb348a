"""Ray tracing for Python: exact hits from numpy arrays, and pictures that say how wrong they still are."""

from . import scenes
from ._core import AcceleratorInfo, simd
from .accelerators import BVH, BruteForce
from .camera import Camera
from .hits import Hits
from .image import ErrorEstimate, Image
from .integrators import Path
from .io.pictures import check_writable
from .lights import ConstantEnvironment, PointLight
from .materials import Diffuse
from .mesh import Mesh
from .rendering import render
from .scene import Scene

__all__ = [
    "BVH",
    "AcceleratorInfo",
    "BruteForce",
    "Camera",
    "ConstantEnvironment",
    "Diffuse",
    "ErrorEstimate",
    "Hits",
    "Image",
    "Mesh",
    "Path",
    "PointLight",
    "Scene",
    "check_writable",
    "render",
    "scenes",
    "simd",
]
