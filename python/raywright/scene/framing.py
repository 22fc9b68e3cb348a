"""A camera that has everything in its picture."""

from __future__ import annotations

import math
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..arrays import integer
from ..cameras import Camera
from ..shapes.mesh import Mesh
from .instance import AnyShape, Instance, meshes

_FOV = 35.0
# Squares of larger coordinates overflow.
_FARTHEST = 1e150
# Direction to the camera in degrees: around the upright axis, and above the ground.
CAMERA_ANGLES = (35.0, 22.0)


def framed(
    shapes: Any,
    up: Literal["y", "z"] = "y",
    width: int = 640,
    height: int = 480,
) -> Camera:
    """Return a camera that looks at shapes from three quarters, with all of them in its picture.

    Parameters
    ----------
    shapes : Mesh, another shape, Instance, trimesh object, path, or list of these
        Return the point to look at.
    up : {"y", "z"}
        The axis that points up.
    width, height : int
        Size of the picture in pixels.

    Raises
    ------
    FileNotFoundError, ValueError, TypeError
        As `Scene`; ValueError too if there is nothing to look at, a shape has no end, or `up` is another
        axis.
    """
    width, height = integer("width", width, 1, 65536), integer("height", height, 1, 65536)
    axes = upright_axes(up)
    points = outline(shapes)
    center = points.min(axis=0) / 2 + points.max(axis=0) / 2
    away = direction(CAMERA_ANGLES) @ axes
    distance = _distance(points - center, away, axes[1], width / height)
    return Camera(center + distance * away, center, axes[1], _FOV, width, height)


def outline(shapes: Any) -> NDArray[np.float64]:
    """Return points around shapes, (N, 3): of meshes their own, of others the corners of their boxes.

    Raises
    ------
    FileNotFoundError, ValueError, TypeError
        As `framed`.
    """
    points = np.concatenate([np.empty((0, 3)), *map(_points, meshes(shapes))])
    told = f" in {shapes}" if isinstance(shapes, str | PathLike) else ""
    if not len(points):
        raise ValueError(f"there are no faces to show{told}")
    farthest = float(np.abs(points).max())
    if farthest > _FARTHEST:
        raise ValueError(f"a coordinate{told} is {farthest:g}, and up to {_FARTHEST:g} is framed")
    return points


def upright_axes(up: str) -> NDArray[np.float64]:
    """Return rows, right, up, and towards the viewer, that are right-handed."""
    if up not in ("y", "z"):
        raise ValueError(f"up must be 'y' or 'z', got {up!r}")
    return np.array(
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]] if up == "y" else [[1, 0, 0], [0, 0, 1], [0, -1, 0]], float
    )


def direction(angles: tuple[float, float]) -> NDArray[np.float64]:
    """Return a unit direction, by its degrees around the upright axis and above the ground."""
    around, above = map(math.radians, angles)
    return np.array([math.cos(above) * math.sin(around), math.sin(above), math.cos(above) * math.cos(around)])


def _points(shape: AnyShape) -> NDArray[np.float64]:
    if isinstance(shape, Mesh):
        return shape.used_vertices()
    if isinstance(shape, Instance):
        return _copied(shape)
    low, high = shape.bounds
    if not np.isfinite([low, high]).all():
        raise ValueError(f"an unbounded {type(shape).__name__} cannot be framed")
    return _corners(low, high)


def _copied(instance: Instance) -> NDArray[np.float64]:
    """Return the corners of the boxes of an instance's shapes, at each of its copies."""
    held = [points for points in map(_points, instance.shapes) if len(points)]
    boxes = [_corners(points.min(axis=0), points.max(axis=0)) for points in held]
    corners = np.concatenate([np.empty((0, 3)), *boxes])
    ends = (instance.transform, instance.transform_end)
    matrices = np.concatenate([one.reshape(-1, 4, 4) for one in ends if one is not None])
    moved = corners @ matrices[:, :3, :3].transpose(0, 2, 1) + matrices[:, np.newaxis, :3, 3]
    return np.asarray(moved.reshape(-1, 3))


def _corners(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([np.where(upper, high, low) for upper in np.ndindex(2, 2, 2)])


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
