"""The planar polygon."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .._core import polygon_trouble
from ..arrays import Triple, rows
from ..lights.emission import EmissionLike
from ..materials import Material
from .shape import Shape

Ring = tuple[Triple, ...]


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Polygon(Shape):
    """A flat face, convex or not, with or without holes.

    Hits are decided exactly by its edges, so no ray slips through an edge that two polygons share, or a
    polygon and a float64 mesh. The distance follows from the plane that is fitted to its points.

    Parameters
    ----------
    outline : (N, 3) array
        Its corners in order, at least 3, the last not repeating the first. Seen from the side that the normal
        points to, they run anticlockwise.
    holes : sequence of (N, 3) arrays
        Outlines of its holes, in either orientation.
    transform : (4, 4) array, optional
        An affine matrix that acts on column vectors (x, y, z, 1), from the shape's own space to the world.
        Rays are transformed to the shape's own space and rounded there once, all in the same way, so no ray
        slips between polygons that share an edge and have equal transforms.
    material : Material, optional
        Material of the surface; ``Diffuse()`` if not given.
    emission : float, 3 floats, Texture or Emission, optional
        Radiance that the outer side emits, in W·sr⁻¹·m⁻²; None, the default, for a shape without emission.
    name : str, optional
        Name that `Hits.names` returns.

    Raises
    ------
    ValueError
        If a ring has fewer than 3 corners, a number is not finite, a corner lies off the plane by more than a
        millionth of the diagonal of the box around them, outlines cross or touch themselves or each other,
        or a hole is not inside the outline and outside of the other holes. Tells which and where.
        If the transform is not a finite affine (4, 4) matrix, or has no inverse.
    TypeError
        If an argument has another type.

    See Also
    --------
    Mesh : Many faces.

    Notes
    -----
    ``u`` runs along the first edge of the outline and ``v`` to the left of it, each from 0 to 1 over the
    outline's extent. Rays exactly in its plane do not hit it.

    Examples
    --------
    >>> frame = rw.Polygon(
    ...     [[0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0]],
    ...     holes=[[[1, 1, 0], [2, 1, 0], [2, 2, 0], [1, 2, 0]]],
    ... )
    >>> frame.area
    8.0
    >>> rw.Scene(frame).intersect([[0.5, 0.5, 1], [1.5, 1.5, 1]], [0, 0, -1]).hit.tolist()
    [True, False]
    """

    outline: Ring
    holes: tuple[Ring, ...]

    def __init__(
        self,
        outline: ArrayLike,
        holes: Sequence[ArrayLike] = (),
        *,
        transform: ArrayLike | None = None,
        material: Material | None = None,
        emission: EmissionLike | None = None,
        name: str | None = None,
    ) -> None:
        border = _ring("outline", outline)
        inner = tuple(_ring(f"holes[{i}]", hole) for i, hole in enumerate(holes))
        trouble = polygon_trouble(border, inner)
        if trouble is not None:
            raise ValueError(f"polygon: {trouble}")
        self._set(transform, material, emission, name, outline=border, holes=inner)


def _ring(name: str, value: ArrayLike) -> Ring:
    return tuple((x, y, z) for x, y, z in rows(name, value, 3).astype(np.float64).tolist())
