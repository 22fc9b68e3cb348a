"""Where a picture is taken from."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _core
from .arrays import Triple, integer, last_axis, number, triple

# Sine of the smallest angle between `up` and the view that still fixes which way is up.
_LEAST_SINE = 1e-9


@dataclass(frozen=True, init=False)
class Camera:
    """A perspective (pinhole) camera.

    Parameters
    ----------
    position : 3 floats
        Where the camera is, in the scene's unit of length.
    target : 3 floats
        The point that comes to the middle of the picture.
    up : 3 floats
        The direction that points up in the picture; need not be unit nor perpendicular to the view.
    fov : float
        Vertical angle of view in degrees, between 0 and 180.
    width, height : int
        Size of the picture in pixels, 1 to 65536.

    Raises
    ------
    ValueError
        If a number is out of range or not finite, if `position` equals `target`, or if `up` is zero or
        parallel to the view.
    TypeError
        If something is not a number.
    """

    position: Triple
    target: Triple
    up: Triple
    fov: float
    width: int
    height: int

    def __init__(
        self,
        position: ArrayLike,
        target: ArrayLike,
        up: ArrayLike = (0.0, 1.0, 0.0),
        fov: float = 40.0,
        width: int = 512,
        height: int = 512,
    ) -> None:
        values = {
            "position": triple("position", position),
            "target": triple("target", target),
            "up": triple("up", up),
            "fov": number("fov", fov),
            "width": integer("width", width, 1, 65536),
            "height": integer("height", height, 1, 65536),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        if not 0 < self.fov < 180:
            raise ValueError(f"fov must be between 0 and 180 degrees, got {fov}")
        if self.position == self.target:
            raise ValueError(f"position and target must differ, got {self.position} for both")
        if self.up == (0.0, 0.0, 0.0):
            raise ValueError("up must not be zero")
        view = _unit(np.array(self.target) / 2 - np.array(self.position) / 2)
        if np.linalg.norm(np.cross(view, _unit(np.array(self.up)))) < _LEAST_SINE:
            raise ValueError(f"up must not be parallel to the view, got up {self.up} along target - position")

    def rays(
        self, offsets: ArrayLike = (0.5, 0.5), dtype: DTypeLike = np.float64
    ) -> tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]]]:
        """Return a ray through each pixel.

        Parameters
        ----------
        offsets : (2,) or (height, width, 2) array
            Where in the pixel, for all or for each: (0, 0) is its upper left, (1, 1) its lower right. The
            default is the centre; ``rng.random((height, width, 2))`` is anywhere in it.
        dtype : float64 or float32
            Of the arrays; rays of float32 are the fastest to read.

        Returns
        -------
        origins, directions : (height, width, 3) arrays
            Directions are unit, to rounding. Row 0 is the top of the picture, column 0 its left.

        Raises
        ------
        ValueError
            If `offsets` has another shape, or `dtype` is another type.
        TypeError
            If `offsets` are not real numbers.
        """
        kind = np.dtype(dtype)
        if kind not in (np.float32, np.float64):
            raise ValueError(f"dtype must be float32 or float64, got {kind}")
        return _core.camera_rays(self, pixel_offsets(self, offsets), kind == np.float32)

    def rays_through(self, points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return a ray through each of any points of the picture.

        Parameters
        ----------
        points : (..., 2) array
            In pixels from the picture's left and from its top: the centre of the pixel in row i and column j
            is at (j + 0.5, i + 0.5). Points beside the picture have rays too.

        Returns
        -------
        origins, directions : (..., 3) float64 arrays
            Directions are unit, to rounding, and the same as those of `rays` through the same points.

        Raises
        ------
        ValueError
            If `points` has another shape, or is not finite.
        TypeError
            If `points` are not real numbers.
        """
        where = last_axis("points", points, 2).astype(np.float64)
        if not np.isfinite(where).all():
            raise ValueError("points must be finite")
        directions = _core.camera_directions(self, np.ascontiguousarray(where.reshape(-1, 2)))
        directions = directions.reshape(*where.shape[:-1], 3)
        return np.broadcast_to(self.position, directions.shape).copy(), directions


def pixel_offsets(camera: Camera, offsets: ArrayLike) -> NDArray[np.float64]:
    """Return offsets in the pixels of a camera, checked and as the core takes them."""
    where = last_axis("offsets", offsets, 2)
    if where.shape not in ((2,), (camera.height, camera.width, 2)):
        allowed = f"(2,) or ({camera.height}, {camera.width}, 2)"
        raise ValueError(f"offsets must have shape {allowed}, got {where.shape}")
    return np.ascontiguousarray(where, np.float64)


def _unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    # Scaled by its greatest part first, so that squares neither overflow nor vanish.
    vector = vector / np.abs(vector).max()
    unit: NDArray[np.float64] = vector / np.linalg.norm(vector)
    return unit
