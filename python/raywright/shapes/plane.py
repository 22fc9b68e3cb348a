"""The infinite plane."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, triple
from ..lights.emission import EmissionLike
from ..materials import Material
from .shape import Shape, direction


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Plane(Shape):
    """All points of a plane without end.

    It does not count in the bounds of a scene; rays along it pass.

    Parameters
    ----------
    point : 3 floats
        A point on it.
    normal : 3 floats
        Normal, towards the outer side; of any length but 0.
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
        If the normal has no length, or a number is not finite.
        If the transform is not a finite affine (4, 4) matrix, or has no inverse.
    TypeError
        If an argument has another type.

    See Also
    --------
    Disk : With a rim.

    Notes
    -----
    ``u`` and ``v`` run along two unit axes at right angles to the normal (Duff et al. 2017), start at the
    point, and repeat after each unit of length.

    Examples
    --------
    >>> floor = rw.Plane((0, 0, 0), (0, 0, 1))
    >>> rw.Scene(floor).intersect([1e6, 0, 2], [0, 0, -1]).t.item()
    2.0
    >>> floor.area
    inf
    """

    point: Triple
    normal: Triple

    def __init__(
        self,
        point: ArrayLike = (0.0, 0.0, 0.0),
        normal: ArrayLike = (0.0, 0.0, 1.0),
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
            point=triple("point", point),
            normal=direction("normal", normal),
        )
