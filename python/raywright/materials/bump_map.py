"""Bumps."""

from dataclasses import dataclass

from ..arrays import number
from ..textures.texture import Number, Texture, scalar
from .material import Material
from .material import material as checked


@dataclass(frozen=True, init=False)
class BumpMap(Material):
    """A material on a surface that looks as if it were raised.

    What is hit is the surface as it was; only its normals change (Blinn, "Simulation of Wrinkled Surfaces",
    1978).

    Parameters
    ----------
    material : Material
        What it is made of.
    height : float or Texture
        How high each point is, along the normal.
    scale : float
        What heights are multiplied by, to be lengths of the scene's unit; negative where they are depths.

    Raises
    ------
    ValueError
        If a number is not finite.
    TypeError
        If something is not of the kinds above.
    """

    material: Material
    height: Number
    scale: float

    def __init__(
        self,
        material: Material,
        height: "float | Texture",
        scale: float = 1.0,
    ) -> None:
        self._set(
            material=checked("material", material),
            height=scalar("height", height, -float("inf")),
            scale=number("scale", scale),
        )
