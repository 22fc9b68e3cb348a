"""Ray casting."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, color
from . import counts
from .base import CoreIntegrator


@dataclass(frozen=True, init=False)
class RayCast(CoreIntegrator):
    """Ray casting with shadows (Appel 1968): direct light at the first hit, and ambient light.

    Rays end there: mirrors and glass are black.

    Parameters
    ----------
    ambient : float or 3 floats
        Uniform radiance, without shadows. Surfaces reflect a share of it: the parameter `ambient` of `Phong`
        and `BlinnPhong`, nothing for smooth materials, about the albedo for others.
    shadows : bool
        True if occluders shadow lights.
    light_samples : int
        Light samples at each visible point, stratified over the lights: 1 to 1024.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    Whitted : With reflection and refraction.
    Direct : With light of surfaces, by importance sampling.

    Examples
    --------
    >>> scene = rw.Scene(rw.Plane(), lights=[rw.PointLight((0, 0, 1), intensity=np.pi)])
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=0.1, width=1, height=1)
    >>> image = rw.render(scene, camera, rw.RayCast(ambient=1.0), samples=1, progress=False)
    >>> print(image.rgb[0, 0].round(3))
    [1. 1. 1.]
    """

    ambient: Triple
    shadows: bool
    light_samples: int

    def __init__(self, ambient: ArrayLike = 0.0, shadows: bool = True, light_samples: int = 1) -> None:
        if not isinstance(shadows, bool):
            raise TypeError(f"shadows must be True or False, got {shadows!r}")
        object.__setattr__(self, "ambient", color("ambient", ambient))
        object.__setattr__(self, "shadows", shadows)
        object.__setattr__(self, "light_samples", counts.samples("light_samples", light_samples))
