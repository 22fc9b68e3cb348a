"""A point that shines into a cone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from numpy.typing import ArrayLike

from ..arrays import Triple, choice, number, triple
from ..textures.spectrum import Spectrum, color_or_spectrum
from .light import Light

Profile: TypeAlias = Literal["smooth", "linear"]


@dataclass(frozen=True, init=False)
class SpotLight(Light):
    """A point light that emits into a cone: constant in its middle, falling off to its rim.

    Parameters
    ----------
    position : 3 floats
        Position, in the scene's unit of length.
    target : 3 floats
        A point on the axis of the cone.
    intensity : float, 3 floats or Spectrum
        Radiant intensity in the middle in W·sr⁻¹, at least 0: one number, or red, green and blue.
    angle : float
        Angle between the axis and the rim in degrees, above 0 and at most 90.
    falloff : float
        Width of the falloff in degrees, inwards from the rim: 0 to `angle`.
    profile : {"smooth", "linear"}
        Shape of the falloff: "smooth" is the cubic ``x² (3 - 2x)`` of the cosine to the axis, with slope 0 at
        both ends; "linear" is linear in the angle to the axis.

    Raises
    ------
    ValueError
        If a number is out of its range or not finite, `target` is `position`, or `profile` is none of those.
    TypeError
        If an argument is not a number.

    See Also
    --------
    PointLight : Light into all directions.
    ProjectorLight : A picture.

    Examples
    --------
    >>> lamp = rw.SpotLight((0, 0, 2), (0, 0, 0), intensity=4 * np.pi, angle=20, falloff=5)
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=0.1, width=1, height=1)
    >>> image = rw.render(rw.Scene(rw.Plane(), lights=[lamp]), camera, samples=1, progress=False)
    >>> print(image.rgb[0, 0].round(3))
    [0.5 0.5 0.5]
    """

    position: Triple
    target: Triple
    intensity: Triple | Spectrum
    angle: float
    falloff: float
    profile: Profile

    def __init__(
        self,
        position: ArrayLike,
        target: ArrayLike,
        intensity: ArrayLike | Spectrum,
        angle: float = 30.0,
        falloff: float = 5.0,
        profile: Profile = "smooth",
    ) -> None:
        choice("profile", profile, get_args(Profile))
        values = {
            "position": triple("position", position),
            "target": triple("target", target),
            "intensity": color_or_spectrum("intensity", intensity),
            "angle": number("angle", angle),
            "falloff": number("falloff", falloff),
            "profile": profile,
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        if self.position == self.target:
            raise ValueError(f"target must differ from position, both are {self.target}")
        if not 0 < self.angle <= 90:
            raise ValueError(f"angle must be above 0 and at most 90 degrees, got {angle}")
        if not 0 <= self.falloff <= self.angle:
            raise ValueError(f"falloff must be between 0 and angle = {self.angle:g} degrees, got {falloff}")
