"""Normals from a picture."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import number
from ..textures.texture import Texture, Value, value
from .material import Material
from .material import material as checked


@dataclass(frozen=True, init=False)
class NormalMap(Material):
    """A material with a tangent-space normal map, as in glTF.

    Red, green and blue from 0 to 1 are -1 to 1 along u, along v and along the normal.

    Parameters
    ----------
    material : Material
        Material of the surface.
    normals : 3 floats or Texture
        The normals, in [0, 1]; a picture of them is not sRGB: ``ImageTexture(picture, linear=True)``.
    scale : float
        Strength: a factor of the components along u and v.

    Raises
    ------
    ValueError
        If a number is not finite, or normals are outside [0, 1].
    TypeError
        If an argument has another type.

    See Also
    --------
    BumpMap : Heights instead of normals.

    Examples
    --------
    >>> flat = rw.NormalMap(rw.Diffuse(0.5), (0.5, 0.5, 1.0))
    >>> flat.normals, flat.scale
    ((0.5, 0.5, 1.0), 1.0)
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
