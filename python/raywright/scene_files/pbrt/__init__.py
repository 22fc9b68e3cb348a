"""Scenes in the format of pbrt, version 4."""

from .scene import read_pbrt

__all__ = ["read_pbrt"]
