"""Scenes that are ready to render."""

from .cornell import cornell_box
from .knot import torus_knot
from .studio import studio

__all__ = ["cornell_box", "studio", "torus_knot"]
