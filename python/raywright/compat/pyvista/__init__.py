"""Rays for pyvista: three of its filters, and `install` to put them into its meshes.

`ray_trace`, `multi_ray_trace` and `select_interior_points` have the arguments and results of the methods of
``pyvista.PolyData``. Hits are decided exactly, come in their order along the ray, and need neither embree nor
meshes of triangles alone.
"""

from __future__ import annotations

from ...public_names import public_names
from .filters import multi_ray_trace, ray_trace, select_interior_points
from .installation import install, uninstall

__all__ = ["install", "multi_ray_trace", "ray_trace", "select_interior_points", "uninstall"]
__dir__ = public_names(__name__)
