"""The picture that made ray tracing known."""

from __future__ import annotations

from ..cameras import Camera
from ..lights import PointLight
from ..materials import BlinnPhong, Dielectric, Mirror, Mix
from ..scene.scene import Scene
from ..shapes import Sphere
from ..shapes.mesh import Mesh
from ..textures import Checker

_RED, _YELLOW = (0.8, 0.1, 0.05), (0.9, 0.8, 0.1)
_SKY = (0.25, 0.45, 0.8)


def whitted_spheres(width: int = 640, height: int = 480) -> tuple[Scene, Camera]:
    """Return a glass ball and a shiny ball over a checkerboard, and a camera.

    After Whitted, "An Improved Illumination Model for Shaded Display" (1980). Render it with `Whitted`, as in
    the paper, or with `Path`.

    Parameters
    ----------
    width, height : int
        Size of the picture in pixels.

    Returns
    -------
    scene : Scene
        Shapes: the glass ball, the shiny ball behind it, the checkerboard.
    camera : Camera

    See Also
    --------
    Whitted : The integrator.

    Examples
    --------
    >>> scene, camera = rw.scenes.whitted_spheres(width=8, height=6)
    >>> rw.render(scene, camera, rw.Whitted(), samples=1, progress=False).rgb.shape
    (6, 8, 3)
    """
    board = Mesh(
        [(-6, 0, 6), (6, 0, 6), (6, 0, -18), (-6, 0, -18)],
        [[0, 1, 2], [0, 2, 3]],
        uv=[(0, 0), (12, 0), (12, 24), (0, 24)],
        material=BlinnPhong(ambient=0.1, diffuse=Checker(_RED, _YELLOW), specular=0.0),
    )
    shiny = Mix(BlinnPhong(ambient=0.1, diffuse=(0.5, 0.5, 0.6), specular=0.3, exponent=60.0), Mirror(), 0.5)
    shapes: list[Sphere | Mesh] = [
        Sphere((-0.6, 2.0, 1.4), 1.15, material=Dielectric(1.5)),
        Sphere((0.9, 1.35, -1.2), 1.1, material=shiny),
        board,
    ]
    lights = [PointLight((-5.0, 12.0, 8.0), 420.0)]
    camera = Camera((-0.2, 2.6, 8.0), (0.2, 1.6, 0.0), fov=38.0, width=width, height=height)
    return Scene(shapes, lights=lights, environment=_SKY), camera
