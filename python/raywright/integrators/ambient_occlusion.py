"""Ambient occlusion."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..arrays import positive
from . import counts
from .base import CoreIntegrator


@dataclass(frozen=True)
class AmbientOcclusion(CoreIntegrator):
    """Ambient occlusion: the share of directions without an occluder within a radius.

    After Zhukov, Iones and Kronin (1998). The background is white.

    Parameters
    ----------
    radius : float
        Maximum distance of occluders, in the scene's unit, above 0; infinite by default.
    cosine : bool
        True to weigh directions by their cosine, as for uniform light; False for equal weights.
    samples : int
        Directions for each camera ray, 1 to 1024.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    measure.ambient_visibility : The same at points of surfaces.

    Examples
    --------
    >>> scene = rw.Scene(rw.Plane())
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> image = rw.render(scene, camera, rw.AmbientOcclusion(samples=4), samples=1, progress=False)
    >>> image.rgb[0, 0].tolist()
    [1.0, 1.0, 1.0]
    """

    radius: float = math.inf
    cosine: bool = True
    samples: int = 1

    def __post_init__(self) -> None:
        if not isinstance(self.cosine, bool):
            raise TypeError(f"cosine must be True or False, got {self.cosine!r}")
        if self.radius != math.inf:
            object.__setattr__(self, "radius", positive("radius", self.radius))
        object.__setattr__(self, "samples", counts.samples("samples", self.samples))
