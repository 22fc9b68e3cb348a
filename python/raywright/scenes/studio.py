"""A studio: a floor, a lamp, a soft sky and a camera around any mesh."""

import math
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..accelerators import BVH, Accelerator
from ..cameras import Camera
from ..instance import Instance
from ..io.meshes import meshes
from ..materials import Diffuse, Material
from ..mesh import Mesh
from ..scene import Scene
from ..shapes import Shape

_FOV = 35.0
# Where the camera and the lamp stand, in degrees: around the upright axis, and above the floor.
_CAMERA_ANGLES = (35.0, 22.0)
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
    shapes : Mesh, trimesh object, path, or list of these
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
    if up not in ("y", "z"):
        raise ValueError(f"up must be 'y' or 'z', got {up!r}")
    parts = meshes(shapes)
    points = np.concatenate([np.empty((0, 3)), *map(_outline, parts)])
    if not len(points):
        raise ValueError("there are no faces to show")
    low, high = points.min(axis=0), points.max(axis=0)
    centre = low / 2 + high / 2
    radius = float(np.linalg.norm(high / 2 - low / 2)) or 1.0
    axes = _axes(up)
    away = _direction(_CAMERA_ANGLES) @ axes
    upward = axes[1]

    points -= centre
    distance = _distance(points, away, upward, width / height)
    camera = Camera(centre + distance * away, centre, upward, _FOV, width, height)

    # The floor lies a little under the mesh, so that a flat bottom is not in the same plane.
    ground = centre + (float((points @ upward).min()) - 1e-4 * radius) * upward
    floor = _square(ground, axes[0], -axes[2], 25 * radius, Diffuse(0.4))
    beam = _direction(_LAMP_ANGLES) @ axes
    side = np.cross(upward, beam) / np.linalg.norm(np.cross(upward, beam))
    # Across `side` and its perpendicular, so that the square's normal is -beam: it shines on the mesh.
    lamp = _square(centre + 5 * radius * beam, np.cross(beam, side), side, 1.5 * radius, Diffuse(0.0), 9.0)
    return Scene([*parts, floor, lamp], environment=_SKY, accelerator=accelerator), camera


def _outline(shape: Mesh | Shape | Instance) -> NDArray[np.float64]:
    """Return points around a shape, (N, 3): a mesh's own, or the corners of the box of what is no mesh."""
    if isinstance(shape, Mesh):
        return shape.used_vertices()
    if isinstance(shape, Instance):
        raise TypeError("a studio takes no Instance, whose size it cannot tell")
    low, high = shape.bounds
    if not np.isfinite([low, high]).all():
        raise ValueError(f"a studio has no room for a {type(shape).__name__} without end")
    return np.array([np.where(upper, high, low) for upper in np.ndindex(2, 2, 2)])


def _axes(up: str) -> NDArray[np.float64]:
    """Rows: right, up, and towards the viewer; right-handed."""
    return np.array(
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]] if up == "y" else [[1, 0, 0], [0, 0, 1], [0, -1, 0]], float
    )


def _direction(angles: tuple[float, float]) -> NDArray[np.float64]:
    around, above = map(math.radians, angles)
    return np.array([math.cos(above) * math.sin(around), math.sin(above), math.cos(above) * math.cos(around)])


def _distance(
    points: NDArray[np.float64], away: NDArray[np.float64], upward: NDArray[np.float64], aspect: float
) -> float:
    """Return the least distance at which all points are in the picture, and three tenths more."""
    right = np.cross(upward, away) / np.linalg.norm(np.cross(upward, away))
    slope = math.tan(math.radians(_FOV) / 2)
    needed = points @ away + np.maximum(
        np.abs(points @ right) / (slope * aspect), np.abs(points @ np.cross(away, right)) / slope
    )
    return 1.3 * float(needed.max()) or 1.0


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
