"""Beam tracing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Triple, colour, positive
from . import counts
from .base import CoreIntegrator


@dataclass(frozen=True, init=False)
class BeamTraced(CoreIntegrator):
    """Beam tracing (Heckbert and Hanrahan 1984): polygonal beams in place of rays, and edges that are exact.

    All that the camera sees is one beam. Faces part it into polygons, flat mirrors throw these back, panes
    and flat faces of glass let them through, and beams from lights part them into lit and shadowed. A pixel
    is the sum over the polygons in its square of their areas there, each times its radiance, taken at three
    points of each of its triangles; so the picture has no noise, and one sample is as good as many (with two,
    the error is 0 where with one it is not known). It is `Whitted`'s picture: all scattering but by mirrors
    and smooth glass is left to `ambient`.

    Refraction is an approximation, as in the paper: behind a face of glass, rays have no point in common. The
    beam gets one from which its middle ray is exact and the others go by tangents in the place of Snell's
    sines. Beams are cut until that is off by no more than `tolerance`. Behind a window of parallel faces,
    directions are exact again, and places deviate by the rest of the tolerance within the glass.

    Beams meet meshes alone, of any opaque material, `ThinDielectric` or `Dielectric`, in the light of lights
    without extent (`PointLight`, `SpotLight`, `Projector`, `DirectionalLight`; 64 at most), seen through a
    pinhole and a `BoxFilter`. Glass throws shadows as other things do. The time grows with the square of the
    number of faces in view, and with that of refracted beams.

    Parameters
    ----------
    max_depth : int
        Maximum number of surfaces on a light path.
    ambient : float or 3 floats
        Uniform radiance in place of light that is not followed; surfaces reflect their ambient share of it,
        as in `RayCast`.
    tolerance : float
        Maximum deviation of a refracted ray's direction, in pixels, above 0; infinity cuts no beam for it, as
        in the paper.

    Raises
    ------
    ValueError
        If a number is out of its range. When rendering, if beams do not support the scene: shapes that are no
        meshes, shine, have masks, mirror or refract with bent normals, or are two glasses whose boxes
        overlap; environments; other cameras and filters.
    TypeError
        If an argument is of the wrong kind.

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
        object.__setattr__(self, "ambient", colour("ambient", ambient))
        object.__setattr__(
            self, "tolerance", np.inf if tolerance == np.inf else positive("tolerance", tolerance)
        )
