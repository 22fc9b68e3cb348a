"""The cylinder."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, positive
from ..lights.emission import EmissionLike
from ..materials import Material
from .shape import Shape, segment, switch


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Cylinder(Shape):
    """All points at one distance from a segment, between its ends' planes.

    Hits are exact, also along the axis and from afar.

    Parameters
    ----------
    base, tip : 3 floats
        The ends of its axis, which differ.
    radius : float
        The distance from the axis, greater than 0.
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
        If the ends are the same, the radius is not greater than 0, or a number is not finite.
        If the transform is not a finite affine (4, 4) matrix, or has no inverse.
    TypeError
        If an argument has another type.

    See Also
    --------
    Cone : Different radii.

    Notes
    -----
    ``u`` is the angle about the axis, in turns, anticlockwise as seen from the tip; ``v`` is the distance
    along the side from the base to the tip, as a share of the whole. For a closed shape it runs from the
    middle of the base cap over its rim, up the side, and in to the middle of the tip cap.

    Examples
    --------
    >>> pipe = rw.Cylinder((0, 0, 0), (0, 0, 2), radius=1, capped=False)
    >>> round(pipe.area / np.pi, 9)
    4.0
    >>> rw.Scene(pipe).intersect_all([5, 0, 1], [-1, 0, 0]).t.tolist()
    [4.0, 6.0]
    """

    base: Triple
    tip: Triple
    radius: float
    capped: bool

    def __init__(
        self,
        base: ArrayLike = (0.0, 0.0, 0.0),
        tip: ArrayLike = (0.0, 0.0, 1.0),
        radius: float = 1.0,
        capped: bool = True,
        *,
        transform: ArrayLike | None = None,
        material: Material | None = None,
        emission: EmissionLike | None = None,
        name: str | None = None,
    ) -> None:
        start, end = segment(("base", "tip"), base, tip)
        self._set(
            transform,
            material,
            emission,
            name,
            base=start,
            tip=end,
            radius=positive("radius", radius),
            capped=switch("capped", capped),
        )
