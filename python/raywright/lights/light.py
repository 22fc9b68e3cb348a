"""What all lights, and all environments, have in common."""

from __future__ import annotations


class Light:
    """A light without a surface, at a place. Its subclasses say how much it sends in which direction."""


class Environment:
    """Light from infinitely far around a scene. Its subclasses say how much comes from which direction."""
