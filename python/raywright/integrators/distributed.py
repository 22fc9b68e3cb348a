"""Distributed ray tracing."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, color
from . import counts
from .base import CoreIntegrator


@dataclass(frozen=True, init=False)
class Distributed(CoreIntegrator):
    """Distributed ray tracing (Cook, Porter and Carpenter 1984): soft shadows, gloss, depth of field, motion.

    Scattered rays are followed only where the density of scattering exceeds 1 per steradian, three times the
    maximum of a matt surface. Diffuse light between surfaces is replaced by `ambient`.

    Parameters
    ----------
    max_depth : int
        Maximum number of surfaces on a light path.
    splits : int
        Number of scattered rays, and of light samples, at the first surface: 1 to 1024.
    ambient : float or 3 floats
        Uniform radiance in place of light that is not traced; surfaces reflect their ambient share of it, as
        in `RayCast`.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    Whitted : Without soft shadows and gloss.
    Path : With diffuse light between surfaces.

    Examples
    --------
    >>> scene = rw.Scene(rw.Plane(), lights=[rw.PointLight((0, 0, 1), intensity=np.pi)])
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=0.1, width=1, height=1)
    >>> image = rw.render(scene, camera, rw.integrators.Distributed(splits=2), samples=4, progress=False)
    >>> print(image.rgb[0, 0].round(3))
    [0.5 0.5 0.5]
    """

    max_depth: int
    splits: int
    ambient: Triple

    def __init__(self, max_depth: int = 8, splits: int = 4, ambient: ArrayLike = 0.0) -> None:
        object.__setattr__(self, "max_depth", counts.depth("max_depth", max_depth))
        object.__setattr__(self, "splits", counts.samples("splits", splits))
        object.__setattr__(self, "ambient", color("ambient", ambient))
