"""How surfaces scatter light."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from .arrays import Triple, colour


@dataclass(frozen=True, init=False)
class Diffuse:
    """A surface that scatters evenly into all directions (Lambert's law), on both sides.

    Parameters
    ----------
    reflectance : float or 3 floats
        Share of the arriving light that leaves again, in [0, 1]: one number, or linear red, green and blue.
        Kept as a tuple of 3 floats.

    Raises
    ------
    ValueError
        If a reflectance is outside [0, 1] or not finite, or is not 1 or 3 numbers.
    TypeError
        If it is not a number.
    """

    reflectance: Triple

    def __init__(self, reflectance: ArrayLike = 0.5) -> None:
        object.__setattr__(self, "reflectance", colour("reflectance", reflectance, most=1.0))
