"""The same light from everywhere."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple
from ..textures.spectrum import Spectrum, color_or_spectrum
from .light import Environment


@dataclass(frozen=True, init=False)
class ConstantEnvironment(Environment):
    """A uniform environment: the same radiance from all directions.

    Parameters
    ----------
    radiance : float, 3 floats or Spectrum
        Radiance in W·sr⁻¹·m⁻², at least 0: one number, or red, green and blue.

    Raises
    ------
    ValueError
        If a number is negative or not finite, or there are neither 1 nor 3 of them.
    TypeError
        If `radiance` is not a number.

    See Also
    --------
    EnvironmentMap : A picture around the scene.
    SunSky : Daylight.

    Examples
    --------
    >>> scene = rw.Scene([], environment=rw.ConstantEnvironment((0.1, 0.2, 0.3)))
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=1, height=1)
    >>> print(rw.render(scene, camera, samples=1, progress=False).rgb[0, 0].round(4))
    [0.1 0.2 0.3]
    """

    radiance: Triple | Spectrum

    def __init__(self, radiance: ArrayLike | Spectrum = 1.0) -> None:
        object.__setattr__(self, "radiance", color_or_spectrum("radiance", radiance))
