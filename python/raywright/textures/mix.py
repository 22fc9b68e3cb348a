"""Two textures by a third."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple
from .texture import Texture, Value, either, value


@dataclass(frozen=True, init=False)
class MixTexture(Texture):
    """A blend of two values: ``a (1 - amount) + b amount``, channel by channel.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        The two values.
    amount : float, 3 floats or Texture
        Share of `b`, between 0 and 1.

    Raises
    ------
    ValueError
        If a number is not finite, or `amount` is not between 0 and 1.
    TypeError
        If an argument has another type.

    See Also
    --------
    ProductTexture : The product.

    Examples
    --------
    >>> rust = rw.textures.MixTexture((0.5, 0.5, 0.5), (0.4, 0.2, 0.1), rw.textures.Noise())
    >>> rust.range
    ((0.4, 0.2, 0.1), (0.5, 0.5, 0.5))
    """

    a: Value
    b: Value
    amount: Value

    def __init__(
        self, a: ArrayLike | Texture, b: ArrayLike | Texture, amount: ArrayLike | Texture = 0.5
    ) -> None:
        self._set(
            a=value("a", a, -float("inf")),
            b=value("b", b, -float("inf")),
            amount=value("amount", amount, most=1.0),
        )

    @property
    def range(self) -> tuple[Triple, Triple]:
        """Bounds of its values: the least and the greatest red, green and blue."""
        return either(self.a, self.b)
