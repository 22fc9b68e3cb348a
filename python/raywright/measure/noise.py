"""Random numbers of beams: functions of seed, beam, return and dimension alone."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .places import Floats, frames

_GOLDEN = math.pi * (3.0 - math.sqrt(5.0))


def uniform(seed: int, beam: NDArray[np.int64], which: NDArray[np.int32], dimension: int) -> Floats:
    """Return a number in [0, 1) for each return."""
    return _core.random_numbers(seed, beam.astype(np.uint32), which.astype(np.uint32), dimension, False)


def normal(seed: int, beam: NDArray[np.int64], which: NDArray[np.int32], dimension: int) -> Floats:
    """Return a number of the standard normal distribution for each return (Box and Muller 1958)."""
    two = _core.random_numbers(seed, beam.astype(np.uint32), which.astype(np.uint32), dimension, True)
    numbers: Floats = np.sqrt(-2.0 * np.log(two[:, 0])) * np.cos(2.0 * math.pi * two[:, 1])
    return numbers


def beams_of(middles: Floats, beams: NDArray[np.int64], divergence: float, rays: int, seed: int) -> Floats:
    """Return unit directions of the rays of each beam, (N, rays, 3): its middle alone if it does not widen.

    They lie on a spiral that is even over the disk of the beam (Vogel 1979), turned at random.
    """
    if rays == 1:
        return middles[:, None]
    turn = 2.0 * math.pi * uniform(seed, beams, np.zeros(len(beams), np.int32), 0)
    angle = turn[:, None] + np.arange(rays) * _GOLDEN
    # Tangents of angles up to the edge of the beam.
    radius = math.tan(math.radians(divergence) / 2.0) * np.sqrt((np.arange(rays) + 0.5) / rays)
    first, second = frames(middles)
    aside = np.cos(angle)[..., None] * first[:, None] + np.sin(angle)[..., None] * second[:, None]
    ways = middles[:, None] + radius[:, None] * aside
    unit: Floats = ways / np.linalg.norm(ways, axis=-1, keepdims=True)
    return unit
