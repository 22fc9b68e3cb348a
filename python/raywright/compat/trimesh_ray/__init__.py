"""Rays for trimesh: a `RayMeshIntersector` of its interface, and `install` to use that for every mesh.

The methods are those of ``trimesh.ray.ray_pyembree.RayMeshIntersector``, in its order of answers. Hits are
decided exactly, and all hits of a ray are found in one pass, so that none is lost, and a crossing of an edge
counts once, however small, large or far from the origin a mesh is.
"""

from __future__ import annotations

from ...public_names import public_names
from ..switch import Installation
from .installation import install, uninstall
from .intersector import RayMeshIntersector

__all__ = ["Installation", "RayMeshIntersector", "install", "uninstall"]
__dir__ = public_names(__name__)
