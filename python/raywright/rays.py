"""A batch of rays as the core takes it, and its answers in the shape the caller gave."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import integer, last_axis, real_array


@dataclass(frozen=True, eq=False)
class RayBatch:
    """N rays with leading shape `shape`: arrays of one row, or of N rows, for each part."""

    shape: tuple[int, ...]
    origins: NDArray[Any]
    directions: NDArray[Any]
    t_min: NDArray[np.float64]
    t_max: NDArray[np.float64]
    threads: int | None

    @classmethod
    def of(
        cls,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike,
        t_max: ArrayLike,
        threads: int | None,
    ) -> "RayBatch":
        """Check and broadcast rays; C-contiguous float32 and float64 arrays pass without a copy."""
        starts = last_axis("origins", origins, 3)
        ways = last_axis("directions", directions, 3)
        near = _distances("t_min", t_min)
        far = _distances("t_max", t_max)
        shapes = {
            "origins": starts.shape[:-1],
            "directions": ways.shape[:-1],
            "t_min": near.shape,
            "t_max": far.shape,
        }
        try:
            shape = np.broadcast_shapes(*shapes.values())
        except ValueError:
            told = ", ".join(f"{name} {lead}" for name, lead in shapes.items())
            raise ValueError(f"leading shapes do not broadcast: {told}") from None
        return cls(
            shape,
            _flat(starts, shape),
            _flat(ways, shape),
            _flat(near[..., np.newaxis], shape).reshape(-1),
            _flat(far[..., np.newaxis], shape).reshape(-1),
            None if threads is None else integer("threads", threads, 1),
        )

    def arguments(self) -> tuple[Any, ...]:
        """Give what the core's queries take."""
        # Image-shaped rays are traced in tiles, where neighbours share more than along a row.
        row = self.shape[-1] if len(self.shape) >= 2 else 0
        return self.origins, self.directions, self.t_min, self.t_max, self.threads, row


def _distances(name: str, value: ArrayLike) -> NDArray[np.float64]:
    array = real_array(name, value).astype(np.float64, copy=False)
    if np.isnan(array).any():
        raise ValueError(f"{name} must not be NaN")
    return array


def _flat(array: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    """Rows of `array` for rays of leading shape `shape`: one row if it holds one, else all of them."""
    columns = array.shape[-1]
    if math.prod(array.shape[:-1]) != 1:
        array = np.broadcast_to(array, (*shape, columns))
        return np.require(array.reshape(math.prod(shape), columns), requirements=["C", "A"])
    return np.require(array.reshape(1, columns), requirements=["C", "A"])
