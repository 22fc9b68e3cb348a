"""Rays for Open3D: a `RaycastingScene` of its interface, and `install` to put it into ``open3d.t.geometry``.

The methods, keys, shapes and dtypes are those of ``open3d.t.geometry.RaycastingScene``. Hits are decided
exactly, and a ray that crosses a surface on an edge or a corner crosses it once. Open3D itself need not be
installed: arrays of numpy are taken and returned, and tensors of Open3D where they come.
"""

from __future__ import annotations

from ...public_names import public_names
from .installation import install, uninstall
from .raycasting_scene import RaycastingScene

__all__ = ["RaycastingScene", "install", "uninstall"]
__dir__ = public_names(__name__)
