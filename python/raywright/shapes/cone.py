"""The cone and the truncated cone."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, number
from ..lights.emission import EmissionLike
from ..materials import Material
from .shape import Shape, segment, switch


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Cone(Shape):
    """The surface of revolution of a line about a segment, between the planes of the segment's ends.

    Hits are exact, also at its point.

    Parameters
    ----------
    base, tip : 3 floats
        The ends of its axis, which differ.
    base_radius, tip_radius : float
        The distances from the axis at the ends: at least 0, and not both 0.
    capped : bool
        True (the default) to close both ends by disks: then it is a solid, which a ray enters and leaves.
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
        If the ends are the same, a radius is negative or both are 0, or a number is not finite.
        If the transform is not a finite affine (4, 4) matrix, or has no inverse.
    TypeError
        If an argument has another type.

    See Also
    --------
    Cylinder : Equal radii.

    Notes
    -----
    ``u`` is the angle about the axis, in turns, anticlockwise as seen from the tip; ``v`` is the distance
    along the side from the base to the tip, as a share of the whole. For a closed shape it runs from the
    middle of the base cap over its rim, up the side, and in to the middle of the tip cap.

    Examples
    --------
    >>> cone = rw.Cone((0, 0, 0), (0, 0, 2), base_radius=1)
    >>> rw.Scene(cone).intersect([[0, 0, 9], [0.5, 0, 9]], [0, 0, -1]).t.tolist()
    [7.0, 8.0]
    """

    base: Triple
    tip: Triple
    base_radius: float
    tip_radius: float
    capped: bool

    def __init__(
        self,
        base: ArrayLike = (0.0, 0.0, 0.0),
        tip: ArrayLike = (0.0, 0.0, 1.0),
        base_radius: float = 1.0,
        tip_radius: float = 0.0,
        capped: bool = True,
        *,
        transform: ArrayLike | None = None,
        material: Material | None = None,
        emission: EmissionLike | None = None,
        name: str | None = None,
    ) -> None:
        start, end = segment(("base", "tip"), base, tip)
        radii = number("base_radius", base_radius), number("tip_radius", tip_radius)
        for name, radius in zip(("base_radius", "tip_radius"), radii, strict=True):
            if radius < 0:
                raise ValueError(f"{name} must be at least 0, got {radius}")
        if radii == (0, 0):
            raise ValueError("base_radius and tip_radius must not both be 0")
        self._set(
            transform,
            material,
            emission,
            name,
            base=start,
            tip=end,
            base_radius=radii[0],
            tip_radius=radii[1],
            capped=switch("capped", capped),
        )
