"""Holes."""

from dataclasses import dataclass

from ..textures.texture import Number, Texture, scalar
from .material import Material
from .material import material as checked


@dataclass(frozen=True, init=False)
class Mask(Material):
    """A material with holes: leaves, lace, fences.

    Where it is partly there, rays go through it in proportion, and a shape that shines gives off light in
    proportion. Holes are for pictures: `Scene.intersect` and the like hit the shape.

    Parameters
    ----------
    material : Material
        What is between the holes.
    opacity : float or Texture
        How much of it is there, from 0, a hole, to 1.

    Raises
    ------
    ValueError
        If `opacity` is outside [0, 1].
    TypeError
        If something is not of the kinds above.
    """

    material: Material
    opacity: Number

    def __init__(
        self,
        material: Material,
        opacity: "float | Texture" = 0.5,
    ) -> None:
        self._set(
            material=checked("material", material),
            opacity=scalar("opacity", opacity, most=1.0),
        )
