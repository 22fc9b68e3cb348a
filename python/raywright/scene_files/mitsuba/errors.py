"""Errors of scenes."""

from __future__ import annotations


class SceneError(ValueError):
    """A scene that cannot be read; says where."""
