"""Noise of one size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from ..arrays import SeedLike, Triple, seed_number
from .texture import Texture, Value, either, value
from .transform import ObjectTransform, Transform, placed

SEEDS = 2**32 - 1


def blend_of(a: Any, b: Any, transform: Any) -> dict[str, Any]:
    """Return two values between which a solid texture varies, and its transform, checked."""
    return {
        "a": value("a", a, -float("inf")),
        "b": value("b", b, -float("inf")),
        "transform": placed(transform, ObjectTransform),
    }


@dataclass(frozen=True, init=False)
class Noise(Texture):
    """Perlin noise: smooth random spots of about unit size (Perlin, "Improving Noise", 2002).

    Detail finer than a pixel is averaged.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        Values at the minimum and at the maximum of the noise; their mean where it is 0.
    transform : ObjectTransform, UvTransform or float, optional
        Map to the texture: from the space of the shape, or from texture coordinates. A number is the number
        of spots per unit of the shape's space.
    seed : int, Generator or SeedSequence
        Seed of the noise, 0 to 2^32 - 1.

    Raises
    ------
    ValueError
        If a number is not finite, or the seed is out of range.
    TypeError
        If an argument has another type.

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
        self._set(**blend_of(a, b, transform), seed=seed_number(seed, SEEDS))

    @property
    def range(self) -> tuple[Triple, Triple]:
        """Bounds of its values: the least and the greatest red, green and blue."""
        return either(self.a, self.b)
