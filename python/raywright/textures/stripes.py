"""Stripes."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple
from .texture import Texture, Value, either, scalar, value
from .transform import Transform, UvTransform, placed


@dataclass(frozen=True, init=False)
class Stripes(Texture):
    """Stripes at right angles to the first axis, one per unit. Detail finer than a pixel is averaged.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        Values between the stripes, and within them.
    fraction : float
        Width of a stripe, as a share of the unit, between 0 and 1. The stripe is at the end of its unit.
    transform : UvTransform, ObjectTransform or float, optional
        Map to the texture: from texture coordinates, or from the space of the shape. A number is the number
        of stripes per unit of texture coordinates.

    Raises
    ------
    ValueError
        If a number is not finite, or `fraction` is not between 0 and 1.
    TypeError
        If an argument has another type.

    See Also
    --------
    Checker : Squares.

    Examples
    --------
    >>> rw.textures.Stripes(0.1, 0.9, fraction=0.25, transform=4).fraction
    0.25
    """

    a: Value
    b: Value
    fraction: float
    transform: Transform

    def __init__(
        self,
        a: ArrayLike | Texture = 0.2,
        b: ArrayLike | Texture = 0.8,
        fraction: float = 0.5,
        transform: Transform | float | None = None,
    ) -> None:
        if isinstance(fraction, Texture):
            raise TypeError(f"fraction must be a number, got {type(fraction).__name__}")
        self._set(
            a=value("a", a, -float("inf")),
            b=value("b", b, -float("inf")),
            fraction=scalar("fraction", fraction, most=1.0),
            transform=placed(transform, UvTransform),
        )

    @property
    def range(self) -> tuple[Triple, Triple]:
        """Bounds of its values: the least and the greatest red, green and blue."""
        return either(self.a, self.b)
