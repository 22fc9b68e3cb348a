"""Light from a single direction."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, triple
from ..textures.spectrum import Spectrum, color_or_spectrum
from .light import Light


@dataclass(frozen=True, init=False)
class DirectionalLight(Light):
    """Light from infinity along a single direction, as from a star.

    Parameters
    ----------
    direction : 3 floats
        Direction in which the light travels, of any length but 0.
    irradiance : float, 3 floats or Spectrum
        Irradiance of a surface that faces it in W·m⁻², at least 0: one number, or red, green and blue.

    Raises
    ------
    ValueError
        If a number is negative or not finite, or the direction has no length.
    TypeError
        If an argument is not a number.

    See Also
    --------
    SunSky : The sun as a disk.
    PointLight : Light of a point nearby.

    Examples
    --------
    >>> sun = rw.DirectionalLight((0, 0, -1), irradiance=np.pi)
    >>> scene = rw.Scene(rw.Plane(material=rw.Diffuse(0.5)), lights=[sun])
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=1, height=1)
    >>> print(rw.render(scene, camera, samples=1, progress=False).rgb[0, 0].round(4))
    [0.5 0.5 0.5]
    """

    direction: Triple
    irradiance: Triple | Spectrum

    def __init__(self, direction: ArrayLike, irradiance: ArrayLike | Spectrum) -> None:
        way = triple("direction", direction)
        if way == (0, 0, 0):
            raise ValueError(f"direction must not be zero, got {way}")
        object.__setattr__(self, "direction", way)
        object.__setattr__(self, "irradiance", color_or_spectrum("irradiance", irradiance))
