"""The same light from everywhere."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple
from ..textures.spectrum import Spectrum, colour_or_spectrum


@dataclass(frozen=True, init=False)
class ConstantEnvironment:
    """The same radiance from every direction that the scene leaves open.

    Parameters
    ----------
    radiance : float, 3 floats or Spectrum
        Radiance in W·sr⁻¹·m⁻², at least 0: one number, or red, green and blue.

    Raises
    ------
    ValueError
        If a number is negative or not finite, or there are not 1 or 3 of them.
    TypeError
        If it is not a number.
    """

    radiance: Triple | Spectrum

    def __init__(self, radiance: ArrayLike | Spectrum = 1.0) -> None:
        object.__setattr__(self, "radiance", colour_or_spectrum("radiance", radiance))
