"""Cameras as `paths.wgsl` knows them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..cameras import AnyCamera, Camera
from ..query.gpu_arrays import GpuArrays
from .material_table import LeftError, told

# In box units: farther away, float32 cannot resolve a pixel of a large picture.
_FAR = 256.0


@dataclass(frozen=True, eq=False)
class Eye:
    """A pinhole camera in box units: where it is, and the ways to the corners of its film.

    Attributes
    ----------
    eye, corner, across, down : (3,) float64
        The point x, y of a film from 0 to 1, from its left and its top, is seen along
        ``corner + across * x + down * y``.
    width, height : int
        Of its picture in pixels.
    """

    eye: NDArray[np.float64]
    corner: NDArray[np.float64]
    across: NDArray[np.float64]
    down: NDArray[np.float64]
    width: int
    height: int


def eye_of(camera: AnyCamera, flat: GpuArrays) -> Eye:
    """Return a camera as it stands in a scene's box units.

    Raises
    ------
    LeftError
        If it is none that the kernels know, or too far away for them.
    """
    if not isinstance(camera, Camera):
        raise LeftError(f"the camera is a {told(camera)}")
    if camera.end_pose is not None:
        raise LeftError("the camera moves")
    width, height = camera.width, camera.height
    origins, ways = camera.rays_through([(0, 0), (width, 0), (0, height), (width, height)])
    eye = (origins[0] - flat.center) * flat.scale
    if not np.abs(eye).max() < _FAR:
        raise LeftError("the camera is far from all that it sees")
    # Directions to the corners have unit length. Before normalization they formed a parallelogram: opposite
    # corners had equal sums.
    sizes = np.linalg.svd(np.stack([ways[0], -ways[1], -ways[2], ways[3]], axis=1))[2][-1]
    corner, right, low = (ways[i] * (sizes[i] / sizes[0]) for i in range(3))
    return Eye(eye, corner, right - corner, low - corner, width, height)
