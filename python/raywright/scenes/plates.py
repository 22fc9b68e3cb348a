"""Plates and lamps on which no one way to find light will do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..cameras import Camera
from ..materials import Conductor, Diffuse
from ..scene.scene import Scene
from ..shapes import Sphere
from ..shapes.mesh import Mesh

_EYE = np.array((0.0, 2.0, 15.0))
# Half extents of each plate, along x and across.
_HALF = (4.0, 0.5)
# Centers of the plates, in y and z, and their roughness alpha.
_PLATES = (((-1.2, 1.4), 0.005), ((-2.1, 2.8), 0.02), ((-2.8, 4.4), 0.05), ((-3.3, 6.1), 0.1))
# Position along x, radius, and radiance: all emit the same power.
_LAMPS = tuple((x, r, 1.0 / r**2) for x, r in ((-3.75, 1 / 30), (-1.25, 0.1), (1.25, 0.3), (3.75, 0.9)))


def veach_plates(width: int = 512, height: int = 512) -> tuple[Scene, Camera]:
    """Return four glossy plates that mirror four lamps, and a camera.

    From Veach and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering" (1995): the
    lamps are small to large and give equal light, the plates are nearly smooth to rough. Light sampling suits
    small lamps on rough plates, and BSDF sampling large lamps on smooth plates; only their combination has
    little noise everywhere.

    Parameters
    ----------
    width, height : int
        Size of the picture in pixels.

    Returns
    -------
    scene : Scene
        Shapes: the lamps from small to large, a lamp far above, the plates from smooth to rough, the wall.
    camera : Camera

    See Also
    --------
    Direct : Combines both strategies.

    Examples
    --------
    >>> scene, camera = rw.scenes.veach_plates(width=8, height=8)
    >>> sum(shape.emission is not None for shape in scene.shapes)
    5
    """
    lamps: list[Sphere | Mesh] = [
        Sphere((x, 0.0, 0.0), radius, material=Diffuse(0.0), emission=radiance)
        for x, radius, radiance in _LAMPS
    ]
    lamps.append(Sphere((10.0, 10.0, 4.0), 0.5, material=Diffuse(0.0), emission=800.0))
    plates = [_plate(np.array((0.0, *at)), alpha) for at, alpha in _PLATES]
    wall = Mesh(
        [(-20, -5, -3), (20, -5, -3), (20, 20, -3), (-20, 20, -3), (-20, -5, 20), (20, -5, 20)],
        [[0, 1, 2], [0, 2, 3], [4, 5, 1], [4, 1, 0]],
        material=Diffuse(0.4),
    )
    return Scene([*lamps, *plates, wall]), Camera(
        _EYE, (0.0, -2.0, 2.5), fov=38.0, width=width, height=height
    )


def _plate(middle: NDArray[np.float64], alpha: float) -> Mesh:
    """Return a plate that mirrors the lamps to the eye."""

    def unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(vector / np.linalg.norm(vector))

    normal = unit(unit(_EYE - middle) + unit(-middle))
    x, y = np.array((1.0, 0.0, 0.0)), np.cross(normal, (1.0, 0.0, 0.0))
    corners = [middle + i * _HALF[0] * x + j * _HALF[1] * y for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return Mesh(np.array(corners), [[0, 1, 2], [0, 2, 3]], material=Conductor("Ag", alpha=alpha))
