"""The base class of all cameras: a picture, a shutter, and rays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .. import _core
from ..arrays import choice, integer, last_axis, number, real_array
from ..descriptions import changed
from .pose import Pose

Pair = tuple[float, float]

FOV_AXES = ("x", "y", "smaller", "larger", "diagonal")
_CENTER = (0.5, 0.5)


@dataclass(frozen=True, init=False, repr=False, kw_only=True)
class AnyCamera(Pose):
    """The base class of all cameras.

    Make one of its subclasses: `Camera`, `ThinLens`, `Orthographic`, `Fisheye`, `Panorama`.

    All take the arguments of `Pose`, and these.

    Parameters
    ----------
    width, height : int
        Size of the picture in pixels, 1 to 65536.
    end_pose : Pose, optional
        Pose as the shutter closes; a camera is accepted too. In between, the position moves on a straight
        line and the orientation rotates about one axis, both uniformly (slerp; Shoemake 1985).
    shutter : 2 floats
        Opening and closing time of the shutter; instances move from time 0 to 1.

    Raises
    ------
    ValueError
        If a number is out of range or not finite, or the shutter closes before it opens.
    TypeError
        If an argument is not a number, or `end_pose` is not a Pose.

    See Also
    --------
    Pose : A position with an orientation.

    Examples
    --------
    >>> isinstance(rw.Camera((0, 0, 5), (0, 0, 0)), rw.cameras.AnyCamera)
    True
    """

    width: int
    height: int
    end_pose: Pose | None = None
    shutter: tuple[float, float] = (0.0, 1.0)

    def __init__(
        self,
        position: ArrayLike,
        target: ArrayLike | None,
        up: ArrayLike,
        direction: ArrayLike | None,
        width: int,
        height: int,
        end_pose: Pose | None,
        shutter: ArrayLike,
    ) -> None:
        super().__init__(position, target, up, direction)
        if end_pose is not None and not isinstance(end_pose, Pose):
            raise TypeError(f"end_pose must be a raywright.Pose, got {type(end_pose).__name__}")
        if isinstance(end_pose, AnyCamera):
            end_pose = Pose(end_pose.position, end_pose.target, end_pose.up, end_pose.direction)
        self._keep(
            width=integer("width", width, 1, 65536),
            height=integer("height", height, 1, 65536),
            end_pose=end_pose,
            shutter=_shutter(shutter),
        )

    def rays(
        self,
        offsets: ArrayLike = _CENTER,
        dtype: DTypeLike = np.float64,
        lens: ArrayLike | None = None,
        time: ArrayLike | None = None,
    ) -> tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]]]:
        """Return a ray through each pixel.

        Parameters
        ----------
        offsets : (2,) or (height, width, 2) array
            Position within the pixel, for all pixels or for each: (0, 0) is its upper left, (1, 1) its lower
            right. The default is the center; ``rng.random((height, width, 2))`` is random.
        dtype : float64 or float32
            Type of the arrays; rays of float32 are the fastest to read.
        lens : (2,) or (height, width, 2) array, optional
            Position on the lens, two numbers from 0 to 1, for all pixels or for each: uniform numbers give
            points uniform over its area. Its center if not given; ignored by cameras without a lens.
        time : float or (height, width) array, optional
            Time from 0, the default, as the shutter opens to 1 as it closes, for all or for each. For queries
            of a scene in motion, pass ``time=camera.scene_time(time)``.

        Returns
        -------
        origins, directions : (height, width, 3) arrays
            Directions are unit, to rounding. Row 0 is the top of the picture, column 0 its left. Directions
            outside of the view, such as beyond the circle of a fisheye, are NaN, and hit nothing.

        Raises
        ------
        ValueError
            If an array has another shape, `lens` or `time` is out of range, or `dtype` is another type.
        TypeError
            If `offsets`, `lens` or `time` are not real numbers.

        See Also
        --------
        Camera.rays_through : Rays through any points.
        Scene.first_hits : Hits of all pixels at once.

        Examples
        --------
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=3, height=3)
        >>> origins, directions = camera.rays()
        >>> origins.shape, directions[1, 1].tolist()
        ((3, 3, 3), [0.0, 0.0, -1.0])
        >>> scene = rw.Scene(rw.Sphere())
        >>> scene.intersect(origins, directions).hit.astype(int).tolist()
        [[0, 0, 0], [0, 1, 0], [0, 0, 0]]
        """
        kind = np.dtype(dtype)
        if kind not in (np.float32, np.float64):
            raise ValueError(f"dtype must be float32 or float64, got {kind}")
        places = (
            _CENTER
            if lens is None
            else _for_pixels(self, "lens", _in_unit("lens", last_axis("lens", lens, 2)))
        )
        times = _times(time)
        if times.shape not in ((), (self.height, self.width)):
            raise ValueError(f"time must have shape () or ({self.height}, {self.width}), got {times.shape}")
        where = pixel_offsets(self, offsets)
        return _core.camera_rays(self, where, kind == np.float32, _ordered(places), _ordered(times))

    def rays_through(
        self, points: ArrayLike, lens: ArrayLike | None = None, time: ArrayLike | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return a ray through each of the given points of the picture.

        Parameters
        ----------
        points : (..., 2) array
            Points in pixels from the picture's left and from its top: the center of the pixel in row i and
            column j is at (j + 0.5, i + 0.5). Points outside of the picture have rays too.
        lens : (..., 2) array, optional
            Position on the lens, as in `rays`; leading shapes broadcast.
        time : float or (...) array, optional
            Time, as in `rays`; shapes broadcast.

        Returns
        -------
        origins, directions : (..., 3) float64 arrays
            Directions are unit, to rounding, and the same as those of `rays` through the same points; NaN
            where the camera sees nothing.

        Raises
        ------
        ValueError
            If an array has another shape, `points` are not finite, or `lens` or `time` is out of range.
        TypeError
            If `points`, `lens` or `time` are not real numbers.

        See Also
        --------
        Camera.project : The inverse: points of the scene to the picture.
        Camera.rays : Rays through all pixels.

        Examples
        --------
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=90, width=4, height=4)
        >>> origins, directions = camera.rays_through([[2, 2], [4, 2]])
        >>> directions.round(4).tolist()
        [[0.0, 0.0, -1.0], [0.7071, 0.0, -0.7071]]
        """
        where = last_axis("points", points, 2)
        if not np.isfinite(where).all():
            raise ValueError("points must be finite")
        places = np.array(_CENTER) if lens is None else _in_unit("lens", last_axis("lens", lens, 2))
        times = _times(time)
        parts = {"points": where.shape[:-1], "lens": places.shape[:-1], "time": times.shape}
        try:
            lead = np.broadcast_shapes(*parts.values())
        except ValueError:
            told = ", ".join(f"{name} {shape}" for name, shape in parts.items())
            raise ValueError(f"leading shapes do not broadcast: {told}") from None
        where = _ordered(np.broadcast_to(where, (*lead, 2)).reshape(-1, 2))
        places = places if places.ndim == 1 else np.broadcast_to(places, (*lead, 2)).reshape(-1, 2)
        times = times if times.ndim == 0 else np.broadcast_to(times, lead).reshape(-1)
        found = _core.camera_rays_through(self, where, _ordered(places), _ordered(times))
        origins, directions = (rays.reshape(*lead, 3) for rays in found)
        return origins, directions

    def scene_time(self, time: ArrayLike | None = None) -> NDArray[np.float64]:
        """Return the scene's time for times from 0, as the shutter opens, to 1, as it closes.

        Parameters
        ----------
        time : float or (...) array, optional
            Times from 0, the default, as the shutter opens to 1 as it closes.

        Returns
        -------
        (...) float64 array
            Times for queries of a scene.

        Raises
        ------
        ValueError
            If a time is not between 0 and 1.
        TypeError
            If the times are not real numbers.

        See Also
        --------
        Camera.rays : Rays at times of the shutter.

        Examples
        --------
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), shutter=(0.25, 0.75))
        >>> camera.scene_time([0.0, 0.5, 1.0]).tolist()
        [0.25, 0.5, 0.75]
        """
        opens, closes = self.shutter
        return np.asarray(opens + (closes - opens) * _times(time))


def pixel_offsets(camera: AnyCamera, offsets: ArrayLike) -> NDArray[np.float64]:
    """Return offsets in the pixels of a camera, checked and as the core takes them."""
    return _ordered(_for_pixels(camera, "offsets", last_axis("offsets", offsets, 2)))


def view_angle(name: str, value: float, most: float = 180.0, closed: bool = False) -> float:
    """Return an angle of view in degrees, between 0 and the most, which is allowed if it is `closed`."""
    angle = number(name, value)
    if not (0 < angle < most or (closed and angle == most)):
        raise ValueError(f"{name} must be between 0 and {most:g} degrees, got {value}")
    return angle


def picture_axis(name: str, value: str) -> str:
    """Return which length of a picture something is measured along."""
    choice(name, value, FOV_AXES)
    return value


def picture_length(camera: AnyCamera, axis: str) -> float:
    """Return a length of a camera's picture in pixels."""
    width, height = camera.width, camera.height
    lengths = {"x": width, "y": height, "smaller": min(width, height), "larger": max(width, height)}
    return float(lengths[axis]) if axis in lengths else float(np.hypot(width, height))


def _shutter(value: ArrayLike) -> tuple[float, float]:
    array = real_array("shutter", value)
    if array.shape != (2,):
        raise ValueError(f"shutter must be 2 numbers, got shape {array.shape}")
    opens, closes = (float(x) for x in array)
    if not 0 <= opens <= closes <= 1:
        raise ValueError(f"shutter must open and then close within 0 to 1, got ({opens:g}, {closes:g})")
    return opens, closes


def _for_pixels(camera: AnyCamera, name: str, where: NDArray[Any]) -> NDArray[Any]:
    if where.shape not in ((2,), (camera.height, camera.width, 2)):
        allowed = f"(2,) or ({camera.height}, {camera.width}, 2)"
        raise ValueError(f"{name} must have shape {allowed}, got {where.shape}")
    return where


def _in_unit(name: str, array: NDArray[Any]) -> NDArray[Any]:
    within = (array >= 0) & (array <= 1)
    if not within.all():
        raise ValueError(f"{name} must be between 0 and 1, got {array[~within].flat[0]:g}")
    return array


def _times(time: ArrayLike | None) -> NDArray[Any]:
    return _in_unit("time", real_array("time", 0.0 if time is None else time))


def _ordered(array: ArrayLike) -> NDArray[np.float64]:
    return np.asarray(array, np.float64, order="C")


def pair(name: str, value: ArrayLike) -> Pair:
    """Return two finite numbers."""
    array = real_array(name, value)
    if array.shape != (2,):
        raise ValueError(f"{name} must be 2 numbers, got shape {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got {tuple(array.tolist())}")
    x, y = (float(v) for v in array)
    return x, y


def resized(camera: AnyCamera, width: int, height: int) -> AnyCamera:
    """Return the camera with a picture of the same view that has so many pixels."""
    across, down = width / camera.width, height / camera.height
    changes: dict[str, Any] = {
        "width": integer("width", width, 1, 65536),
        "height": integer("height", height, 1, 65536),
    }
    # Lengths in pixels grow with their number.
    for name in ("focal_length_px", "principal_point"):
        if (lengths := getattr(camera, name, None)) is not None:
            changes[name] = (lengths[0] * across, lengths[1] * down)
    if hasattr(camera, "skew"):
        changes["skew"] = camera.skew * across
    return changed(camera, **changes)
