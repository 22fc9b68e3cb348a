"""Scenes: shapes and lights, compiled for rays."""

from __future__ import annotations

from ..public_names import public_names
from .instance import Instance
from .plan import Plan, PlanRow
from .scene import Scene

__all__ = [
    "Instance",
    "Plan",
    "PlanRow",
    "Scene",
]
__dir__ = public_names(__name__)
