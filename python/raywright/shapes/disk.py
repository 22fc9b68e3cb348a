"""The disk."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, number, positive, triple
from ..lights.emission import EmissionLike
from ..materials import Material
from .shape import Shape, direction


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Disk(Shape):
    """A disk, or an annulus with a round hole; its rims are included.

    Parameters
    ----------
    center : 3 floats
        Its center.
    normal : 3 floats
        Normal, towards the outer side; of any length but 0.
    radius : float
        The distance of its rim, greater than 0.
    inner_radius : float
        The distance of the rim of a round hole, at least 0 and less than `radius`; 0, the default, for none.
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
        If a radius is out of its range, the normal has no length, or a number is not finite.
        If the transform is not a finite affine (4, 4) matrix, or has no inverse.
    TypeError
        If an argument has another type.

    See Also
    --------
    Plane : Without a rim.

    Notes
    -----
    ``u`` is the angle about the normal, in turns; ``v`` runs from 0 at the rim to 1 at the hole or the
    center.

    Examples
    --------
    >>> ring = rw.Disk(radius=2, inner_radius=1)
    >>> rw.Scene(ring).intersect([[0, 0, 1], [1.5, 0, 1]], [0, 0, -1]).hit.tolist()
    [False, True]
    """

    center: Triple
    normal: Triple
    radius: float
    inner_radius: float

    def __init__(
        self,
        center: ArrayLike = (0.0, 0.0, 0.0),
        normal: ArrayLike = (0.0, 0.0, 1.0),
        radius: float = 1.0,
        inner_radius: float = 0.0,
        *,
        transform: ArrayLike | None = None,
        material: Material | None = None,
        emission: EmissionLike | None = None,
        name: str | None = None,
    ) -> None:
        outer, inner = positive("radius", radius), number("inner_radius", inner_radius)
        if not 0 <= inner < outer:
            raise ValueError(f"inner_radius must be at least 0 and less than radius = {outer}, got {inner}")
        self._set(
            transform,
            material,
            emission,
            name,
            center=triple("center", center),
            normal=direction("normal", normal),
            radius=outer,
            inner_radius=inner,
        )
