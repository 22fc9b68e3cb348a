"""How surfaces shine."""

from dataclasses import dataclass
from typing import Any, TypeAlias, Union

from numpy.typing import ArrayLike

from ..textures.texture import Texture, Value
from ..textures.texture import value as checked_value

EmissionLike: TypeAlias = Union[ArrayLike, Texture, "Emission"]
Emitted: TypeAlias = Union[Value, "Emission"]


@dataclass(frozen=True, init=False)
class Emission:
    """What a surface gives off: the `emission` of a shape that shines on both sides.

    Parameters
    ----------
    radiance : float, 3 floats or Texture
        Radiance in W·sr⁻¹·m⁻², at least 0: one number, or red, green and blue, or what varies.
    both_sides : bool
        Whether the side that the normals point away from shines too.

    Raises
    ------
    ValueError
        If a number is negative or not finite, or there are not 1 or 3 of them.
    TypeError
        If it is not a number, or `both_sides` is no bool.
    """

    radiance: Value
    both_sides: bool

    def __init__(self, radiance: ArrayLike | Texture, both_sides: bool = False) -> None:
        if not isinstance(both_sides, bool):
            raise TypeError(f"both_sides must be True or False, got {both_sides!r}")
        object.__setattr__(self, "radiance", emitted("radiance", radiance))
        object.__setattr__(self, "both_sides", both_sides)


def emitted(name: str, value: Any) -> Value:
    """Return what may be given as a radiance: the one place that knows."""
    return checked_value(name, value)


def emission(value: Any) -> Emitted | None:
    """Return the emission of a shape: a radiance, more than that, or None."""
    if value is None or isinstance(value, Emission):
        return value
    return emitted("emission", value)
