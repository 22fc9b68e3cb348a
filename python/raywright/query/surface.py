"""Differential geometry at hits."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, repr=False)
class Surface:
    """Differential geometry at hits; all arrays are float64, and NaN for misses.

    Attributes
    ----------
    position : (..., 3)
        Positions of the points.
    error : (...)
        Error bound: maximum distance of each coordinate of `position` from a point of the surface.
    normal : (..., 3)
        Unit geometric normal: as the winding gives it, or to the outside of a closed shape.
    shading_normal : (..., 3)
        Unit normal interpolated from those of vertices, on the side of `normal`; equal to `normal` without
        vertex normals.
    dp_du, dp_dv : (..., 3)
        Derivatives of the position with respect to u and v.
    dn_du, dn_dv : (..., 3)
        Derivatives of the unit shading normal with respect to u and v.

    See Also
    --------
    Hits.surface : Makes it.

    Examples
    --------
    >>> surface = rw.Scene(rw.Sphere()).intersect([0, 0, 5], [0, 0, -1]).surface
    >>> surface.position.tolist(), surface.dp_dv.round(9).tolist()
    ([0.0, 0.0, 1.0], [-3.141592654, -0.0, 0.0])
    >>> bool(surface.error < 1e-14)
    True
    """

    position: NDArray[np.float64]
    error: NDArray[np.float64]
    normal: NDArray[np.float64]
    shading_normal: NDArray[np.float64]
    dp_du: NDArray[np.float64]
    dp_dv: NDArray[np.float64]
    dn_du: NDArray[np.float64]
    dn_dv: NDArray[np.float64]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Surface):
            return NotImplemented
        pairs = ((getattr(self, part.name), getattr(other, part.name)) for part in fields(self))
        return all(np.array_equal(a, b, equal_nan=True) for a, b in pairs)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"Surface(shape={self.error.shape})"
