"""A ball that shows a material."""

from __future__ import annotations

import math

from ..cameras import Camera
from ..materials import Diffuse, Material
from ..scene.scene import Scene
from ..shapes import Sphere, Torus
from ..shapes.mesh import Mesh
from ..textures import Checker

_SKY = 0.35
# Half the side of the board, in radii of the ball, and squares along it.
_REACH, _SQUARES = 12.0, 24


def material_ball(
    material: Material | None = None, width: int = 512, height: int = 512
) -> tuple[Scene, Camera]:
    """Return a ball of some material on a ring over a checkerboard, lit by a lamp and a soft sky.

    The board makes refraction and reflection visible, the lamp highlights, and the sky the rim.

    Parameters
    ----------
    material : material, optional
        Material of the ball; ``Diffuse(0.5)`` if not given.
    width, height : int
        Size of the picture in pixels.

    Returns
    -------
    scene : Scene
        Shapes: the ball, of radius 1 around the origin, the ring that it stands on, the board, the lamp.
    camera : Camera

    See Also
    --------
    scenes.studio : Any shapes.

    Examples
    --------
    >>> scene, camera = rw.scenes.material_ball(rw.Conductor("gold"), width=8, height=8)
    >>> scene.shapes[0].material.metal
    'gold'
    """
    ground = -1.12
    board = Mesh(
        [
            (-_REACH, ground, _REACH),
            (_REACH, ground, _REACH),
            (_REACH, ground, -_REACH),
            (-_REACH, ground, -_REACH),
        ],
        [[0, 1, 2], [0, 2, 3]],
        uv=[(0, 0), (_SQUARES, 0), (_SQUARES, _SQUARES), (0, _SQUARES)],
        material=Diffuse(Checker(0.15, 0.6)),
    )
    # The ball touches the ring: their centers are the ball's radius plus the ring's thickness apart.
    thick = 0.12
    height_of_ring = ground + thick
    around = math.sqrt((1.0 + thick) ** 2 - height_of_ring**2)
    ring = Torus((0.0, height_of_ring, 0.0), (0.0, 1.0, 0.0), around, thick, material=Diffuse(0.2))
    x, y, z, half = -3.5, 5.0, 3.0, 1.2
    lamp = Mesh(
        [(x - half, y, z - half), (x + half, y, z - half), (x + half, y, z + half), (x - half, y, z + half)],
        [[0, 1, 2], [0, 2, 3]],
        material=Diffuse(0.0),
        emission=14.0,
    )
    ball = Sphere((0.0, 0.0, 0.0), 1.0, material=material)
    camera = Camera((0.0, 1.6, 5.2), (0.0, -0.1, 0.0), fov=32.0, width=width, height=height)
    return Scene([ball, ring, board, lamp], environment=_SKY), camera
