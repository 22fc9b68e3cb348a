"""Classic scenes of thin films: a soap bubble, and oil on a wet road."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..cameras import Camera
from ..lights import EnvironmentMap
from ..materials import Dielectric, Diffuse, SoapFilm, ThinFilm
from ..scene.scene import Scene
from ..shapes import Sphere
from ..shapes.mesh import Mesh
from ..textures import FBm, ImageTexture, MixTexture

# Turns environment maps, with y up, into scenes with z up.
_UP: NDArray[np.float64] = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
_BLACK_FILM = 12.0


def soap_bubble(width: int = 480, height: int = 480) -> tuple[Scene, Camera]:
    """Return a soap bubble in a dark room with two windows, and a camera.

    The soap has drained: the film is black at the top, where it is 12 nm thick, and grows to 1000 nm at the
    bottom, with all interference colors between. Each window is seen twice, in the front and, upside down, in
    the back.

    Parameters
    ----------
    width, height : int
        Size of the picture in pixels.

    Returns
    -------
    scene : Scene
        Shapes: the bubble, of radius 1 around the origin. Up is z.
    camera : Camera

    See Also
    --------
    materials.SoapFilm : The material.

    Examples
    --------
    >>> scene, camera = rw.scenes.soap_bubble(width=8, height=8)
    >>> type(scene.shapes[0].material).__name__
    'SoapFilm'
    """
    # From the bottom to the top, by latitude.
    latitude = np.linspace(0.0, 1.0, 256)
    fallen = np.clip(0.93 - latitude, 0.0, 1.0) / 0.93
    least, most = (
        ImageTexture(
            (_BLACK_FILM + depth * fallen**1.2)[::-1, np.newaxis].repeat(2, 1).astype(np.float32),
            linear=True,
            wrap=("repeat", "clamp"),
        )
        for depth in (820.0, 1160.0)
    )
    swirls = FBm(0.0, 1.0, 1.6, octaves=4, seed=5)
    bubble = Sphere((0.0, 0.0, 0.0), 1.0, material=SoapFilm(MixTexture(least, most, swirls)))
    camera = Camera(
        (0.0, -5.2, 0.35), (0.0, 0.0, 0.0), up=(0.0, 0.0, 1.0), fov=26.0, width=width, height=height
    )
    return Scene([bubble], environment=EnvironmentMap(_room(), _UP)), camera


def _room() -> NDArray[np.float32]:
    """Return the radiance around the bubble: walls that are all but dark, and windows of four panes."""
    rows, columns = 128, 256
    room = np.full((rows, columns, 3), (0.035, 0.035, 0.045), np.float32)
    room[: rows // 4] = (0.09, 0.09, 0.1)
    # One window beside the camera, which looks at the middle, and one in front of it, at the side.
    for left, right in ((12, 62), (196, 240)):
        room[34:86, left:right] = (9.0, 9.3, 10.0)
        room[58:61, left:right] = 0.02
        middle = (left + right) // 2
        room[34:86, middle - 1 : middle + 1] = 0.02
    return room


def oil_on_water(width: int = 480, height: int = 320) -> tuple[Scene, Camera]:
    """Return a film of oil that spreads on a puddle on black asphalt, under an even sky, and a camera.

    Beside the oil only water reflects; the rims of the slick are the thinnest.

    Parameters
    ----------
    width, height : int
        Size of the picture in pixels.

    Returns
    -------
    scene : Scene
        Shapes: the water, the asphalt below. Up is z.
    camera : Camera

    See Also
    --------
    materials.ThinFilm : The material.

    Examples
    --------
    >>> scene, camera = rw.scenes.oil_on_water(width=8, height=8)
    >>> len(scene.shapes)
    2
    """
    side = 8.0
    corners = [(-side, -side), (side, -side), (side, side), (-side, side)]
    faces = [[0, 1, 2], [0, 2, 3]]
    # The oil film at its thickest and its thinnest.
    thick, thin = (ImageTexture(_slick(depth), linear=True) for depth in (760.0, 400.0))
    thickness = MixTexture(thick, thin, FBm(0.0, 1.0, 0.8, octaves=5, seed=11))
    water = Mesh(
        [(x, y, 0.0) for x, y in corners],
        faces,
        uv=[(0, 0), (1, 0), (1, 1), (0, 1)],
        material=ThinFilm(thickness, 1.47, base=Dielectric(1.33)),
    )
    asphalt = Mesh([(x, y, -0.05) for x, y in corners], faces, material=Diffuse(0.03))
    camera = Camera(
        (0.0, -4.0, 3.4), (0.0, 0.3, 0.0), up=(0.0, 0.0, 1.0), fov=40.0, width=width, height=height
    )
    return Scene([water, asphalt], environment=2.0), camera


def _slick(depth: float) -> NDArray[np.float32]:
    """Return the thickness of drops that have run together, in nm, over a square: 0 beyond their rim."""
    y, x = np.mgrid[-1:1:512j, -1:1:512j]
    drops = ((-0.05, 0.02, 0.16), (0.13, 0.08, 0.11), (-0.2, 0.16, 0.09), (0.06, -0.13, 0.08))
    sum_of_drops = sum(np.exp(-((x - at) ** 2 + (y - across) ** 2) / size**2) for at, across, size in drops)
    thickness: NDArray[np.float32] = np.clip(depth * (sum_of_drops - 0.1), 0.0, None).astype(np.float32)
    return thickness
