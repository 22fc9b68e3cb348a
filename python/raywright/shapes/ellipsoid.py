"""The ellipsoid."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, triple
from ..lights.emission import EmissionLike
from ..materials import Material
from .shape import Shape


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Ellipsoid(Shape):
    """A sphere scaled along the axes.

    For other axes than x, y and z, use a `transform`.

    Parameters
    ----------
    center : 3 floats
        Its center.
    semi_axes : 3 floats
        Half its width along x, y and z, each greater than 0.
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
        If a semi-axis is not greater than 0, or a number is not finite.
        If the transform is not a finite affine (4, 4) matrix, or has no inverse.
    TypeError
        If an argument has another type.

    See Also
    --------
    Sphere : Equal axes.

    Notes
    -----
    ``u`` and ``v`` are those of the `Sphere` before scaling. Its area is Carlson's elliptic integral R_G
    (Carlson 1961), and as a light it is sampled like that sphere.

    Examples
    --------
    >>> egg = rw.shapes.Ellipsoid(semi_axes=(1, 1, 2))
    >>> rw.Scene(egg).intersect([[0, 0, 9], [9, 0, 0]], [[0, 0, -1], [-1, 0, 0]]).t.tolist()
    [7.0, 8.0]
    """

    center: Triple
    semi_axes: Triple

    def __init__(
        self,
        center: ArrayLike = (0.0, 0.0, 0.0),
        semi_axes: ArrayLike = (1.0, 1.0, 1.0),
        *,
        transform: ArrayLike | None = None,
        material: Material | None = None,
        emission: EmissionLike | None = None,
        name: str | None = None,
    ) -> None:
        axes = triple("semi_axes", semi_axes)
        if min(axes) <= 0:
            raise ValueError(f"semi_axes must each be greater than 0, got {axes}")
        self._set(
            transform,
            material,
            emission,
            name,
            center=triple("center", center),
            semi_axes=axes,
        )
