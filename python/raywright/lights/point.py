"""A point that shines evenly."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, triple
from ..textures.spectrum import Spectrum, color_or_spectrum
from .light import Light


@dataclass(frozen=True, init=False)
class PointLight(Light):
    """A point light that emits equally in all directions.

    Parameters
    ----------
    position : 3 floats
        Position, in the scene's unit of length.
    intensity : float, 3 floats or Spectrum
        Radiant intensity in W·sr⁻¹, at least 0: one number, or red, green and blue.

    Raises
    ------
    ValueError
        If a number is negative or not finite, or there are too few or too many of them.
    TypeError
        If an argument is not a number.

    See Also
    --------
    SpotLight : A cone of light.
    Emission : Light of surfaces.

    Examples
    --------
    >>> scene = rw.Scene(rw.Plane(), lights=[rw.PointLight((0, 0, 2), intensity=4 * np.pi)])
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=0.1, width=1, height=1)
    >>> print(rw.render(scene, camera, samples=1, progress=False).rgb[0, 0].round(3))
    [0.5 0.5 0.5]
    """

    position: Triple
    intensity: Triple | Spectrum

    def __init__(self, position: ArrayLike, intensity: ArrayLike | Spectrum) -> None:
        object.__setattr__(self, "position", triple("position", position))
        object.__setattr__(self, "intensity", color_or_spectrum("intensity", intensity))
