"""Rays and points as the core takes them."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import last_axis, real_array, thread_limit

Floats: TypeAlias = NDArray[np.floating[Any]]
RayArguments: TypeAlias = tuple[
    Floats,
    Floats,
    float | NDArray[np.float64],
    float | NDArray[np.float64],
    tuple[int, ...],
    int | None,
    float | NDArray[np.float64] | None,
]
# Rays as the core takes them: with a mask of active rays, or None for all.
AskedRays: TypeAlias = tuple[
    Floats,
    Floats,
    float | NDArray[np.float64],
    float | NDArray[np.float64],
    tuple[int, ...],
    int | None,
    float | NDArray[np.float64] | None,
    NDArray[np.bool_] | None,
]


def ray_arguments(
    origins: ArrayLike,
    directions: ArrayLike,
    t_min: ArrayLike,
    t_max: ArrayLike,
    threads: int | None,
    time: ArrayLike | None = None,
) -> RayArguments:
    """Return checked, broadcast rays as the core takes them.

    C-contiguous float32 and float64 arrays pass as they are; each array has one row, or one for each ray. The
    core gets a strided view of broadcast arrays, and copies a chunk of it at a time.

    Returns
    -------
    origins, directions, t_min, t_max, shape, threads, time
        `shape` is the leading shape of the rays; `time` may be None, which is 0 for all. With a mask, from
        `masks.asked`, they are compressed to the masked rays.
    """
    starts = last_axis("origins", origins, 3)
    ways = last_axis("directions", directions, 3)
    near = _distances("t_min", t_min)
    far = _distances("t_max", t_max)
    threads = thread_limit(threads)
    when = None if time is None else _times(time)
    shape, lead = starts.shape[:-1], ways.shape[:-1]
    is_usual = type(near) is float and type(far) is float and not isinstance(when, np.ndarray)
    if is_usual and (not lead or not shape or shape == lead):
        # Ordinary rays need no broadcasting; for a few rays it would take as long as tracing.
        return _rows(starts, shape), _rows(ways, lead), near, far, shape or lead, threads, when
    parts = {"origins": shape, "directions": lead, "t_min": np.shape(near), "t_max": np.shape(far)}
    if isinstance(when, np.ndarray):
        parts["time"] = when.shape
    try:
        shape = np.broadcast_shapes(*parts.values())
    except ValueError:
        told = ", ".join(f"{name} {lead}" for name, lead in parts.items())
        raise ValueError(f"leading shapes do not broadcast: {told}") from None
    near, far = (view(x, shape) if isinstance(x, np.ndarray) else x for x in (near, far))
    when = view(when, shape) if isinstance(when, np.ndarray) else when
    return view(starts, shape, 1), view(ways, shape, 1), near, far, shape, threads, when


def written_to(
    name: str, array: Any, shape: tuple[int, ...], types: tuple[np.dtype[Any], ...]
) -> NDArray[Any]:
    """Check an array of one of some types that an answer is written to, and return it."""
    if not isinstance(array, np.ndarray) or array.dtype not in types:
        came = f"dtype {array.dtype}" if isinstance(array, np.ndarray) else type(array).__name__
        raise TypeError(f"{name} must be an array of {' or '.join(map(str, types))}, got {came}")
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    if not (array.flags.c_contiguous and array.flags.aligned and array.flags.writeable):
        raise ValueError(f"{name} must be C-contiguous and writable")
    return array


def point_arguments(points: ArrayLike, threads: int | None) -> tuple[Floats, tuple[int, ...], int | None]:
    """Return checked points as the core takes them: the points, their leading shape, and threads."""
    array = _in_order(last_axis("points", points, 3))
    return array, array.shape[:-1], thread_limit(threads)


def nearest_arguments(
    points: ArrayLike, max_distance: ArrayLike, threads: int | None
) -> tuple[Floats, float | NDArray[np.float64], tuple[int, ...], int | None]:
    """Return checked points and distances as the core takes them: both, their leading shape, and threads."""
    array, shape, threads = point_arguments(points, threads)
    most = _distances("max_distance", max_distance)
    # For one number, np.min takes longer than the query of one point.
    if (most if isinstance(most, float) else np.min(most, initial=0.0)) < 0:
        raise ValueError(f"max_distance must be at least 0, got {np.min(most)}")
    if isinstance(most, np.ndarray):
        try:
            lead = np.broadcast_shapes(shape, most.shape)
        except ValueError:
            told = f"points {shape}, max_distance {most.shape}"
            raise ValueError(f"leading shapes do not broadcast: {told}") from None
        array, most, shape = spread(array, lead, (3,)), spread(most, lead), lead
    return array, most, shape, threads


def _times(value: ArrayLike) -> float | NDArray[np.float64]:
    # A copy for the hits, which must not change with the caller's array.
    array = np.array(real_array("time", value), np.float64)
    inside = (array >= 0) & (array <= 1)
    if not inside.all():
        raise ValueError(f"time must be between 0 and 1, got {array[~inside].flat[0]}")
    return array if array.ndim else float(array)


def _distances(name: str, value: ArrayLike) -> float | NDArray[np.float64]:
    if type(value) is not float:
        array = real_array(name, value).astype(np.float64, copy=False)
        if array.ndim:
            if np.isnan(array).any():
                raise ValueError(f"{name} must not be NaN")
            return array
        value = float(array)
    if value != value:
        raise ValueError(f"{name} must not be NaN")
    return value


def _in_order(array: NDArray[Any]) -> NDArray[Any]:
    """Return it C-contiguous and aligned."""
    flags = array.flags
    return array if flags.c_contiguous and flags.aligned else np.require(array, requirements=["C", "A"])


def _rows(array: NDArray[Any], lead: tuple[int, ...]) -> NDArray[Any]:
    """Return what `view` does of vectors whose leading shape this is."""
    flags = array.flags
    return array if flags.c_contiguous and flags.aligned else view(array, lead, 1)


def view(array: NDArray[Any], lead: tuple[int, ...], columns: int = 0) -> NDArray[Any]:
    """Return it with a row for each ray, C-contiguous but where it repeats; or one row for all."""
    if array.flags.c_contiguous and array.flags.aligned:
        base = array
    else:
        steps = array.strides[: array.ndim - columns]
        base = _in_order(array[tuple(slice(None) if step else slice(1) for step in steps)])
    shape = lead + base.shape[base.ndim - columns :]
    if base.size == math.prod(shape[len(lead) :]):
        return base
    if base.size == math.prod(shape):
        # Only dimensions of length one differ.
        return base.reshape(shape)
    return np.broadcast_to(base, shape)


def spread(array: NDArray[Any], lead: tuple[int, ...], columns: tuple[int, ...] = ()) -> NDArray[Any]:
    """Return it C-contiguous, with a row for each ray unless it is one row, which serves for all."""
    shape = (*lead, *columns)
    one = array.size == math.prod(columns)
    return _in_order(array if one or array.shape == shape else np.broadcast_to(array, shape))
