"""A studio: a floor, a lamp, a soft sky and a camera around any mesh."""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..accelerators import BVH, Accelerator
from ..cameras import Camera
from ..materials import Diffuse, Material
from ..scene.framing import direction, framed, outline, upright_axes
from ..scene.instance import meshes
from ..scene.scene import Scene
from ..shapes.mesh import Mesh

# Where the lamp stands, in degrees: around the upright axis, and above the floor.
_LAMP_ANGLES = (-25.0, 55.0)
_SKY = (0.42, 0.45, 0.5)
_BVH = BVH()


def studio(
    shapes: Any,
    up: Literal["y", "z"] = "y",
    width: int = 640,
    height: int = 480,
    accelerator: Accelerator = _BVH,
) -> tuple[Scene, Camera]:
    """Return a scene and a camera that show any mesh well: framed, lit, and on a floor.

    The camera looks from three quarters; everything is sized by the mesh. A large lamp stands to the camera's
    left, above the mesh, and a soft sky surrounds it.

    Parameters
    ----------
    shapes : Mesh, another shape, Instance, trimesh object, path, or list of these
        What to show; `Scene.shapes` begins with it, and ends with the floor and the lamp.
    up : {"y", "z"}
        The axis of the mesh that points up.
    width, height : int
        Size of the picture in pixels.
    accelerator : BVH, Grid, NestedGrid or BruteForce
        The structure that finds hits.

    Raises
    ------
    FileNotFoundError, ValueError, TypeError
        As `Scene`; ValueError too if there is nothing to show, or `up` is another axis.
    """
    axes = upright_axes(up)
    parts = meshes(shapes)
    points = outline(parts)
    low, high = points.min(axis=0), points.max(axis=0)
    centre = low / 2 + high / 2
    radius = float(np.linalg.norm(high / 2 - low / 2)) or 1.0
    upward = axes[1]
    camera = framed(parts, up, width, height)

    # The floor lies a little under the mesh, so that a flat bottom is not in the same plane.
    ground = centre + (float(((points - centre) @ upward).min()) - 1e-4 * radius) * upward
    floor = _square(ground, axes[0], -axes[2], 25 * radius, Diffuse(0.4))
    beam = direction(_LAMP_ANGLES) @ axes
    side = np.cross(upward, beam) / np.linalg.norm(np.cross(upward, beam))
    # Across `side` and its perpendicular, so that the square's normal is -beam: it shines on the mesh.
    lamp = _square(centre + 5 * radius * beam, np.cross(beam, side), side, 1.5 * radius, Diffuse(0.0), 9.0)
    return Scene([*parts, floor, lamp], environment=_SKY, accelerator=accelerator), camera


def _square(
    centre: NDArray[np.float64],
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    half: float,
    material: Material,
    emission: float | None = None,
) -> Mesh:
    """Square with sides along unit vectors `a` and `b`; its normal is a x b."""
    corners = [centre + half * (i * a + j * b) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return Mesh(np.array(corners), [[0, 1, 2], [0, 2, 3]], material=material, emission=emission)
