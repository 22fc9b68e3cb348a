"""Closest points for trimesh: functions of its ``trimesh.proximity``, and `install` to put them there.

`closest_point`, `signed_distance` and `ProximityQuery` have the arguments and results of trimesh's, and find
closest points without rtree and scipy. With `install` they also answer ``mesh.nearest.on_surface``,
``mesh.nearest.signed_distance``, ``trimesh.proximity.thickness`` and registration by closest points. All
other names of ``trimesh.proximity`` can be read here too, and are trimesh's own.
"""

from __future__ import annotations

import trimesh

from ...public_names import public_names
from .closest import ProximityQuery, closest_point, signed_distance
from .installation import install, uninstall

__all__ = ["ProximityQuery", "closest_point", "install", "signed_distance", "uninstall"]
__dir__ = public_names(__name__)


def __getattr__(name: str) -> object:
    if name.startswith("_"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(trimesh.proximity, name)
