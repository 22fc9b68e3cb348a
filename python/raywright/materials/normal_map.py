"""Normals from a picture."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import number
from ..textures.texture import Texture, Value, value
from .material import Material
from .material import material as checked


@dataclass(frozen=True, init=False)
class NormalMap(Material):
    """A material whose normals a texture turns, as in glTF.

    Red, green and blue from 0 to 1 are -1 to 1 along u, along v and along the normal.

    Parameters
    ----------
    material : Material
        What it is made of.
    normals : 3 floats or Texture
        The normals, in [0, 1]; a picture of them is not sRGB: ``ImageTexture(picture, linear=True)``.
    scale : float
        How much they turn: what lies along u and v is multiplied by it.

    Raises
    ------
    ValueError
        If a number is not finite, or normals are outside [0, 1].
    TypeError
        If something is not of the kinds above.
    """

    material: Material
    normals: Value
    scale: float

    def __init__(
        self,
        material: Material,
        normals: ArrayLike | Texture,
        scale: float = 1.0,
    ) -> None:
        self._set(
            material=checked("material", material),
            normals=value("normals", normals, most=1.0),
            scale=number("scale", scale),
        )
