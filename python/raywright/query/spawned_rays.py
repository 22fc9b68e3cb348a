"""Rays that leave surfaces."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..arrays import last_axis
from .rays import spread


class SpawnedRays(NamedTuple):
    """Rays that leave surfaces, as arguments of queries: ``scene.intersect(*rays)``.

    Attributes
    ----------
    origins : (..., 3) float64
        Origins, offset from the surface to the side of the direction; NaN for misses.
    directions : (..., 3) float64 or float32
        Directions as given; broadcast to the shape of the origins.

    See Also
    --------
    Hits.spawn_rays : Makes them.

    Examples
    --------
    >>> scene = rw.Scene(rw.Plane())
    >>> rays = scene.intersect([0, 0, 2], [0, 0, -1]).spawn_rays([0, 0, 1])
    >>> rays.origins.round(9).tolist(), rays.directions.tolist()
    ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0])
    """

    origins: NDArray[np.float64]
    directions: NDArray[np.floating[Any]]


def leaving(
    shape: tuple[int, ...],
    position: NDArray[np.float64],
    error: NDArray[np.float64],
    normal: NDArray[np.float64],
    directions: ArrayLike,
) -> SpawnedRays:
    """Return the rays that leave points of leading shape `shape`."""
    ways = last_axis("directions", directions, 3)
    try:
        lead = np.broadcast_shapes(shape, ways.shape[:-1])
    except ValueError:
        told = f"points {shape}, directions {ways.shape[:-1]}"
        raise ValueError(f"leading shapes do not broadcast: {told}") from None
    count = error.size
    # If the rays' last dimensions are those of the points, the core cycles through the points.
    in_turn = count == 1 or lead[len(lead) - len(shape) :] == shape
    which = None if in_turn else np.broadcast_to(np.arange(count).reshape(shape), lead).reshape(-1)
    parts = position.reshape(-1, 3), error.reshape(-1), normal.reshape(-1, 3)
    origins = _core.spawn_rays(*parts, spread(ways, lead, (3,)), which, lead)
    return SpawnedRays(origins, np.broadcast_to(ways, (*lead, 3)))
