"""What rays hit."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core


@dataclass(frozen=True, eq=False, repr=False)
class Hits:
    """The closest hit of each ray; every array begins with the leading shape of the rays, and is read-only.

    Attributes
    ----------
    t : (...) float64
        Distance in lengths of the ray's direction, so that the hit is at ``origin + t * direction``; inf for
        a miss.
    shape_id : (...) int32
        Which of ``scene.shapes``; -1 for a miss.
    primitive : (...) int32
        Which face of that shape; -1 for a miss.
    uv : (..., 2) float64
        Barycentric weights of the face's second and third corner, so that the hit is at
        ``(1 - u - v) * a + u * b + v * c`` for corners a, b, c.
    """

    t: NDArray[np.float64]
    shape_id: NDArray[np.int32]
    primitive: NDArray[np.int32]
    uv: NDArray[np.float64]
    _compiled: _core.CompiledScene = field(repr=False)

    def __post_init__(self) -> None:
        for array in (self.t, self.shape_id, self.primitive, self.uv):
            array.setflags(write=False)

    @cached_property
    def hit(self) -> NDArray[np.bool_]:
        """Whether each ray hits anything: (...) bool."""
        return _sealed(np.asarray(self.primitive >= 0))

    @cached_property
    def instance(self) -> NDArray[np.int32]:
        """Which instance was hit: (...) int32; -1 for a miss and for what is not instanced."""
        # One number seen from every index: scenes without instances spend no memory on them.
        return np.broadcast_to(np.int32(-1), self.t.shape)

    @cached_property
    def position(self) -> NDArray[np.float64]:
        """Where each ray hits, from the corners of the face: (..., 3) float64; NaN for a miss."""
        points = self._compiled.positions(
            self.shape_id.reshape(-1), self.primitive.reshape(-1), self.uv.reshape(-1, 2)
        )
        return _sealed(points.reshape(*self.t.shape, 3))

    @cached_property
    def normal(self) -> NDArray[np.float64]:
        """Unit geometric normal as the winding gives it: (..., 3) float64; NaN for a miss."""
        normals = self._compiled.normals(self.shape_id.reshape(-1), self.primitive.reshape(-1))
        return _sealed(normals.reshape(*self.t.shape, 3))

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading shape of the rays."""
        return self.t.shape

    def __len__(self) -> int:
        return len(self.t)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Hits):
            return NotImplemented
        return all(
            np.array_equal(getattr(self, name), getattr(other, name), equal_nan=name in ("t", "uv"))
            for name in ("t", "shape_id", "primitive", "uv")
        )

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        # The compiled scene is not pickled, so what would be asked of it later is worked out now.
        parts = (self.t, self.shape_id, self.primitive, self.uv, self.position, self.normal)
        return _restored, parts

    def __repr__(self) -> str:
        count = int(np.count_nonzero(self.hit))
        return f"Hits(shape={self.shape}, {count} of {self.t.size} rays hit)"


def _sealed(array: NDArray[Any]) -> NDArray[Any]:
    array.setflags(write=False)
    return array


def _restored(*arrays: NDArray[Any]) -> Hits:
    t, shape_id, primitive, uv, position, normal = arrays
    hits = Hits(t, shape_id, primitive, uv, None)  # type: ignore[arg-type]
    # Where cached_property keeps its values.
    vars(hits).update(position=_sealed(position), normal=_sealed(normal))
    return hits
