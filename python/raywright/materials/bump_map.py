"""Bumps."""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import number
from ..textures.texture import Number, Texture, scalar
from .material import Material
from .material import material as checked


@dataclass(frozen=True, init=False)
class BumpMap(Material):
    """A material with a bump map.

    The shape is unchanged; only its normals change (Blinn, "Simulation of Wrinkled Surfaces", 1978).

    Parameters
    ----------
    material : Material
        Material of the surface.
    height : float or Texture
        Height along the normal.
    scale : float
        Factor of heights, in the scene's unit; negative for depths.

    Raises
    ------
    ValueError
        If a number is not finite.
    TypeError
        If an argument has another type.

    See Also
    --------
    NormalMap : Normals from a picture.

    Examples
    --------
    >>> waves = rw.BumpMap(rw.Diffuse(0.5), rw.textures.Noise(), scale=0.01)
    >>> waves.material, waves.scale
    (Diffuse(reflectance=(0.5, 0.5, 0.5)), 0.01)
    """

    material: Material
    height: Number
    scale: float

    def __init__(
        self,
        material: Material,
        height: float | Texture,
        scale: float = 1.0,
    ) -> None:
        self._set(
            material=checked("material", material),
            height=scalar("height", height, -float("inf")),
            scale=number("scale", scale),
        )
