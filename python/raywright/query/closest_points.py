"""The closest points of surfaces to points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..arrays import sealed
from .surface_points import SurfacePoints, one_or_some


@dataclass(frozen=True, eq=False, repr=False, init=False)
class ClosestPoints(SurfacePoints):
    """The closest point of the surface to each point; every array begins with their leading shape.

    Arrays of integers are read-only, as in `Hits`.

    Attributes
    ----------
    distance : (...) float64
        Distance to the closest point; inf if none is near enough.
    shape_id : (...) int32
        Index in ``scene.shapes``; -1 for none.
    primitive_id : (...) int32
        Face of that shape, 0 for a curved shape; on an instance, a number for `Instance.locate`.
    uv : (..., 2) float64
        Barycentric weights of the face's second and third corner, so that the closest point is at
        ``(1 - u - v) * a + u * b + v * c`` for corners a, b, c; on a curved shape, its own u and v.

    See Also
    --------
    Scene.closest_point : Makes it.

    Examples
    --------
    >>> found = rw.Scene(rw.Sphere()).closest_point([[0, 0, 3], [0, 2, 0]])
    >>> found.distance.tolist(), found.position.round(9).tolist()
    ([2.0, 1.0], [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
    """

    distance: NDArray[np.float64]

    _parts = ("distance", "shape_id", "primitive_id", "uv")

    def __init__(
        self,
        distance: NDArray[np.float64],
        position: NDArray[np.float64],
        shape_id: NDArray[np.int32],
        primitive_id: NDArray[np.int32],
        uv: NDArray[np.float64],
        instance_id: NDArray[np.int32] | None,
        compiled: _core.CompiledScene,
    ) -> None:
        parts = {"distance": distance, "shape_id": shape_id, "primitive_id": primitive_id, "uv": uv}
        if instance_id is not None:
            parts["instance_id"] = instance_id
        # The position is known already, and goes where cached_property keeps its values.
        self.__dict__.update(parts, position=position, _compiled=compiled, _rays=None)

    @cached_property
    def _site(self) -> NDArray[np.float64]:
        """The unit normal, and a bound on how far each coordinate of `position` is off: (..., 4) float64."""
        instance_id = vars(self).get("instance_id")
        copies = None if instance_id is None else np.ascontiguousarray(instance_id).reshape(-1)
        places = self.uv.reshape(-1, 2), self.position.reshape(-1, 3), copies
        known = self._known("normal")
        sites = known.sites(self.shape_id.reshape(-1), self.primitive_id.reshape(-1), *places)
        return sealed(sites.reshape(*self.primitive_id.shape, 4))

    @cached_property
    def normal(self) -> NDArray[np.float64]:
        """Unit geometric normal, outward on closed shapes: (..., 3) float64; NaN for none."""
        return self._site[..., :3].copy() if self._known("normal").curved else super().normal

    @cached_property
    def _error(self) -> NDArray[np.float64]:
        return sealed(self._site[..., 3].copy()) if self._known("_error").curved else super()._error

    @cached_property
    def found(self) -> NDArray[np.bool_]:
        """Mask of points with a surface near enough: (...) bool."""
        return np.asarray(self.primitive_id >= 0)

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading shape of the points."""
        return self.distance.shape

    def __getitem__(self, index: Any) -> ClosestPoints:
        """Return the closest points at some places of the leading shape, which is indexed as arrays are."""
        return one_or_some(ClosestPoints, self, index)

    def __iter__(self) -> Iterator[ClosestPoints]:
        return (self[i] for i in range(len(self)))

    def __len__(self) -> int:
        return len(self.distance)

    def __repr__(self) -> str:
        count = int(np.count_nonzero(self.found))
        return f"ClosestPoints(shape={self.shape}, {count} of {self.distance.size} found)"
