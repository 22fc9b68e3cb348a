"""Where a camera stands, as matrices give it: those of scene files, and of computer vision."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import choice, real_array

Matrix = NDArray[np.float64]

# By convention: signs of the camera's x, y and z axes for right, up and forward.
_AXES = {
    "gltf": (1, 1, -1),
    "mitsuba": (-1, 1, 1),
    "opencv": (1, -1, 1),
}

# Tolerance for a matrix to count as a rotation.
_SKEWED = 1e-6


class Stand(NamedTuple):
    """Where a camera stands, and where it looks.

    Attributes
    ----------
    position, forward, up : (3,) arrays
        The latter two unit.
    mirrored : bool
        True if the picture is mirrored.
    """

    position: Matrix
    forward: Matrix
    up: Matrix
    mirrored: bool


def of_world(to_world: ArrayLike, convention: str) -> Stand:
    """Decompose a matrix from camera to world, whose scale is ignored."""
    choice("convention", convention, tuple(_AXES))
    matrix = finite("to_world", to_world, (4, 4))
    if not (matrix[3] == (0, 0, 0, 1)).all():
        row = ", ".join(f"{x:g}" for x in matrix[3])
        raise ValueError(f"to_world must have (0, 0, 0, 1) as its last row, got ({row})")
    axes = matrix[:3, :3] * _AXES[convention]
    lengths = np.abs(axes).max(axis=0)
    if (lengths == 0).any():
        raise ValueError(f"to_world must have an inverse: its column {int(lengths.argmin())} is zero")
    axes = axes / lengths
    axes = axes / np.linalg.norm(axes, axis=0)
    off = float(np.abs(axes.T @ axes - np.eye(3)).max())
    if off > _SKEWED:
        raise ValueError(
            f"to_world must rotate, translate and scale only, but its axes are not orthogonal, by {off:.2g}"
        )
    right, up, forward = axes.T
    return Stand(matrix[:3, 3], forward, up, bool(np.cross(forward, up) @ right < 0))


def of_extrinsics(R: ArrayLike, t: ArrayLike) -> Stand:
    """Read a rotation and a translation from world to camera, with x to the right, y down and z forward."""
    rotation = finite("R", R, (3, 3))
    off = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
    if off > _SKEWED:
        raise ValueError(f"R must be a rotation, but R times its transpose deviates from 1 by {off:.2g}")
    if np.linalg.det(rotation) < 0:
        raise ValueError("R must be a rotation, got a reflection: its determinant is -1")
    shift = real_array("t", t)
    shift = finite("t", shift.reshape(3) if shift.shape == (3, 1) else shift, (3,))
    return Stand(-(rotation.T @ shift), rotation[2], -rotation[1], False)


def of_camera_matrix(K: ArrayLike) -> tuple[tuple[float, float], tuple[float, float], float]:
    """Read focal lengths, principal point and skew of a camera matrix."""
    matrix = finite("K", K, (3, 3))
    if matrix[1, 0] or matrix[2, 0] or matrix[2, 1]:
        raise ValueError(f"K must be upper triangular, got {matrix.tolist()}")
    for i in range(3):
        if not matrix[i, i]:
            raise ValueError(f"K must have an inverse: K[{i}, {i}] is 0")
    matrix = matrix / matrix[2, 2]
    (fx, skew, cx), (_, fy, cy), _ = matrix.tolist()
    return (fx, fy), (cx, cy), skew


def finite(name: str, value: ArrayLike, shape: tuple[int, ...]) -> Matrix:
    """Return a finite array of a shape."""
    array: NDArray[Any] = real_array(name, value)
    if array.shape != shape:
        raise ValueError(f"{name} must have shape {shape}, got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got NaN or infinity")
    return array.astype(np.float64, copy=False)
