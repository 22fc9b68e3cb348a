"""Scenes in the format of Mitsuba 3, as XML files and as the dicts of its Python interface."""

from __future__ import annotations

from ...public_names import public_names
from .scene import from_mitsuba

__all__ = ["from_mitsuba"]
__dir__ = public_names(__name__)
