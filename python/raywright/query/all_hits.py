"""Every hit of rays."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..arrays import sealed
from . import rows
from .hits import Hits
from .surface import Surface
from .surface_points import SurfacePoints, chosen, restored

# Values of a miss.
_MISSES = {"t": np.inf, "shape_id": -1, "primitive_id": -1, "uv": 0.0, "instance_id": -1}


@dataclass(frozen=True, eq=False, repr=False, init=False)
class AllHits(SurfacePoints):
    """All hits of all rays, in order of ray, then `t`, then (shape_id, primitive_id).

    There are K hits of N rays in all. Those of ray i, with rays counted in C order, are from
    ``ray_splits[i]`` to ``ray_splits[i + 1]``. Arrays of integers are read-only, as in `Hits`.

    Attributes
    ----------
    ray_splits : (N + 1,) int64
        Index of each ray's first hit, and at the end the total number of hits.
    t : (K,) float64
        Distance in units of the direction's length: the hit is at ``origin + t * direction``.
    shape_id : (K,) int32
        Index in ``scene.shapes``.
    primitive_id : (K,) int32
        Face of that shape, 0 for a curved shape; on an instance, a number for `Instance.locate`.
    uv : (K, 2) float64
        Barycentric weights of the face's second and third corner, so that the hit is at
        ``(1 - u - v) * a + u * b + v * c`` for corners a, b, c; on a curved shape, its own u and v.
    shape : tuple of int
        Leading shape of the rays.

    See Also
    --------
    Scene.intersect_all : Makes it.
    Hits : The closest hit of each ray.

    Examples
    --------
    >>> hits = rw.Scene(rw.Sphere()).intersect_all([[0, 0, 5], [9, 0, 5]], [0, 0, -1])
    >>> hits.ray_splits.tolist(), hits.ray.tolist()
    ([0, 2, 2], [0, 0])
    >>> hits.first.t.tolist()
    [4.0, inf]
    """

    ray_splits: NDArray[np.int64]
    t: NDArray[np.float64]
    shape: tuple[int, ...]

    _parts = ("ray_splits", "t", "shape_id", "primitive_id", "uv")

    def __init__(
        self,
        ray_splits: NDArray[np.int64],
        t: NDArray[np.float64],
        shape_id: NDArray[np.int32],
        primitive_id: NDArray[np.int32],
        uv: NDArray[np.float64],
        instance_id: NDArray[np.int32] | None,
        shape: tuple[int, ...],
        compiled: _core.CompiledScene,
        rays: tuple[Any, ...] | None = None,
    ) -> None:
        parts = {
            "ray_splits": ray_splits,
            "t": t,
            "shape_id": shape_id,
            "primitive_id": primitive_id,
            "uv": uv,
        }
        self.__dict__.update(parts, shape=shape, _compiled=compiled, _rays=rays)
        if instance_id is not None:
            self.__dict__["instance_id"] = instance_id

    def _surface(self, ray: NDArray[np.int64] | None) -> Surface:
        return super()._surface(self.ray)

    @cached_property
    def ray(self) -> NDArray[np.int64]:
        """Index of the ray of each hit, along the rays in C order: (K,) int64."""
        return sealed(np.repeat(np.arange(len(self.ray_splits) - 1), np.diff(self.ray_splits)))

    @cached_property
    def count(self) -> NDArray[np.int64]:
        """Number of hits of each ray: (...) int64."""
        return sealed(np.diff(self.ray_splits).reshape(self.shape))

    @cached_property
    def first(self) -> Hits:
        """The first hit of each ray, as `Scene.intersect` finds it."""
        has = self.count.reshape(-1) > 0
        where = self.ray_splits[:-1][has]
        own = {
            name: rows.filled(array[where], has, self.shape, miss)
            for name, miss in _MISSES.items()
            if (array := vars(self).get(name)) is not None
        }
        first = restored(Hits, own, {})
        vars(first).update(_compiled=self._compiled, _rays=self._rays)
        return first

    def __getitem__(self, index: Any) -> AllHits:
        """Return all hits of the rays at some places of the leading shape, which is indexed as arrays are."""
        by_ray = ("ray_splits", "ray", "count", "first", "shape")
        own = {name: v for name, v in vars(self).items() if name not in by_ray}
        one = rows.place(self.shape, index)
        if one is None:
            rays = rows.places(self.shape, index)
            splits, which = rows.of_rays(self.ray_splits, rays.reshape(-1))
            own = rows.picked(own, which)
        else:
            rays = rows.run(self.shape, one)
            begins = self.ray_splits[rays.size * one :][: rays.size + 1]
            splits, own = begins - begins[0], rows.cut(own, slice(begins[0], begins[-1]))
        return chosen(AllHits, self, {**own, "ray_splits": sealed(splits), "shape": rays.shape}, rays)

    def __iter__(self) -> Iterator[AllHits]:
        return (self[i] for i in range(len(self)))

    def _first_rows(self, count: int) -> tuple[int, dict[str, NDArray[Any]]]:
        first = np.arange(min(count, self.t.size))
        rays = np.searchsorted(self.ray_splits, first, side="right") - 1
        some = self[np.unravel_index(np.unique(rays), self.shape)] if self.shape else self
        columns = {name: column[: len(first)] for name, column in rows.flat(some).items()}
        return self.t.size, columns | {"ray": rays}

    def _more(self) -> dict[str, Any]:
        return {"shape": self.shape}

    def __len__(self) -> int:
        return rows.length(self.shape)

    def __repr__(self) -> str:
        return f"AllHits(shape={self.shape}, {self.t.size} hits of {len(self.ray_splits) - 1} rays)"
