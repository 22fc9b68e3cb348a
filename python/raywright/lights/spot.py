"""A point that shines into a cone."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, colour, number, triple


@dataclass(frozen=True, init=False)
class SpotLight:
    """A point that shines into a cone, evenly in its middle and smoothly falling off to its rim.

    Parameters
    ----------
    position : 3 floats
        Where it is, in the scene's unit of length.
    target : 3 floats
        A point on the axis of the cone.
    intensity : float or 3 floats
        Radiant intensity in the middle in W·sr⁻¹, at least 0: one number, or red, green and blue.
    angle : float
        Angle between the axis and the rim in degrees, above 0 and at most 90.
    falloff : float
        Over how many degrees, inwards from the rim, it falls off: 0 to `angle`. The cosine to the axis goes
        through the cubic ``x² (3 - 2x)``, as level at both ends as can be.

    Raises
    ------
    ValueError
        If a number is out of its range or not finite, or `target` is `position`.
    TypeError
        If something is not a number.
    """

    position: Triple
    target: Triple
    intensity: Triple
    angle: float
    falloff: float

    def __init__(
        self,
        position: ArrayLike,
        target: ArrayLike,
        intensity: ArrayLike,
        angle: float = 30.0,
        falloff: float = 5.0,
    ) -> None:
        values = {
            "position": triple("position", position),
            "target": triple("target", target),
            "intensity": colour("intensity", intensity),
            "angle": number("angle", angle),
            "falloff": number("falloff", falloff),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        if self.position == self.target:
            raise ValueError(f"target must differ from position, both are {self.target}")
        if not 0 < self.angle <= 90:
            raise ValueError(f"angle must be above 0 and at most 90 degrees, got {angle}")
        if not 0 <= self.falloff <= self.angle:
            raise ValueError(f"falloff must be between 0 and angle = {self.angle:g} degrees, got {falloff}")
