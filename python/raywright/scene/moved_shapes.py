"""Shapes of a scene whose vertices are moved."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..shapes.mesh_changes import moved
from .instance import AnyShape, Instance


def moved_shapes(
    shapes: tuple[AnyShape, ...], vertices: ArrayLike | Sequence[ArrayLike | None]
) -> tuple[AnyShape, ...]:
    """Return the shapes with their vertices, or the transforms of their copies, as `Scene.refit` takes them.

    Raises
    ------
    ValueError, TypeError
        As `Scene.refit` does.
    """
    count = len(shapes)
    if count == 1 and isinstance(shapes[0], Instance):
        only = vertices[0] if isinstance(vertices, list) and len(vertices) == 1 else vertices
        return (shapes[0] if only is None else _moved(shapes[0], "vertices", only),)
    given = list(vertices) if isinstance(vertices, list | tuple) else None
    if count == 1 and not (given and len(given) == 1 and (given[0] is None or np.ndim(given[0]) == 2)):
        return (_moved(shapes[0], "vertices", vertices),)
    if given is None or len(given) != count:
        came = "an array" if given is None else str(len(given))
        raise ValueError(f"vertices must be a list of {count} array{'' if count == 1 else 's'}, got {came}")
    return tuple(
        shape if to is None else _moved(shape, f"vertices[{i}]", to)
        for i, (shape, to) in enumerate(zip(shapes, given, strict=True))
    )


def _moved(shape: AnyShape, name: str, to: Any) -> AnyShape:
    if not isinstance(shape, Instance):
        return moved(shape, name, to)
    return shape.moved(*to) if isinstance(to, tuple) else shape.moved(to)
