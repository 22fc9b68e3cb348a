"""Stripes."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple
from .texture import Texture, Value, either, scalar, value
from .transform import Transform, UvTransform, placed


@dataclass(frozen=True, init=False)
class Stripes(Texture):
    """Stripes across the first axis, one each unit. Detail finer than a pixel is averaged.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        Values between the stripes, and within them.
    fraction : float
        Share of each unit that a stripe takes, at its end: between 0 and 1.
    transform : UvTransform, ObjectTransform or float, optional
        Map to the texture: from texture coordinates, or from the space of the shape. A number is how many
        stripes there are to a unit of texture coordinates.

    Raises
    ------
    ValueError
        If a number is not finite, or `fraction` is not between 0 and 1.
    TypeError
        If something is not of the kinds above.

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
        """The least and the greatest that it may be, in red, green and blue."""
        return either(self.a, self.b)
