"""Other libraries' interfaces, on raywright's rays."""

from __future__ import annotations

from ..public_names import public_names

__all__ = ["open3d", "pyvista", "trimesh_proximity", "trimesh_ray"]
__dir__ = public_names(__name__)
