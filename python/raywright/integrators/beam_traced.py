"""Beam tracing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Triple, color, positive
from . import counts
from .base import CoreIntegrator


@dataclass(frozen=True, init=False)
class BeamTraced(CoreIntegrator):
    """Beam tracing (Heckbert and Hanrahan 1984): polygonal beams in place of rays, and edges that are exact.

    One beam covers the whole view. Faces cut it into polygons; flat mirrors reflect them, panes and flat
    glass transmit them, and beams from lights divide them into lit and shadowed parts. A pixel sums area
    times radiance over the polygons in its square, with the radiance evaluated at three points of each
    triangle. So the picture has no noise, and one sample is as good as many (an error estimate of 0 needs
    two). The picture is that of `Whitted`: `ambient` replaces all scattering except by mirrors and smooth
    glass.

    Refraction is an approximation, as in the paper: behind a face of glass, the rays of a beam have no common
    origin. The beam gets an origin for which its middle ray is exact, and the others use tangents in place of
    Snell's sines. Beams are split until the deviation is at most `tolerance`. Behind a window of parallel
    faces directions are exact again, and positions deviate by the error within the glass.

    Beams support meshes only, of any opaque material, `ThinDielectric` or `Dielectric`. Lights have no extent
    (`PointLight`, `SpotLight`, `ProjectorLight`, `DirectionalLight`; 64 at most), the camera is a pinhole,
    and the filter a `BoxFilter`. Glass casts shadows like opaque surfaces. The time grows with the square of
    the number of visible faces, and of refracted beams.

    Parameters
    ----------
    max_depth : int
        Maximum number of surfaces on a light path.
    ambient : float or 3 floats
        Uniform radiance in place of light that is not traced; surfaces reflect their ambient share of it, as
        in `RayCast`.
    tolerance : float
        Maximum deviation of a refracted ray's direction, in pixels, above 0; with infinity beams are not
        split for it, as in the paper.

    Raises
    ------
    ValueError
        If a number is out of its range. When rendering, if beams do not support the scene: shapes that are no
        meshes, shine, have masks, mirror or refract with bent normals, or are two glasses whose boxes
        overlap; environments; other cameras and filters.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    Whitted : The same picture by rays.
    ConeTraced : Cones in place of beams.

    Examples
    --------
    >>> floor = rw.Mesh([[-9, -9, 0], [9, -9, 0], [0, 9, 0]], [[0, 1, 2]])
    >>> scene = rw.Scene(floor, lights=[rw.PointLight((0, 0, 2), intensity=4.0)])
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> image = rw.render(scene, camera, rw.integrators.BeamTraced(), samples=1, progress=False)
    >>> bool(image.rgb[1, 1, 0] > image.rgb[0, 0, 0])
    True
    """

    max_depth: int
    ambient: Triple
    tolerance: float

    def __init__(self, max_depth: int = 8, ambient: ArrayLike = 0.0, tolerance: float = 0.25) -> None:
        object.__setattr__(self, "max_depth", counts.depth("max_depth", max_depth))
        object.__setattr__(self, "ambient", color("ambient", ambient))
        object.__setattr__(
            self, "tolerance", np.inf if tolerance == np.inf else positive("tolerance", tolerance)
        )
