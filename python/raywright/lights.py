"""Light that does not come from a mesh: points, and what surrounds the scene."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from .arrays import Triple, colour, triple


@dataclass(frozen=True, init=False)
class PointLight:
    """A point that shines evenly into all directions.

    Parameters
    ----------
    position : 3 floats
        Where it is, in the scene's unit of length.
    intensity : float or 3 floats
        Radiant intensity in W·sr⁻¹, at least 0: one number, or red, green and blue.

    Raises
    ------
    ValueError
        If a number is negative or not finite, or there are too few or too many of them.
    TypeError
        If they are not numbers.
    """

    position: Triple
    intensity: Triple

    def __init__(self, position: ArrayLike, intensity: ArrayLike) -> None:
        object.__setattr__(self, "position", triple("position", position))
        object.__setattr__(self, "intensity", colour("intensity", intensity))


@dataclass(frozen=True, init=False)
class ConstantEnvironment:
    """The same radiance from every direction that the scene leaves open.

    Parameters
    ----------
    radiance : float or 3 floats
        Radiance in W·sr⁻¹·m⁻², at least 0: one number, or red, green and blue.

    Raises
    ------
    ValueError
        If a number is negative or not finite, or there are not 1 or 3 of them.
    TypeError
        If it is not a number.
    """

    radiance: Triple

    def __init__(self, radiance: ArrayLike = 1.0) -> None:
        object.__setattr__(self, "radiance", colour("radiance", radiance))
