"""Recursive ray tracing."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, color
from . import counts
from .base import CoreIntegrator


@dataclass(frozen=True, init=False)
class Whitted(CoreIntegrator):
    """Whitted's ray tracing (1980): lights, ambient light, and both the reflected and the refracted ray.

    Only smooth surfaces are followed, to a depth or for as long as they contribute (Hall and Greenberg 1983);
    diffuse light between surfaces is replaced by `ambient`. So the picture is biased by design; with point
    lights and a pinhole camera it has no noise.

    Parameters
    ----------
    max_depth : int
        Maximum number of surfaces on a light path.
    contribution : float
        Minimum share of a pixel's value for a ray to be followed: 0 (all are) to below 1.
    ambient : float or 3 floats
        Uniform radiance in place of light that is not traced; surfaces reflect their ambient share of it, as
        in `RayCast`.
    light_samples : int
        Light samples at the first surface, stratified over the lights: 1 to 1024.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    RayCast : The first hit alone.
    Distributed : With gloss and soft shadows.

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere(material=rw.Mirror(0.5)), environment=1.0)
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> image = rw.render(scene, camera, rw.Whitted(), samples=1, progress=False)
    >>> image.rgb[1, 1].tolist()
    [0.5, 0.5, 0.5]
    """

    max_depth: int
    contribution: float
    ambient: Triple
    light_samples: int

    def __init__(
        self,
        max_depth: int = 8,
        contribution: float = 1 / 512,
        ambient: ArrayLike = 0.0,
        light_samples: int = 1,
    ) -> None:
        object.__setattr__(self, "max_depth", counts.depth("max_depth", max_depth))
        object.__setattr__(self, "contribution", counts.contribution(contribution))
        object.__setattr__(self, "ambient", color("ambient", ambient))
        object.__setattr__(self, "light_samples", counts.samples("light_samples", light_samples))
