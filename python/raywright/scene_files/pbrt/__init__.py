"""Scenes in the format of pbrt, version 4."""

from __future__ import annotations

from ...public_names import public_names
from .scene import read_pbrt

__all__ = ["read_pbrt"]
__dir__ = public_names(__name__)
