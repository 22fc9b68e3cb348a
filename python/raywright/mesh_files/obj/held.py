"""Materials of OBJ files as trimesh holds them: numbers, and the picture of the base color."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...io.pictures import pixels_of
from ..look import Look, linear
from .maps import Pictures
from .material import look_of_mtl
from .mtl import Description, Statement, Statements
from .notes import Notes

# Keywords of material libraries that trimesh keeps, in lower case.
_SURE = ("ka", "kd", "ke", "ks", "ns", "ni", "d", "tr", "illum", "pr", "pm")


def is_held(material: Any) -> bool:
    """Return whether a material of trimesh comes from a material library."""
    given = getattr(material, "kwargs", None)
    return isinstance(given, dict) and any(name in given for name in _SURE)


def look_of_held(material: Any) -> Look:
    """Return how a surface with a SimpleMaterial of trimesh from a material library looks.

    Warns
    -----
    RuntimeWarning
        If a part is not supported: pictures, for example, that trimesh does not keep.
    """
    from trimesh.visual.color import to_rgba

    statements: Statements = {}
    for name, value in material.kwargs.items():
        words = value if isinstance(value, list | tuple | np.ndarray) else [value]
        statements[name] = Statement(name, " ".join(map(str, words)))
    if not np.array_equal(to_rgba(material.kwargs.get("kd")), material.diffuse):
        # The user has painted it since.
        color = linear(np.asarray(material.diffuse[:3], np.float64) / 255)
        statements["kd"] = Statement("Kd", " ".join(f"{x:.9g}" for x in color))
    held = {}
    if material.image is not None:
        held["map_Kd"] = pixels_of(material.image)
        statements["map_kd"] = Statement("map_Kd", "")
    notes = Notes("a material of trimesh")
    look = look_of_mtl(Description(str(material.name), statements, notes), Pictures(None, held), 1.0)
    notes.warn()
    return look
