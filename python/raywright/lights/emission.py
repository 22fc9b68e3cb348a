"""How surfaces shine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias, Union

from numpy.typing import ArrayLike

from ..arrays import choice
from ..textures.spectrum import Spectrum
from ..textures.texture import Texture, Value
from ..textures.texture import value as checked_value

EmissionLike: TypeAlias = Union[ArrayLike, Spectrum, Texture, "Emission"]
Emitted: TypeAlias = Union[Value, "Emission"]

SIDES = ("front", "back", "both")


@dataclass(frozen=True, init=False)
class Emission:
    """Emission of a surface by side: front, back or both.

    Normals point to the front: the outside of a closed shape, and the side where the corners of a face turn
    anticlockwise. A sphere that emits on its back lights its inside.

    Parameters
    ----------
    radiance : float, 3 floats, Spectrum or Texture
        Radiance in W·sr⁻¹·m⁻², at least 0: one number, or red, green and blue, by wavelength, or a texture.
    both_sides : bool
        True is the same as ``side="both"``.
    side : {"front", "back", "both"}, optional
        The side that emits; the front if not given.

    Raises
    ------
    ValueError
        If a number is negative or not finite, there are neither 1 nor 3 of them, or there is no such side.
    TypeError
        If an argument is not a number, or `both_sides` is not a bool.

    See Also
    --------
    Blackbody : Light by its temperature.

    Examples
    --------
    >>> lamp = rw.Disk(emission=rw.Emission(5.0, side="back"))
    >>> camera = rw.Camera((0, 0, -5), (0, 0, 0), fov=10, width=1, height=1)
    >>> rw.render(rw.Scene(lamp), camera, samples=1, progress=False).rgb[0, 0].tolist()
    [5.0, 5.0, 5.0]
    """

    radiance: Value
    side: str

    def __init__(
        self, radiance: ArrayLike | Spectrum | Texture, both_sides: bool = False, *, side: str | None = None
    ) -> None:
        if not isinstance(both_sides, bool):
            raise TypeError(f"both_sides must be True or False, got {both_sides!r}")
        if side is not None:
            choice("side", side, SIDES)
            if both_sides and side != "both":
                raise ValueError(f"only one of both_sides and side can be given, got True and {side!r}")
        object.__setattr__(self, "radiance", emitted("radiance", radiance))
        object.__setattr__(self, "side", side or ("both" if both_sides else "front"))

    @property
    def both_sides(self) -> bool:
        """True if both sides emit."""
        return self.side == "both"


def emitted(name: str, value: Any) -> Value:
    """Return a checked radiance: the one place that knows its forms."""
    return checked_value(name, value)


def emission(value: Any) -> Emitted | None:
    """Return the emission of a shape: a radiance, more than that, or None."""
    if value is None or isinstance(value, Emission):
        return value
    return emitted("emission", value)
