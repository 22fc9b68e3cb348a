"""Scenes in the format of pbrt, version 4."""

from __future__ import annotations

from .scene import read_pbrt

__all__ = ["read_pbrt"]
