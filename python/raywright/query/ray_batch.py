"""Batches of rays of unit direction, as integrators written in Python take them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import last_axis, real_array

Floats: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Rays:
    """A batch of rays.

    Attributes
    ----------
    origins, directions : (N, 3) float64
        Directions are unit.
    time : (N,) float64
        Times of the rays, from 0 as the shutter opens to 1 as it closes.

    See Also
    --------
    Scene.interactions : Takes them.

    Examples
    --------
    >>> rays = rw.query.Rays(np.zeros((2, 3)), np.array([[0, 0, 1.0], [1.0, 0, 0]]), np.zeros(2))
    >>> rays.directions.shape
    (2, 3)
    """

    origins: Floats
    directions: Floats
    time: Floats

    def __post_init__(self) -> None:
        for name, tail in (("origins", (3,)), ("directions", (3,)), ("time", ())):
            array = numbers(name, getattr(self, name))
            object.__setattr__(self, name, array)
            if array.shape[1:] != tail or array.ndim != 1 + len(tail) or len(array) != len(self.origins):
                shapes = [np.shape(getattr(self, part)) for part in ("origins", "directions", "time")]
                raise ValueError(f"rays must have shapes (N, 3), (N, 3) and (N,), got {shapes}")

    def __len__(self) -> int:
        return len(self.directions)

    def __getitem__(self, which: Any) -> Rays:
        return Rays(self.origins[which], self.directions[which], self.time[which])

    def __repr__(self) -> str:
        return f"Rays({len(self)})"


def vectors(name: str, value: ArrayLike) -> Floats:
    """Return vectors as an (N, 3) float64 array."""
    array = np.ascontiguousarray(last_axis(name, value, 3), np.float64)
    if array.ndim != 2:
        raise ValueError(f"{name} must have shape (N, 3), got {array.shape}")
    return array


def numbers(name: str, value: ArrayLike) -> Floats:
    """Return real numbers as a C-contiguous float64 array."""
    return np.ascontiguousarray(real_array(name, value), np.float64)
