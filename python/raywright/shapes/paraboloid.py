"""The paraboloid of revolution."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, positive
from ..lights.emission import EmissionLike
from ..materials import Material
from .shape import Shape, segment, switch


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Paraboloid(Shape):
    """The surface of revolution of a parabola about its axis, from its apex to a rim.

    With the radius ``r`` and the distance ``h`` from apex to tip it is ``z = h ρ² / r²``, and its focus
    lies ``r² / 4h`` above the apex: a mirror of focal length ``f`` and radius ``r`` is as high as ``r² /
    4f``.

    Parameters
    ----------
    apex, tip : 3 floats
        Apex, and the middle of the rim, which differ.
    radius : float
        The distance of the rim from the axis, greater than 0.
    capped : bool
        True to close the rim by a disk; False by default.
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
        If apex and tip are the same, the radius is not greater than 0, or a number is not finite.
        If the transform is not a finite affine (4, 4) matrix, or has no inverse.
    TypeError
        If an argument has another type.

    See Also
    --------
    Cone : A straight profile.

    Notes
    -----
    ``u`` is the angle about the axis, in turns, anticlockwise as seen from the tip; ``v`` the distance from
    the axis as a share of the rim's. In a closed shape that is the first half of ``v``; the second half goes
    from the rim to the middle of the cap.

    Examples
    --------
    >>> dish = rw.shapes.Paraboloid((0, 0, 0), (0, 0, 1), radius=2)
    >>> rw.Scene(dish).intersect([[1, 0, 9], [0, 0, 9]], [0, 0, -1]).t.tolist()
    [8.75, 9.0]
    """

    apex: Triple
    tip: Triple
    radius: float
    capped: bool

    def __init__(
        self,
        apex: ArrayLike = (0.0, 0.0, 0.0),
        tip: ArrayLike = (0.0, 0.0, 1.0),
        radius: float = 1.0,
        capped: bool = False,
        *,
        transform: ArrayLike | None = None,
        material: Material | None = None,
        emission: EmissionLike | None = None,
        name: str | None = None,
    ) -> None:
        start, end = segment(("apex", "tip"), apex, tip)
        self._set(
            transform,
            material,
            emission,
            name,
            apex=start,
            tip=end,
            radius=positive("radius", radius),
            capped=switch("capped", capped),
        )
