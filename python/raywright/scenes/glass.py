"""A glass and a mirror ball in a box, with their caustics."""

from __future__ import annotations

import numpy as np

from ..cameras import Camera
from ..materials import Dielectric, Mirror
from ..scene.scene import Scene
from ..shapes import Sphere
from . import cornell, cornell_spectra

_RADIUS = 100.0
# Relative side of the lamp in the middle of the ceiling; the hole keeps its size.
_LAMP_SIZE = 0.3


def glass_spheres(width: int = 512, height: int = 512) -> tuple[Scene, Camera]:
    """Return the Cornell box with a mirror ball and a glass ball in place of its blocks, and its camera.

    After Jensen, "Global Illumination using Photon Maps" (1996). The lamp is small, so paths from the camera
    hardly find the caustics of the balls on floor and walls.

    Parameters
    ----------
    width, height : int
        Size of the picture in pixels.

    Returns
    -------
    scene : Scene
        Shapes: lamp, floor, ceiling, back, right (green), left (red), mirror ball, glass ball.
    camera : Camera

    See Also
    --------
    PhotonMap : Finds its caustics.

    Examples
    --------
    >>> scene, camera = rw.scenes.glass_spheres(width=8, height=8)
    >>> len(scene.shapes)
    8
    """
    corners = np.array(cornell.LIGHT[0], np.float64)
    middle = corners.mean(axis=0)
    # Just below the hole in the ceiling, whose rest stays open and dark.
    small = middle + _LAMP_SIZE * (corners - middle) - (0.0, 0.5, 0.0)
    radiance = np.array(cornell_spectra.EMISSION) / _LAMP_SIZE**2
    shapes = [cornell.quads([[tuple(corner) for corner in small]], cornell.LAMP, radiance)]
    shapes += [cornell.quads(part, cornell.WHITE) for part in (cornell.FLOOR, cornell.CEILING, cornell.BACK)]
    shapes += [cornell.quads(cornell.RIGHT, cornell.GREEN), cornell.quads(cornell.LEFT, cornell.RED)]
    balls = [
        Sphere((390.0, _RADIUS, 360.0), _RADIUS, material=Mirror()),
        Sphere((180.0, _RADIUS, 200.0), _RADIUS, material=Dielectric(1.5)),
    ]
    return Scene([*shapes, *balls]), cornell.camera(width, height)
