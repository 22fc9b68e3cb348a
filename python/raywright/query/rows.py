"""Indexing of results by ray, and results as columns of a table."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .surface import Surface

# Attributes with several components.
_WIDE = ("uv", "position", "normal")
# Suffixes of columns for arrays with a second dimension, and the attributes of hits in a table.
_AXES = {2: ("u", "v"), 3: ("x", "y", "z")}
_TOLD = ("t", "distance", "shape_id", "names", "instance_id", "primitive_id", "uv", "position", "normal")


def places(shape: tuple[int, ...], index: Any) -> NDArray[np.int64]:
    """Return by number, in C order, the places of a leading shape that an index picks, in the shape picked.

    Raises
    ------
    IndexError
        As indexing an array of the shape does.
    """
    return np.asarray(np.arange(np.prod(shape, dtype=np.int64)).reshape(shape)[index])


def picked(own: dict[str, Any], which: NDArray[np.int64]) -> dict[str, Any]:
    """Return the private data of some points: copies."""
    parts = {name: value for name, value in own.items() if name not in ("_compiled", "_rays")}
    return {name: _some(name, value, which) for name, value in parts.items()}


def _some(name: str, value: Any, which: NDArray[np.int64]) -> Any:
    if isinstance(value, Surface):
        lead = value.error.ndim
        return Surface(*(_rows(part, lead, which) for part in vars(value).values()))
    if not isinstance(value, np.ndarray):
        return value
    return _rows(value, value.ndim - (name in _WIDE), which)


def _rows(array: NDArray[Any], lead: int, which: NDArray[np.int64]) -> NDArray[Any]:
    return kept(np.array(array.reshape(-1, *array.shape[lead:])[which]))


def place(shape: tuple[int, ...], index: Any) -> int | None:
    """Return which of the first dimension an index picks, counted from 0, if it is one integer; or None.

    Raises
    ------
    IndexError
        If there are not so many.
    """
    if not shape or isinstance(index, bool | np.bool_) or not isinstance(index, int | np.integer):
        return None
    if not -shape[0] <= index < shape[0]:
        raise IndexError(f"index {index} is out of bounds for axis 0 with size {shape[0]}")
    return int(index) % shape[0]


def run(shape: tuple[int, ...], first: int) -> NDArray[np.int64]:
    """Return by number the places of a leading shape at one of its first dimension."""
    count = math.prod(shape[1:])
    return np.arange(first * count, (first + 1) * count).reshape(shape[1:])


def cut(own: dict[str, Any], which: int | slice) -> dict[str, Any]:
    """Return the private data of one place of the first dimension or of a run: copies."""
    parts = {name: value for name, value in own.items() if name not in ("_compiled", "_rays")}
    return {name: _cut(value, which) for name, value in parts.items()}


def _cut(value: Any, which: int | slice) -> Any:
    if isinstance(value, Surface):
        return Surface(*(_cut(part, which) for part in vars(value).values()))
    if not isinstance(value, np.ndarray):
        return value
    return kept(np.array(value[which]))


def rays_of(rays: tuple[Any, ...] | None, which: NDArray[np.int64]) -> tuple[Any, ...] | None:
    """Return the origins, directions and times of some rays; one of any that serves for all still does."""
    if rays is None:
        return None
    starts, ways, time = rays
    if isinstance(time, np.ndarray) and time.size > 1:
        time = _at(time, time.shape, which)
    # Each has the whole leading shape, possibly broadcast, so it is never copied as a whole.
    return (*(ends if ends.size == 3 else _at(ends, ends.shape[:-1], which) for ends in (starts, ways)), time)


def _at(array: NDArray[Any], lead: tuple[int, ...], which: NDArray[np.int64]) -> NDArray[Any]:
    """Return the entries of places of a leading shape, numbered in C order."""
    some: NDArray[Any] = array[np.unravel_index(which, lead)]
    return some


def of_rays(
    splits: NDArray[np.int64], rays: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return where the hits of some rays begin once they follow each other, and which of all they are."""
    counts = np.diff(splits)[rays]
    begins = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    return begins, np.repeat(splits[rays] - begins[:-1], counts) + np.arange(begins[-1])


def filled(some: NDArray[Any], has: NDArray[np.bool_], shape: tuple[int, ...], miss: float) -> NDArray[Any]:
    """Return an entry for each ray: the next of the found ones for hits, and the miss value otherwise."""
    every = np.full((len(has), *some.shape[1:]), miss, some.dtype)
    every[has] = some
    return kept(every.reshape((*shape, *some.shape[1:])))


def kept(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array, read-only where it leads back into the scene, as numbers of shapes and faces do."""
    if array.dtype.kind not in "fb":
        array.setflags(write=False)
    return array


def length(shape: tuple[int, ...]) -> int:
    """Return the first of a leading shape.

    Raises
    ------
    TypeError
        If it has none.
    """
    if not shape:
        raise TypeError("hits of one ray have no length")
    return shape[0]


def copied(own: dict[str, Any], memo: dict[int, Any]) -> dict[str, Any]:
    """Return copies of the private data, except for the scene."""
    return {name: copy.deepcopy(v, memo) for name, v in own.items() if name not in ("_compiled", "_rays")}


def flat(points: Any) -> dict[str, NDArray[Any]]:
    """Return columns by name, with an entry for each point."""
    columns: dict[str, NDArray[Any]] = {}
    if hasattr(type(points), "ray"):
        columns["ray"] = points.ray
    for name in _TOLD:
        # Unpickled points cannot compute further attributes.
        if not hasattr(type(points), name) and name not in vars(points):
            continue
        # Nor of hits that were asked for some parts.
        if "_fields" in vars(points) and name not in vars(points):
            continue
        if points._compiled is None and name not in vars(points) and name != "instance_id":
            continue
        array = getattr(points, name)
        axes = _AXES.get(array.shape[-1]) if name in _WIDE else None
        if axes is None:
            columns[name.removesuffix("s") if name == "names" else name] = array.reshape(-1)
            continue
        prefix = "" if name in ("uv", "position") else f"{name}_"
        columns |= {f"{prefix}{axis}": array[..., i].reshape(-1) for i, axis in enumerate(axes)}
    return columns


def frame(columns: Mapping[str, Sequence[Any] | NDArray[Any]]) -> Any:
    """Return columns as a DataFrame.

    Raises
    ------
    ImportError
        If pandas is not installed.
    """
    try:
        import pandas as pd
    except ImportError:
        raise ImportError("to_dataframe needs pandas, which is not installed: pip install pandas") from None
    return pd.DataFrame(columns)
