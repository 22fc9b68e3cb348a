"""Noise of many sizes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from ..arrays import SeedLike, Triple, integer, number, seed_number
from .noise import SEEDS, blend_of
from .texture import Texture, Value, either, scalar
from .transform import Transform


def octaves_of(octaves: int, lacunarity: float, gain: float, seed: SeedLike) -> dict[str, Any]:
    """Return what describes a sum of noises, checked."""
    finer = number("lacunarity", lacunarity)
    if not 1 < finer <= 16:
        raise ValueError(f"lacunarity must be greater than 1 and at most 16, got {lacunarity}")
    if isinstance(gain, Texture):
        raise TypeError(f"gain must be a number, got {type(gain).__name__}")
    return {
        "octaves": integer("octaves", octaves, 1, 32),
        "lacunarity": finer,
        "gain": scalar("gain", gain, most=1.0),
        "seed": seed_number(seed, SEEDS),
    }


@dataclass(frozen=True, init=False)
class FBm(Texture):
    """Fractional Brownian motion: a sum of noises, each finer and weaker than the one before.

    Clouds, stains, terrain (Mandelbrot and Van Ness, 1968; Perlin, "An Image Synthesizer", 1985). Noises
    finer than a pixel are left out.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        Values where the sum is -1 or less, and where it is 1 or more.
    transform : ObjectTransform, UvTransform or float, optional
        Map to the texture, as for `Noise`: the coarsest noise has spots of about unit size.
    octaves : int
        Number of noises, 1 to 32.
    lacunarity : float
        Ratio of frequencies of successive noises, above 1 and at most 16.
    gain : float
        Ratio of amplitudes of successive noises, 0 to 1.
    seed : int, Generator or SeedSequence
        Seed of the noise, 0 to 2^32 - 1.

    Raises
    ------
    ValueError
        If a number is not finite or out of range.
    TypeError
        If an argument has another type.

    See Also
    --------
    Noise : One octave.

    Examples
    --------
    >>> clouds = rw.textures.FBm(0.0, 1.0, octaves=4)
    >>> clouds.octaves, clouds.range
    (4, ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))
    """

    a: Value
    b: Value
    transform: Transform
    octaves: int
    lacunarity: float
    gain: float
    seed: int

    def __init__(
        self,
        a: ArrayLike | Texture = 0.0,
        b: ArrayLike | Texture = 1.0,
        transform: Transform | float | None = None,
        octaves: int = 8,
        lacunarity: float = 2.0,
        gain: float = 0.5,
        seed: SeedLike = 0,
    ) -> None:
        self._set(**blend_of(a, b, transform), **octaves_of(octaves, lacunarity, gain, seed))

    @property
    def range(self) -> tuple[Triple, Triple]:
        """Bounds of its values: the least and the greatest red, green and blue."""
        return either(self.a, self.b)
