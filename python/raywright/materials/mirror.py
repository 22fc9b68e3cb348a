"""Perfect mirrors."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..textures.texture import Texture, Value, value
from .material import Material


@dataclass(frozen=True, init=False)
class Mirror(Material):
    """A mirror that reflects the same share at every angle, on both sides.

    Parameters
    ----------
    reflectance : float, 3 floats or Texture
        That share, in [0, 1].

    Raises
    ------
    ValueError
        If a reflectance is outside [0, 1] or not finite.
    TypeError
        If something is not of the kinds above.
    """

    reflectance: Value

    def __init__(
        self,
        reflectance: ArrayLike | Texture = 1.0,
    ) -> None:
        self._set(
            reflectance=value("reflectance", reflectance, most=1.0),
        )
