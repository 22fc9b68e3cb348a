"""Attributes of the vertices or faces of a PLY file: colors, weights."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mesh_files.elements import Data
from ...mesh_files.ply import elements_of, indices_of
from ...mesh_files.triangulation import polygon_of
from .errors import SceneError
from .plugin import Plugin

Floats = NDArray[np.float64]

# Suffixes for the components of one attribute.
_ENDINGS = ("rgb", "xyz", "012", "123")


def named_within(plugin: Plugin) -> set[str]:
    """Return the names of the attributes that the materials and lights of a shape ask for."""
    names = (
        one.get("name") for one in all_within(plugin) if str(one.get("type")).lower() == "mesh_attribute"
    )
    return {name for name in names if isinstance(name, str)}


def has_within(plugin: Plugin, kind: str) -> bool:
    """Return whether there is a plugin of a type within another, however deep."""
    return any(str(one.get("type")).lower() == kind for one in all_within(plugin))


def all_within(plugin: Plugin) -> list[Mapping[str, Any]]:
    """Return a plugin and all that is in it, each once."""
    found: dict[int, Mapping[str, Any]] = {}

    def look(values: Mapping[str, Any], where: str) -> None:
        if id(values) in found:
            return
        found[id(values)] = values
        for name, value in values.items():
            if isinstance(value, Mapping):
                inner = plugin.context.follow(value, where)
                if isinstance(inner, Mapping):
                    look(inner, f"{where}.{name}")

    look(plugin.values, str(plugin))
    return list(found.values())


def read_attribute(path: Path, name: str) -> tuple[bool, Floats]:
    """Return whether an attribute is of faces rather than vertices, and its colors, (N, 3).

    One number counts as a gray.

    Raises
    ------
    ValueError
        If the file has no attribute of the name, or it is not a color.
    """
    of, _, rest = name.partition("_")
    if of not in ("vertex", "face") or not rest:
        raise SceneError(f"an attribute's name must begin with vertex_ or face_, got {name!r}")
    raw = elements_of(path).get(of)
    columns = {} if raw is None else _columns(raw)
    for parts in ([f"{rest}_{end}" for end in ending] for ending in _ENDINGS):
        if all(part in columns for part in parts):
            return of == "face", np.stack([columns[part] for part in parts], -1)
    for parts in (["r", "g", "b"], ["red", "green", "blue"]):
        if rest == "color" and all(part in columns for part in parts):
            whole = np.stack([columns[part] for part in parts], -1)
            return of == "face", whole / 255 if raw and raw.numbers[parts[0]].dtype.kind in "ui" else whole
    for part in (f"{rest}_0", f"{rest}_1", f"{rest}_x", rest):
        if part in columns:
            return of == "face", np.repeat(columns[part][:, None], 3, axis=1)
    raise SceneError(
        f"{path} has no attribute {name!r}; of each {of} it has {', '.join(columns) or 'nothing'}"
    )


def _columns(raw: Data) -> dict[str, Floats]:
    """Return what is one number for each vertex or triangle."""
    polygons = indices_of(raw)
    which = slice(None) if polygons is None else polygon_of(polygons.counts)
    return {name: one[which].astype(np.float64) for name, one in raw.numbers.items()}
