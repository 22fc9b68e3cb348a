"""The closest hits of rays."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from . import rows
from .surface_points import SurfacePoints, leading_shape, one_or_some


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Hits(SurfacePoints):
    """The closest hit of each ray; every array begins with the leading shape of the rays.

    Arrays of floats and bools belong to the caller. Arrays of integers are read-only, because lookups use
    them; results that were computed before would not change.

    Attributes
    ----------
    t : (...) float64
        Distance in units of the direction's length: the hit is at ``origin + t * direction``; inf for a miss.
    shape_id : (...) int32
        Index in ``scene.shapes``; -1 for a miss.
    primitive_id : (...) int32
        Face of that shape, 0 for a curved shape; on an instance, a number for `Instance.locate`.
    uv : (..., 2) float64
        Barycentric weights of the face's second and third corner, so that the hit is at
        ``(1 - u - v) * a + u * b + v * c`` for corners a, b, c; on a curved shape, its own u and v.

    See Also
    --------
    Scene.intersect : Makes it.
    AllHits : Every hit of each ray.

    Examples
    --------
    >>> scene = rw.Scene({"ball": rw.Sphere()})
    >>> hits = scene.intersect([[0, 0, 5], [9, 0, 5]], [0, 0, -1])
    >>> hits
    Hits(shape=(2,), 1 of 2 rays hit)
    >>> hits.shape_id.tolist(), hits.names.tolist()
    ([0, -1], ['ball', ''])
    """

    t: NDArray[np.float64]

    _parts = ("t", "shape_id", "primitive_id", "uv")

    def __init__(
        self,
        t: NDArray[np.float64],
        shape_id: NDArray[np.int32],
        primitive_id: NDArray[np.int32],
        uv: NDArray[np.float64],
        instance_id: NDArray[np.int32] | None,
        compiled: _core.CompiledScene,
        rays: tuple[Any, ...] | None = None,
    ) -> None:
        self._tell(t, shape_id, primitive_id, uv, instance_id, compiled, rays)

    @classmethod
    def _on_meshes(
        cls,
        t: NDArray[np.float64],
        shape_id: NDArray[np.int32],
        primitive_id: NDArray[np.int32],
        uv: NDArray[np.float64],
        instance_id: NDArray[np.int32] | None,
        compiled: _core.CompiledScene,
    ) -> Hits:
        """Return hits as `__init__` makes them, in half the time."""
        hits = cls.__new__(cls)
        own = hits.__dict__
        own["t"] = t
        own["shape_id"] = shape_id
        own["primitive_id"] = primitive_id
        own["uv"] = uv
        own["_compiled"] = compiled
        own["_rays"] = None
        if instance_id is not None:
            own["instance_id"] = instance_id
        return hits

    def _tell_some(
        self,
        parts: dict[str, NDArray[Any]],
        fields: tuple[str, ...],
        compiled: _core.CompiledScene | None,
        rays: tuple[Any, ...] | None,
    ) -> Hits:
        """Tell of these hits no more than some parts, forget what was worked out of others, and return it."""
        self.__dict__.clear()
        self.__dict__.update(parts, _fields=fields, _compiled=compiled, _rays=rays)
        return self

    def _tell(
        self,
        t: NDArray[np.float64],
        shape_id: NDArray[np.int32],
        primitive_id: NDArray[np.int32],
        uv: NDArray[np.float64],
        instance_id: NDArray[np.int32] | None,
        compiled: _core.CompiledScene,
        rays: tuple[Any, ...] | None,
    ) -> None:
        """Take these hits, and forget results computed for others."""
        self.__dict__.clear()
        # Setting the fields of a frozen dataclass takes longer than tracing a ray.
        self.__dict__.update(
            t=t, shape_id=shape_id, primitive_id=primitive_id, uv=uv, _compiled=compiled, _rays=rays
        )
        if instance_id is not None:
            self.__dict__["instance_id"] = instance_id

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            fields = vars(self).get("_fields")
            if fields is None or name.startswith("__"):
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            raise AttributeError(f"hits that were found with fields={fields} have no {name}")

    @cached_property
    def hit(self) -> NDArray[np.bool_]:
        """Whether each ray hits anything: (...) bool."""
        own = vars(self)
        if "primitive_id" not in own and "shape_id" in own:
            return np.asarray(self.shape_id >= 0)
        return np.asarray(self.primitive_id >= 0)

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading shape of the rays."""
        return leading_shape(vars(self))

    def __getitem__(self, index: Any) -> Hits:
        """Return the hits at some places of the leading shape, which is indexed as arrays are."""
        return one_or_some(Hits, self, index)

    def __iter__(self) -> Iterator[Hits]:
        return (self[i] for i in range(len(self)))

    def __len__(self) -> int:
        return rows.length(self.shape)

    def __repr__(self) -> str:
        if not {"hit", "primitive_id", "shape_id"} & set(vars(self)):
            return f"Hits(shape={self.shape}, fields={self._asked()})"
        count = int(np.count_nonzero(self.hit))
        return f"Hits(shape={self.shape}, {count} of {self.hit.size} rays hit)"


@contextmanager
def rewritten(out: Hits, shape: tuple[int, ...]) -> Iterator[tuple[Any, ...]]:
    """Give the arrays of hits of rays of a leading shape, which can be written to meanwhile."""
    if not isinstance(out, Hits):
        raise TypeError(f"out must be Hits or arrays by name, got {type(out).__name__}")
    if out.shape != shape:
        raise ValueError(f"out has shape {out.shape}, expected {shape}")
    instance_id = vars(out).get("instance_id")
    if instance_id is not None and not instance_id.flags.owndata:
        # One element seen from every index.
        instance_id = None
    # What an earlier answer left out, or told in another type, is new.
    types = {"t": np.float64, "shape_id": np.int32, "primitive_id": np.int32, "uv": np.float64}
    own = {name: vars(out).get(name) for name in types}
    arrays = tuple(a if a is not None and a.dtype == types[name] else None for name, a in own.items())
    known = [array for array in (*arrays, instance_id) if array is not None]
    try:
        for array in known:
            if not array.flags.owndata:
                raise ValueError("out cannot be written to: its arrays are views of other memory")
            array.setflags(write=True)
        yield (*arrays, instance_id)
    finally:
        for array in known:
            rows.kept(array)
