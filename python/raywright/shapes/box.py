"""The box along the axes."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, triple
from ..lights.emission import EmissionLike
from ..materials import Material
from .shape import Shape


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Box(Shape):
    """All points between two corners, borders included.

    It is a solid: a ray that runs in a face or along an edge meets it. For other axes, use a `transform`.

    Parameters
    ----------
    min, max : 3 floats
        The least and the greatest corner. They may be equal along an axis, and the box flat.
    transform : (4, 4) array, optional
        An affine matrix that acts on column vectors (x, y, z, 1), from the shape's own space to the world.
        Hits are exact for the given matrix, not for a rounded inverse.
    material : Material, optional
        Material of the surface; ``Diffuse()`` if not given.
    emission : float, 3 floats, Texture or Emission, optional
        Radiance that the outer side emits, in W·sr⁻¹·m⁻²; None, the default, for a shape without emission.
    name : str, optional
        Name that `Hits.names` returns.

    Raises
    ------
    ValueError
        If a coordinate of `min` is greater than that of `max`, or a number is not finite.
        If the transform is not a finite affine (4, 4) matrix, or has no inverse.
    TypeError
        If an argument has another type.

    See Also
    --------
    Mesh : Triangles.

    Notes
    -----
    The unit square of ``u`` and ``v`` has a rectangle for each face: three columns for the faces at right
    angles to x, y and z, and two rows for the lesser and the greater face.

    Examples
    --------
    >>> box = rw.Box((0, 0, 0), (1, 2, 3))
    >>> box.area, box.bounds.tolist()
    (22.0, [[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]])
    >>> rw.Scene(box).intersect([0.5, 0.5, 9], [0, 0, -1]).t.item()
    6.0
    """

    min: Triple
    max: Triple

    def __init__(
        self,
        min: ArrayLike = (0.0, 0.0, 0.0),
        max: ArrayLike = (1.0, 1.0, 1.0),
        *,
        transform: ArrayLike | None = None,
        material: Material | None = None,
        emission: EmissionLike | None = None,
        name: str | None = None,
    ) -> None:
        low, high = triple("min", min), triple("max", max)
        for axis, a, b in zip("xyz", low, high, strict=True):
            if a > b:
                raise ValueError(
                    f"min must not be greater than max, but its {axis} is {a}, and that of max {b}"
                )
        self._set(
            transform,
            material,
            emission,
            name,
            min=low,
            max=high,
        )
