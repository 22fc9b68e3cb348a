"""Wood."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import SeedLike, Triple, number
from .fbm import octaves_of
from .noise import blend_of
from .texture import Texture, Value, either
from .transform import Transform


@dataclass(frozen=True, init=False)
class Wood(Texture):
    """Wood grain: rings around the third axis, one per unit of radius, distorted by noise.

    After Perlin ("An Image Synthesizer", 1985). Detail finer than a pixel is averaged.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        Colors of early wood, and of the late wood at the end of each ring.
    transform : ObjectTransform, UvTransform or float, optional
        Map to the texture: from the space of the shape, or from texture coordinates. A number is the number
        of rings per unit of the shape's space.
    distortion : float
        Displacement by noise, in units; 0 for none.
    octaves, lacunarity, gain, seed
        The noise, as of `FBm`.

    Raises
    ------
    ValueError
        If a number is not finite or out of range.
    TypeError
        If an argument has another type.

    See Also
    --------
    Marble : Veins.

    Examples
    --------
    >>> rw.textures.Wood(transform=8.0).distortion
    0.3
    """

    a: Value
    b: Value
    transform: Transform
    distortion: float
    octaves: int
    lacunarity: float
    gain: float
    seed: int

    def __init__(
        self,
        a: ArrayLike | Texture = (0.6, 0.38, 0.2),
        b: ArrayLike | Texture = (0.3, 0.15, 0.06),
        transform: Transform | float | None = None,
        distortion: float = 0.3,
        octaves: int = 3,
        lacunarity: float = 2.0,
        gain: float = 0.5,
        seed: SeedLike = 0,
    ) -> None:
        self._set(
            **blend_of(a, b, transform),
            distortion=number("distortion", distortion),
            **octaves_of(octaves, lacunarity, gain, seed),
        )

    @property
    def range(self) -> tuple[Triple, Triple]:
        """Bounds of its values: the least and the greatest red, green and blue."""
        return either(self.a, self.b)
