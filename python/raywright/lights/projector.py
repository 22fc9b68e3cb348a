"""A picture that is thrown."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Triple, number, triple
from ..textures.spectrum import Spectrum, color_or_spectrum
from .light import Light
from .pictured import Pictured, Texels, texels


@dataclass(frozen=True, init=False, eq=False, repr=False)
class ProjectorLight(Pictured, Light):
    """A slide projector: a point light that emits through a picture.

    On a screen at right angles to the axis, the corners of the picture are as bright as its middle: the
    intensity is the picture over the cube of the cosine to the axis.

    Parameters
    ----------
    image : (H, W, 3) or (H, W) array, or path
        Linear colors from the top row on, at least 0, kept as read-only float32; or a path, as for
        `EnvironmentMap`.
    position : 3 floats
        Position, in the scene's unit of length.
    target : 3 floats
        The point that the middle of the picture is projected to.
    up : 3 floats
        The direction that points up in the projected picture.
    fov : float
        Vertical angle of the picture in degrees, between 0 and 180.
    intensity : float, 3 floats or Spectrum
        Radiant intensity along the axis where the picture is 1, in W·sr⁻¹, at least 0.

    Raises
    ------
    ValueError
        If the image is empty, of another shape, negative or not finite; if a number is out of its range; or
        if `position` is `target` or `up` is zero or along the axis.
    TypeError
        If an argument does not hold numbers.
    FileNotFoundError
        If a file is missing.

    See Also
    --------
    SpotLight : A cone of light.

    Examples
    --------
    >>> slide = np.zeros((2, 2, 3), np.float32)
    >>> slide[0] = 1.0
    >>> lamp = rw.ProjectorLight(slide, (0, 0, 2), (0, 0, 0), up=(0, 1, 0), fov=60, intensity=4 * np.pi)
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=2, height=2, fov=10)
    >>> image = rw.render(rw.Scene(rw.Plane(), lights=[lamp]), camera, samples=4, progress=False)
    >>> bool(image.rgb[0].mean() > 2 * image.rgb[1].mean())
    False
    """

    image: Texels
    position: Triple
    target: Triple
    up: Triple
    fov: float
    intensity: Triple | Spectrum

    def __init__(
        self,
        image: ArrayLike | str | PathLike[str],
        position: ArrayLike,
        target: ArrayLike,
        up: ArrayLike = (0.0, 1.0, 0.0),
        fov: float = 40.0,
        intensity: ArrayLike | Spectrum = 1.0,
    ) -> None:
        values = {
            "image": texels("image", image),
            "position": triple("position", position),
            "target": triple("target", target),
            "up": triple("up", up),
            "fov": number("fov", fov),
            "intensity": color_or_spectrum("intensity", intensity),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        if not 0 < self.fov < 180:
            raise ValueError(f"fov must be between 0 and 180 degrees, got {fov}")
        if self.position == self.target:
            raise ValueError(f"target must differ from position, both are {self.target}")
        axis = np.subtract(self.target, self.position)
        if not np.linalg.norm(np.cross(axis / np.abs(axis).max(), self.up)) > 0:
            raise ValueError(f"up must not be zero or parallel to the axis, got {self.up}")
