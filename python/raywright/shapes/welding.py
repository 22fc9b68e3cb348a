"""Corners of meshes that are one but for rounding."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias, TypeVar, cast

import numpy as np

from .. import _core
from ..arrays import number
from .mesh import Mesh, rounding
from .mesh_changes import moved

Weld: TypeAlias = float | Literal["auto"] | None
_Shape = TypeVar("_Shape")


def weld_tolerance(weld: Weld) -> float | None:
    """Return how close corners are one; None for the rounding of their own precision.

    Raises
    ------
    ValueError
        If it is a text but "auto", or negative or not finite.
    TypeError
        If `weld` is not a number.
    """
    if weld is None or weld is False:
        return 0.0
    if isinstance(weld, str):
        if weld != "auto":
            raise ValueError(f"weld must be 'auto', a distance or None, got {weld!r}")
        return None
    distance = number("weld", weld)
    if distance < 0:
        raise ValueError(f"weld must be at least 0, got {weld}")
    return distance


def welded(shapes: Sequence[_Shape], weld: Weld = "auto") -> tuple[_Shape, ...]:
    """Return shapes with corners of meshes that differ by rounding put in one place.

    A corner on an open edge is put where the first other one is that is as close as `weld` says, unless a
    face has both; so what is closed stays as it is, however thin. Numbers of vertices and faces stay.

    Parameters
    ----------
    shapes : sequence of shapes
        Shapes that are not meshes stay as they are, and so are meshes without a moved corner: the same
        objects.
    weld : "auto", float or None
        How close; "auto" is 2^-21 of the largest coordinate of a mesh where all are float32 numbers and 2^-47
        where not, and a 64th of its mean edge at most, all before it was transformed; between two meshes
        the lesser. None for not at all.
    """
    tolerance = weld_tolerance(weld)
    result = list(shapes)
    which = [i for i, shape in enumerate(shapes) if isinstance(shape, Mesh) and len(shape.faces)]
    meshes = [cast(Mesh, shapes[i]) for i in which]
    if tolerance == 0 or not meshes:
        return tuple(shapes)
    distances = [rounding(mesh) if tolerance is None else tolerance for mesh in meshes]
    if tolerance is None:
        meshes = [_welded([mesh], [by])[0] for mesh, by in zip(meshes, distances, strict=True)]
    if len(meshes) > 1 or tolerance is not None:
        meshes = _welded(meshes, distances)
    for i, mesh in zip(which, meshes, strict=True):
        result[i] = cast(_Shape, mesh)
    return tuple(result)


def _welded(meshes: list[Mesh], distances: list[float]) -> list[Mesh]:
    counts = [len(mesh.vertices) for mesh in meshes]
    starts = np.cumsum([0, *counts])
    corners = np.concatenate([mesh.vertices.astype(np.float64) for mesh in meshes])
    faces = np.concatenate([mesh.faces + np.uint32(at) for mesh, at in zip(meshes, starts, strict=False)])
    places = corners[_core.weld(corners, faces, np.repeat(distances, counts))]
    is_moved = (places != corners).any(axis=1) & np.isfinite(corners).all(axis=1)
    result = list(meshes)
    for i, (mesh, start) in enumerate(zip(meshes, starts, strict=False)):
        own = slice(start, start + len(mesh.vertices))
        if is_moved[own].any():
            # float64 if another mesh has more digits.
            where = places[own]
            single = where.astype(np.float32)
            is_single = mesh.vertices.dtype == np.float32 and np.array_equal(single, where, equal_nan=True)
            result[i] = moved(mesh, "vertices", single if is_single else where)
    return result
