"""A studio: a floor, a lamp, a soft sky and a camera around any mesh."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..accelerators import BVH, Accelerator
from ..cameras import AnyCamera, Camera
from ..materials import Diffuse, Material
from ..scene.framing import CAMERA_ANGLES, direction, framed, outline, upright_axes
from ..scene.instance import meshes
from ..scene.scene import Scene
from ..shapes.mesh import Mesh

# Direction to the lamp in degrees: around the upright axis, and above the floor.
_LAMP_ANGLES = (-25.0, 55.0)
# Distance of the lamp, in radii of the mesh.
_LAMP_DISTANCE = 5.0
_SKY = (0.42, 0.45, 0.5)
_BVH = BVH()


def studio(
    shapes: Any,
    up: Literal["y", "z"] = "y",
    width: int = 640,
    height: int = 480,
    accelerator: Accelerator = _BVH,
) -> tuple[Scene, Camera]:
    """Return a studio: a scene and a camera with the mesh framed, lit, and on a floor.

    The camera has a three-quarter view; all sizes follow from the mesh. A large lamp stands to the camera's
    left, above the mesh, and a soft sky surrounds it.

    Parameters
    ----------
    shapes : Mesh, another shape, Instance, trimesh object, path, or list of these
        Shapes to show. `Scene.shapes` begins with them, and ends with the floor and the lamp.
    up : {"y", "z"}
        The axis of the mesh that points up.
    width, height : int
        Size of the picture in pixels.
    accelerator : BVH or another accelerator
        The accelerator.

    Returns
    -------
    scene : Scene
    camera : Camera

    Raises
    ------
    FileNotFoundError, ValueError, TypeError
        As `Scene`; ValueError too if there is nothing to show, or `up` is another axis.

    See Also
    --------
    load : Lights files without lights so.

    Examples
    --------
    >>> scene, camera = rw.scenes.studio(rw.scenes.torus_knot(along=40, around=8), width=8, height=8)
    >>> len(scene.shapes)
    3
    """
    parts = meshes(shapes)
    camera = framed(parts, up, width, height)
    center, radius, axes = _room(parts, up)

    # The floor lies slightly below the mesh, so that a flat bottom is not in its plane.
    lowest = float(((outline(parts) - center) @ axes[1]).min())
    ground = center + (lowest - 1e-4 * radius) * axes[1]
    floor = _square(ground, axes[0], -axes[2], 25 * radius, Diffuse(0.4))
    lamp = _lamp(center, radius, axes)
    return Scene([*parts, floor, lamp], environment=_SKY, accelerator=accelerator), camera


def lit(shapes: Any, camera: AnyCamera) -> Scene:
    """Return shapes in the light of the studio, without its floor, for a camera that stands elsewhere.

    The lamp stands to the camera's left as it does in the studio, as large as it is there as seen from
    the mesh, and no nearer than the camera, so that it is in the picture only for cameras that look up.

    Parameters
    ----------
    shapes : Mesh, another shape, Instance, trimesh object, path, or list of these
        Shapes to show; their y points up.
    camera : Camera or another kind
        Camera of the picture.

    Raises
    ------
    FileNotFoundError, ValueError, TypeError
        As `studio`.
    """
    parts = meshes(shapes)
    center, radius, axes = _room(parts, "y")
    # For a camera that looks straight down, the bottom of its picture counts as near.
    for away in (-camera.forward, -np.array(camera.up)):
        level = away - (away @ axes[1]) * axes[1]
        if np.linalg.norm(level) > 1e-6 * np.linalg.norm(away):
            break
    around = math.atan2(level @ axes[0], level @ axes[2]) - math.radians(CAMERA_ANGLES[0])
    cos, sin = math.cos(around), math.sin(around)
    turned = np.stack([cos * axes[0] - sin * axes[2], axes[1], sin * axes[0] + cos * axes[2]])
    farther = float(np.linalg.norm(np.array(camera.position) - center)) / _LAMP_DISTANCE
    return Scene([*parts, _lamp(center, max(radius, farther), turned)], environment=_SKY)


def _room(parts: Any, up: str) -> tuple[NDArray[np.float64], float, NDArray[np.float64]]:
    """Return the middle of shapes, how far they reach from it, and which way is right, up, and near."""
    axes = upright_axes(up)
    points = outline(parts)
    low, high = points.min(axis=0), points.max(axis=0)
    return low / 2 + high / 2, float(np.linalg.norm(high / 2 - low / 2)) or 1.0, axes


def _lamp(center: NDArray[np.float64], radius: float, axes: NDArray[np.float64]) -> Mesh:
    beam = direction(_LAMP_ANGLES) @ axes
    side = np.cross(axes[1], beam) / np.linalg.norm(np.cross(axes[1], beam))
    # Spanned by `side` and its perpendicular, so that the normal is -beam: the square shines on the mesh.
    middle = center + _LAMP_DISTANCE * radius * beam
    return _square(middle, np.cross(beam, side), side, 1.5 * radius, Diffuse(0.0), 9.0)


def _square(
    center: NDArray[np.float64],
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    half: float,
    material: Material,
    emission: float | None = None,
) -> Mesh:
    """Square with sides along unit vectors `a` and `b`; its normal is a x b."""
    corners = [center + half * (i * a + j * b) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return Mesh(np.array(corners), [[0, 1, 2], [0, 2, 3]], material=material, emission=emission)
