"""Marble."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import SeedLike, Triple, number
from .fbm import octaves_of
from .noise import blend_of
from .texture import Texture, Value, either
from .transform import Transform


@dataclass(frozen=True, init=False)
class Marble(Texture):
    """Marble veins: soft bands at right angles to the first axis, one per unit, distorted by noise.

    After Perlin ("An Image Synthesizer", 1985). Detail finer than a pixel is averaged.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        Values between the bands, and within them.
    transform : ObjectTransform, UvTransform or float, optional
        Map to the texture: from the space of the shape, or from texture coordinates. A number is the number
        of bands per unit of the shape's space.
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
    Wood : Rings.

    Examples
    --------
    >>> stone = rw.textures.Marble(transform=3.0, seed=1)
    >>> stone.distortion
    1.5
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
        a: ArrayLike | Texture = (0.15, 0.15, 0.18),
        b: ArrayLike | Texture = (0.85, 0.84, 0.8),
        transform: Transform | float | None = None,
        distortion: float = 1.5,
        octaves: int = 8,
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
