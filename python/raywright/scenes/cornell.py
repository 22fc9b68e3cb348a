"""The Cornell box."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Triple
from ..cameras import Camera
from ..materials import Diffuse
from ..scene.instance import only_meshes
from ..scene.scene import Scene
from ..shapes.mesh import Mesh
from . import cornell_spectra

Quads = list[list[Triple]]

WHITE, RED, GREEN = map(Diffuse, (cornell_spectra.WHITE, cornell_spectra.RED, cornell_spectra.GREEN))
LAMP = Diffuse(cornell_spectra.LAMP_REFLECTANCE)

# The measured box, in millimeters: each row is a quadrilateral, anticlockwise as seen from inside the room
# (walls) or from outside (blocks). https://www.graphics.cornell.edu/online/box/data.html
LIGHT: Quads = [[(343, 548.8, 227), (343, 548.8, 332), (213, 548.8, 332), (213, 548.8, 227)]]
FLOOR: Quads = [[(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]]
BACK: Quads = [[(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]]
RIGHT: Quads = [[(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]]
LEFT: Quads = [[(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]]
_CEILING: list[Triple] = [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]
SHORT_BLOCK: Quads = [
    [(130, 165, 65), (82, 165, 225), (240, 165, 272), (290, 165, 114)],
    [(290, 0, 114), (290, 165, 114), (240, 165, 272), (240, 0, 272)],
    [(130, 0, 65), (130, 165, 65), (290, 165, 114), (290, 0, 114)],
    [(82, 0, 225), (82, 165, 225), (130, 165, 65), (130, 0, 65)],
    [(240, 0, 272), (240, 165, 272), (82, 165, 225), (82, 0, 225)],
]
TALL_BLOCK: Quads = [
    [(423, 330, 247), (265, 330, 296), (314, 330, 456), (472, 330, 406)],
    [(423, 0, 247), (423, 330, 247), (472, 330, 406), (472, 0, 406)],
    [(472, 0, 406), (472, 330, 406), (314, 330, 456), (314, 0, 456)],
    [(314, 0, 456), (314, 330, 456), (265, 330, 296), (265, 0, 296)],
    [(265, 0, 296), (265, 330, 296), (423, 330, 247), (423, 0, 247)],
]
# The light fills a hole in the ceiling: the room is closed, and no two faces overlap.
CEILING: Quads = [
    [_CEILING[i], _CEILING[j], LIGHT[0][j], LIGHT[0][i]] for i, j in ((0, 1), (1, 2), (2, 3), (3, 0))
]

# Middle of the short block's floor, and the room for objects in its place.
_STAND = (186.0, 0.0, 169.0)
_STAND_SIZE = (230.0, 260.0, 230.0)


def cornell_box(
    mesh: Any = None, width: int = 512, height: int = 512, emission: ArrayLike = cornell_spectra.EMISSION
) -> tuple[Scene, Camera]:
    """Return the Cornell box (Goral et al. 1984), in millimeters, and the camera that belongs to it.

    Dimensions and colors are those of the real box at Cornell. Colors are measured spectra, converted to
    linear Rec. 709 such that a constant spectrum is gray.

    Parameters
    ----------
    mesh : Mesh, trimesh object, path, or list of these, optional
        Replaces the short block, scaled to fit there, with its y axis up.
    width, height : int
        Size of the picture in pixels.
    emission : float or 3 floats
        Radiance of the light in W·sr⁻¹·m⁻²; by default that of the lamp.

    Returns
    -------
    scene : Scene
        Shapes: light, floor, ceiling, back, right (green), left (red), tall block, then the short block or
        `mesh`.
    camera : Camera
        Camera in front of the open side.

    Raises
    ------
    ValueError
        If `mesh` holds no faces, or a number is out of its range.

    See Also
    --------
    scenes.glass_spheres : The box with a mirror ball and a glass ball.

    Examples
    --------
    >>> scene, camera = rw.scenes.cornell_box(width=8, height=8)
    >>> len(scene.shapes), camera.width
    (8, 8)
    >>> rw.render(scene, camera, samples=1, progress=False).rgb.shape
    (8, 8, 3)
    """
    shapes = [quads(LIGHT, LAMP, emission)]
    shapes += [quads(corners, WHITE) for corners in (FLOOR, CEILING, BACK)]
    shapes += [quads(RIGHT, GREEN), quads(LEFT, RED), quads(TALL_BLOCK, WHITE)]
    shapes += [quads(SHORT_BLOCK, WHITE)] if mesh is None else _stood(only_meshes(mesh))
    return Scene(shapes), camera(width, height)


def camera(width: int, height: int) -> Camera:
    """Return the box's camera: a lens of 35 mm before a film of 25 mm by 25 mm."""
    fov = math.degrees(2 * math.atan(0.0125 / 0.035))
    return Camera((278, 273, -800), (278, 273, 0), fov=fov, width=width, height=height)


def quads(corners: Quads, material: Diffuse, emission: ArrayLike | None = None) -> Mesh:
    """Two triangles for each quadrilateral, with equal corners joined."""
    vertices, index = np.unique(np.array(corners, np.float64).reshape(-1, 3), axis=0, return_inverse=True)
    quads = index.reshape(-1, 4)
    faces = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    return Mesh(vertices, faces, material=material, emission=emission)


def _stood(parts: tuple[Mesh, ...]) -> list[Mesh]:
    """Scale meshes as one to fit the stand, put the middle of their bottom on its middle."""
    boxes = [box for part in parts if (box := part.bounds) is not None]
    if not boxes:
        raise ValueError("mesh holds no faces")
    low, high = np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)
    size = high - low
    scale = float(np.min(np.divide(_STAND_SIZE, size, out=np.full(3, np.inf), where=size > 0)))
    if not math.isfinite(scale):
        raise ValueError("mesh is a single point")
    foot = np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = np.array(_STAND) - scale * foot
    return [part.transformed(matrix) for part in parts]
