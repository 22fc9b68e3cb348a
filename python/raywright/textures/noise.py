"""Noise of one size."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import SeedLike, Triple, seed_number
from .texture import Texture, Value, either, value
from .transform import ObjectTransform, Transform, placed

SEEDS = 2**32 - 1


@dataclass(frozen=True, init=False)
class Noise(Texture):
    """Smooth random spots about a unit in size (Perlin, "Improving Noise", 2002).

    Detail finer than a pixel is averaged.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        Values where the noise is least, and where it is greatest; half of each where it is 0.
    transform : ObjectTransform, UvTransform or float, optional
        Where they lie: in the space of the shape, or in texture coordinates. A number is how many there are
        to a unit of the shape's space.
    seed : int, Generator or SeedSequence
        Which of all noises, 0 to 2^32 - 1.

    Raises
    ------
    ValueError
        If a number is not finite, or the seed is out of range.
    TypeError
        If something is not of the kinds above.

    See Also
    --------
    FBm : A sum of noises.

    Examples
    --------
    >>> rw.textures.Noise(0.2, 0.4, seed=3).range
    ((0.2, 0.2, 0.2), (0.4, 0.4, 0.4))
    """

    a: Value
    b: Value
    transform: Transform
    seed: int

    def __init__(
        self,
        a: ArrayLike | Texture = 0.0,
        b: ArrayLike | Texture = 1.0,
        transform: Transform | float | None = None,
        seed: SeedLike = 0,
    ) -> None:
        self._set(
            a=value("a", a, -float("inf")),
            b=value("b", b, -float("inf")),
            transform=placed(transform, ObjectTransform),
            seed=seed_number(seed, SEEDS),
        )

    @property
    def range(self) -> tuple[Triple, Triple]:
        """The least and the greatest that it may be, in red, green and blue."""
        return either(self.a, self.b)
