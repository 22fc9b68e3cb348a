"""Rays through the pixels of a pinhole camera, as in Open3D."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...arrays import integer, number, real_array, triple
from .tensors import array_of


def pinhole_rays(*args: Any, **kwargs: Any) -> NDArray[np.float32]:
    """Return the rays of a camera given in one of Open3D's two forms."""
    is_view = len(args) + len(kwargs) == 6 or "fov_deg" in kwargs
    form: Callable[..., NDArray[np.float32]] = rays_of_view if is_view else rays_of_matrices
    names = (*inspect.signature(form).parameters, *args)
    plain = [array_of(name, value) for name, value in zip(names, args, strict=False)]
    return form(*plain, **{name: array_of(name, value) for name, value in kwargs.items()})


def rays_of_matrices(
    intrinsic_matrix: ArrayLike, extrinsic_matrix: ArrayLike, width_px: int, height_px: int
) -> NDArray[np.float32]:
    """Return the rays of a camera given by its matrices: (height_px, width_px, 6) float32."""
    inner = _square("intrinsic_matrix", intrinsic_matrix, 3)
    outer = _square("extrinsic_matrix", extrinsic_matrix, 4)
    width, height = integer("width_px", width_px, 1), integer("height_px", height_px, 1)
    try:
        inverse = np.linalg.inv(inner)
    except np.linalg.LinAlgError:
        raise ValueError("intrinsic_matrix must have an inverse") from None
    rotation, shift = outer[:3, :3], outer[:3, 3]
    pixels = np.ones((height, width, 3))
    pixels[..., 0] = np.arange(width) + 0.5
    pixels[..., 1] = np.arange(height)[:, np.newaxis] + 0.5
    rays = np.empty((height, width, 6), np.float32)
    rays[..., :3] = -rotation.T @ shift
    rays[..., 3:] = pixels @ (rotation.T @ inverse).T
    return rays


def rays_of_view(
    fov_deg: float, center: ArrayLike, eye: ArrayLike, up: ArrayLike, width_px: int, height_px: int
) -> NDArray[np.float32]:
    """Return the rays of a camera at `eye` that looks at `center`: (height_px, width_px, 6) float32."""
    angle = number("fov_deg", fov_deg)
    if not 0 < angle < 180:
        raise ValueError(f"fov_deg must be between 0 and 180, got {fov_deg}")
    width, height = integer("width_px", width_px, 1), integer("height_px", height_px, 1)
    at, start, upwards = (np.array(triple(*v)) for v in (("center", center), ("eye", eye), ("up", up)))
    focal_length = 0.5 * width / math.tan(math.radians(angle) / 2)
    inner = np.array([[focal_length, 0, 0.5 * width], [0, focal_length, 0.5 * height], [0, 0, 1]])
    forward = at - start
    right = np.cross(upwards, forward)
    if not right.any():
        raise ValueError(f"up must not be parallel to center - eye, got {up!r}")
    # Open3D has the second row along `up`, so that rows of pixels run upwards.
    rows = (right, np.cross(forward, right), forward)
    outer = np.eye(4)
    outer[:3, :3] = [row / np.linalg.norm(row) for row in rows]
    outer[:3, 3] = -outer[:3, :3] @ start
    return rays_of_matrices(inner, outer, width, height)


def _square(name: str, value: ArrayLike, size: int) -> NDArray[np.float64]:
    array = real_array(name, value).astype(np.float64, copy=False)
    if array.shape != (size, size):
        raise ValueError(f"{name} must have shape ({size}, {size}), got {array.shape}")
    return array
