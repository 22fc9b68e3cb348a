"""Values that meshes have, where points are on them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..shapes.mesh import Mesh

Integers: TypeAlias = NDArray[np.integer[Any]]


def cells(shapes: Sequence[Any], shape_id: Integers, primitive_id: Integers) -> NDArray[np.int64]:
    """Return the cell of each point: (...) int64; -1 for none."""
    result = np.full(primitive_id.size, -1, np.int64)
    for shape, which, own in _by_shape(shapes, shape_id.reshape(-1), primitive_id.reshape(-1)):
        known = shape.cells if isinstance(shape, Mesh) else None
        result[which] = own if known is None else known[own]
    return result.reshape(primitive_id.shape)


def interpolated(
    shapes: Sequence[Any], name: str, shape_id: Integers, primitive_id: Integers, uv: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return an attribute at points, as `Hits.interpolate` does."""
    if not isinstance(name, str):
        raise TypeError(f"name must be a str, got {type(name).__name__}")
    shape_of_value = _value_shape(shapes, name)
    weights = uv.reshape(-1, 2)
    result = np.full((primitive_id.size, *shape_of_value), np.nan)
    for shape, which, own in _by_shape(shapes, shape_id.reshape(-1), primitive_id.reshape(-1)):
        if not isinstance(shape, Mesh):
            continue
        if name in shape.vertex_attributes:
            result[which] = _linear(shape.vertex_attributes[name], shape.faces[own], weights[which])
        elif name in shape.face_attributes:
            result[which] = shape.face_attributes[name][own]
    return result.reshape((*primitive_id.shape, *shape_of_value))


def _linear(values: NDArray[Any], faces: NDArray[np.uint32], uv: NDArray[np.float64]) -> NDArray[np.float64]:
    u, v = (uv[:, k].reshape(-1, *[1] * (values.ndim - 1)) for k in (0, 1))
    a, b, c = (values[faces[:, k]].astype(np.float64, copy=False) for k in range(3))
    return (1.0 - u - v) * a + u * b + v * c


def _value_shape(shapes: Sequence[Any], name: str) -> tuple[int, ...]:
    """Return the shape of one value of an attribute."""
    known: dict[str, set[tuple[int, ...]]] = {}
    for mesh in _meshes(shapes):
        for key, array in {**mesh.face_attributes, **mesh.vertex_attributes}.items():
            known.setdefault(key, set()).add(array.shape[1:])
    if name not in known:
        told = f"there are {', '.join(map(repr, sorted(known)))}" if known else "there are none"
        raise ValueError(f"name must be an attribute of a mesh of the scene, got {name!r}: {told}")
    if len(known[name]) > 1:
        told = " and ".join(map(str, sorted(known[name])))
        raise ValueError(f"name must be an attribute with values of one shape, {name!r} has {told}")
    return known[name].pop()


def _meshes(shapes: Sequence[Any]) -> Iterator[Mesh]:
    """Yield the meshes among shapes, those of instances once."""
    left, seen = list(shapes), set()
    while left:
        shape = left.pop()
        if isinstance(shape, Mesh):
            yield shape
        elif hasattr(shape, "shapes") and id(shape.shapes) not in seen:
            seen.add(id(shape.shapes))
            left += shape.shapes


def _by_shape(
    shapes: Sequence[Any], shape_id: Integers, primitive_id: Integers
) -> Iterator[tuple[Any, Integers, Integers]]:
    """Yield each shape that has points, in instances too, with their places and their faces in it."""
    order = np.argsort(shape_id, kind="stable") if len(shapes) > 1 else np.arange(len(shape_id))
    order = order[shape_id[order] >= 0]
    if not len(order):
        return
    found, starts = np.unique(shape_id[order], return_index=True)
    left = [
        (shapes[i], which, primitive_id[which])
        for i, which in zip(found, np.split(order, starts[1:]), strict=True)
    ]
    while left:
        shape, which, own = left.pop()
        if hasattr(shape, "parts"):
            left += [(inner, which[some], rest) for inner, some, rest in shape.parts(own)]
        else:
            yield shape, which, own
