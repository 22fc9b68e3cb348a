"""Cone tracing."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, color
from . import counts
from .base import CoreIntegrator


@dataclass(frozen=True, init=False)
class ConeTraced(CoreIntegrator):
    """Cone tracing (Amanatides 1984): one cone per pixel in place of samples.

    A cone has the solid angle of its pixel. Hits are weighted by the share of the cone that they cover, front
    to back. Soft shadows follow from the unoccluded share of the cone to a lamp: exact for a sphere behind
    one other sphere; a face is treated as a cone of equal solid angle. Mirrors reflect cones, wider at convex
    surfaces, and a rough `Conductor` (GGX) reflects a cone that holds half of its scattered light. So a
    picture has no noise, and one sample is as good as many (an error estimate of 0 needs two). It is biased
    by design, like `Whitted`, and also where a cone covers several surfaces: each face is shaded at one
    point, spheres dim everything behind them evenly, and rough metal at a grazing angle is too dark by the
    part of its cone below the surface.

    Cones support meshes and spheres, of any opaque material or `ThinDielectric`. Lights are emissive surfaces
    and lights without extent; the camera is a pinhole, and the filter a `BoxFilter`.

    Parameters
    ----------
    max_depth : int
        Maximum number of surfaces on a light path.
    contribution : float
        Minimum share of a pixel's value for a cone to be followed: 0 (all are) to below 1.
    ambient : float or 3 floats
        Uniform radiance in place of light that is not traced; surfaces reflect their ambient share of it, as
        in `RayCast`.

    Raises
    ------
    ValueError
        If a number is out of its range. When rendering, if cones do not support the scene: shapes that are
        neither meshes nor spheres, have masks, or are of glass; environments; other cameras and filters.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    BeamTraced : Beams with exact edges.
    Distributed : Soft shadows by many rays.

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere(emission=1.0))
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=9, height=9)
    >>> image = rw.render(scene, camera, rw.integrators.ConeTraced(), samples=1, progress=False)
    >>> image.rgb[4, 4].tolist()
    [1.0, 1.0, 1.0]
    """

    max_depth: int
    contribution: float
    ambient: Triple

    def __init__(self, max_depth: int = 8, contribution: float = 1 / 512, ambient: ArrayLike = 0.0) -> None:
        object.__setattr__(self, "max_depth", counts.depth("max_depth", max_depth))
        object.__setattr__(self, "contribution", counts.contribution(contribution))
        object.__setattr__(self, "ambient", color("ambient", ambient))
