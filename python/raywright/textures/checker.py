"""Cells of two kinds in turn."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple
from .texture import Texture, Value, either, value
from .transform import Transform, UvTransform, placed


@dataclass(frozen=True, init=False)
class Checker(Texture):
    """Unit squares, or cubes, of two kinds in turn. Those too small to be told apart become their mean.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        What the cells are; the one at the lower left is `a`.
    transform : UvTransform, ObjectTransform or float, optional
        Where they lie: squares in texture coordinates, or cubes in the space of the shape. A number is how
        many squares there are to a unit of texture coordinates.

    Raises
    ------
    ValueError
        If a number is not finite.
    TypeError
        If something is not of the kinds above.

    Notes
    -----
    A flat surface that lies exactly between two layers of cubes shows one or the other as rounding has it:
    an offset of the transform puts it within one.
    """

    a: Value
    b: Value
    transform: Transform

    def __init__(
        self,
        a: ArrayLike | Texture = 0.2,
        b: ArrayLike | Texture = 0.8,
        transform: Transform | float | None = None,
    ) -> None:
        self._set(
            a=value("a", a, -float("inf")),
            b=value("b", b, -float("inf")),
            transform=placed(transform, UvTransform),
        )

    @property
    def range(self) -> tuple[Triple, Triple]:
        """The least and the greatest that it may be, in red, green and blue."""
        return either(self.a, self.b)
