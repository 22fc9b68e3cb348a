"""Matt surfaces."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..textures.texture import Texture, Value, value
from .material import Material


@dataclass(frozen=True, init=False)
class Diffuse(Material):
    """A diffuse surface by Lambert's law, on both sides.

    Parameters
    ----------
    reflectance : float, 3 floats or Texture
        Share of the arriving light that is reflected, in [0, 1]: one number, or linear red, green and blue.
        Numbers are kept as a tuple of 3 floats.

    Raises
    ------
    ValueError
        If a reflectance is outside [0, 1] or not finite, or there are neither 1 nor 3 numbers.
    TypeError
        If an argument has another type.

    See Also
    --------
    OrenNayar : A rough matt surface.
    Plastic : A matt surface under a coat.

    Examples
    --------
    >>> rw.Diffuse((0.2, 0.4, 0.6)).reflectance
    (0.2, 0.4, 0.6)
    >>> rw.Diffuse(1.5)
    Traceback (most recent call last):
        ...
    ValueError: reflectance must be between 0 and 1, got 1.5
    """

    reflectance: Value

    def __init__(
        self,
        reflectance: ArrayLike | Texture = 0.5,
    ) -> None:
        self._set(
            reflectance=value("reflectance", reflectance, most=1.0),
        )
