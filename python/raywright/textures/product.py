"""Textures times each other."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple
from .texture import Texture, Value, ends, value


@dataclass(frozen=True, init=False)
class ProductTexture(Texture):
    """The product of two values, channel by channel; with a number, a texture made brighter or darker.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        The factors.

    Raises
    ------
    ValueError
        If a number is not finite.
    TypeError
        If an argument has another type.

    See Also
    --------
    MixTexture : A weighted mean.

    Examples
    --------
    >>> dark = rw.textures.ProductTexture(rw.Checker(0.2, 0.8), 0.5)
    >>> dark.range
    ((0.1, 0.1, 0.1), (0.4, 0.4, 0.4))
    """

    a: Value
    b: Value

    def __init__(self, a: ArrayLike | Texture, b: ArrayLike | Texture) -> None:
        self._set(a=value("a", a, -float("inf")), b=value("b", b, -float("inf")))

    @property
    def range(self) -> tuple[Triple, Triple]:
        """Bounds of its values: the least and the greatest red, green and blue."""
        products = [
            tuple(x * y for x, y in zip(i, j, strict=True)) for i in ends(self.a) for j in ends(self.b)
        ]
        x, y, z = (min(channel) for channel in zip(*products, strict=True))
        r, s, t = (max(channel) for channel in zip(*products, strict=True))
        return (x, y, z), (r, s, t)
