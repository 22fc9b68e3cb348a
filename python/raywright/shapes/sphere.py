"""The sphere."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, positive, triple
from ..lights.emission import EmissionLike
from ..materials import Material
from .shape import Shape


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Sphere(Shape):
    """All points at one distance from a center.

    Hits are exact, and `t` is correct to the last place, also for small and distant spheres: the discriminant
    is that of the ray's closest approach (Haines et al., "Precision Improvements for Ray/Sphere
    Intersection", 2019).

    Parameters
    ----------
    center : 3 floats
        Its center.
    radius : float
        Distance of the surface from the center, greater than 0.
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
        If the radius is not greater than 0, or a number is not finite.
        If the transform is not a finite affine (4, 4) matrix, or has no inverse.
    TypeError
        If an argument has another type.

    See Also
    --------
    Ellipsoid : Three axes.

    Notes
    -----
    ``u`` is the longitude about +z from +x on, in turns; ``v`` the latitude, from 0 at the pole on -z to 1 at
    the pole on +z. A tangent ray is a hit, but not a crossing. As a light, it is sampled uniformly in the
    cone of directions that it fills, or from inside in all directions.

    Examples
    --------
    >>> ball = rw.Sphere((0, 0, 0), radius=2)
    >>> round(ball.area / np.pi, 9)
    16.0
    >>> rw.Scene(ball).intersect([0, 0, 5], [0, 0, -1]).t.item()
    3.0
    """

    center: Triple
    radius: float

    def __init__(
        self,
        center: ArrayLike = (0.0, 0.0, 0.0),
        radius: float = 1.0,
        *,
        transform: ArrayLike | None = None,
        material: Material | None = None,
        emission: EmissionLike | None = None,
        name: str | None = None,
    ) -> None:
        self._set(
            transform,
            material,
            emission,
            name,
            center=triple("center", center),
            radius=positive("radius", radius),
        )
