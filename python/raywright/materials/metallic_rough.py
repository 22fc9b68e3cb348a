"""The model of glTF."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..textures.texture import Number, Texture, Value, scalar, value
from .material import Material


@dataclass(frozen=True, init=False)
class MetallicRough(Material):
    """The metallic-roughness model of glTF 2.0: from plastic to metal.

    Both sides reflect. Dielectric parts have an index of refraction of 1.5 relative to the surrounding
    medium. Emission is the shape's.

    Parameters
    ----------
    base_color : float, 3 floats or Texture
        Diffuse color, or reflectance of the metal, linear, in [0, 1].
    metallic : float or Texture
        Metalness from 0, none, to 1, metal.
    roughness : float or Texture
        Roughness from 0, smooth, to 1. Its square is the alpha of the GGX distribution.

    Raises
    ------
    ValueError
        If a number is outside [0, 1] or not finite.
    TypeError
        If an argument has another type.

    See Also
    --------
    Principled : More parameters.

    Notes
    -----
    glTF keeps metalness in the blue and roughness in the green of one picture, which is not sRGB:
    ``ImageTexture(picture, linear=True, channel="b")`` and the same of ``"g"``.

    Examples
    --------
    >>> paint = rw.MetallicRough((0.8, 0.1, 0.1), metallic=0, roughness=0.4)
    >>> paint.base_color
    (0.8, 0.1, 0.1)
    """

    base_color: Value
    metallic: Number
    roughness: Number

    def __init__(
        self,
        base_color: ArrayLike | Texture = 1.0,
        metallic: float | Texture = 1.0,
        roughness: float | Texture = 1.0,
    ) -> None:
        self._set(
            base_color=value("base_color", base_color, most=1.0),
            metallic=scalar("metallic", metallic, most=1.0),
            roughness=scalar("roughness", roughness, most=1.0),
        )
