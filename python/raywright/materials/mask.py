"""Holes."""

from __future__ import annotations

from dataclasses import dataclass

from ..textures.texture import Number, Texture, scalar
from .material import Material
from .material import material as checked


@dataclass(frozen=True, init=False)
class Mask(Material):
    """A material with holes: leaves, lace, fences.

    Partial opacity lets a share of rays pass, and reduces emission by the same share. Holes affect pictures
    only: `Scene.intersect` and other queries hit the whole shape.

    Parameters
    ----------
    material : Material
        Material between the holes.
    opacity : float or Texture
        Opacity, from 0, a hole, to 1.

    Raises
    ------
    ValueError
        If `opacity` is outside [0, 1].
    TypeError
        If an argument has another type.

    See Also
    --------
    Mix : Two materials in one place.

    Examples
    --------
    >>> leaf = rw.Mask(rw.Diffuse((0.1, 0.4, 0.1)), rw.Checker(0, 1))
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> ghost = rw.Scene(rw.Sphere(material=rw.Mask(rw.Diffuse(0.5), opacity=0)), environment=1.0)
    >>> rw.render(ghost, camera, samples=1, progress=False).rgb[2, 2].tolist()
    [1.0, 1.0, 1.0]
    """

    material: Material
    opacity: Number

    def __init__(
        self,
        material: Material,
        opacity: float | Texture = 0.5,
    ) -> None:
        self._set(
            material=checked("material", material),
            opacity=scalar("opacity", opacity, most=1.0),
        )
