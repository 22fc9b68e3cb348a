"""Camera motion around a point."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..arrays import number, triple
from ..cameras import AnyCamera, Orthographic, Pose, ThinLens
from ..cameras.any_camera import resized as resized
from ..descriptions import changed
from .boxes import check_flat, spread

# Least angle in degrees to straight up or down, where the roll would be undefined.
_POLE = 1.0


@dataclass(frozen=True)
class View:
    """The motion of a camera from its start.

    Attributes
    ----------
    azimuth, elevation : float
        Degrees that it went around, to the right and upwards, always looking at the same point.
    zoom : float
        Factor by which it is nearer to that point.
    right, up : float
        Displacement of that point in the picture, in heights of the picture at the start.
    """

    azimuth: float = 0.0
    elevation: float = 0.0
    zoom: float = 1.0
    right: float = 0.0
    up: float = 0.0

    # Limits of each value.
    LIMITS: ClassVar[Mapping[str, tuple[float, float]]] = {
        "azimuth": (-1e6, 1e6),
        "elevation": (-180.0, 180.0),
        "zoom": (1 / 1024, 1024.0),
        "right": (-1e3, 1e3),
        "up": (-1e3, 1e3),
    }

    @classmethod
    def read(cls, told: Any) -> View:
        """Return the view of a mapping; missing entries are those of the start.

        Raises
        ------
        ValueError
            If it is not a mapping, or has another name in it, or a number is out of its range.
        TypeError
            If an argument is not a number.
        """
        if not isinstance(told, Mapping):
            raise ValueError(f"view must be an object, got {type(told).__name__}")
        if unknown := sorted(set(told) - set(cls.LIMITS)):
            raise ValueError(f"view has no {unknown[0][:40]!r}")
        values = {}
        for name, given in told.items():
            value, (least, most) = number(name, given), cls.LIMITS[name]
            if not least <= value <= most:
                raise ValueError(f"{name} must be between {least:g} and {most:g}, got {value:g}")
            values[name] = value
        return cls(**values)

    def told(self) -> dict[str, float]:
        """Return it for JSON, as `read` takes it."""
        return {name: getattr(self, name) for name in self.LIMITS}


class Orbit:
    """A camera that goes around the point that it looks at.

    Parameters
    ----------
    camera : Camera or another kind
        Camera at the start.
    bounds : (2, 3) array, optional
        The least and greatest corner of the scene: a camera without a target goes around the point of its
        view that is nearest to the middle.
    """

    def __init__(self, camera: AnyCamera, bounds: NDArray[np.float64] | None = None) -> None:
        self._camera = camera
        self._position = np.array(camera.position)
        forward = camera.forward
        self._distance = _distance(camera, bounds)
        self._pivot = self._position + self._distance * forward
        self._up = np.array(camera.up) / np.linalg.norm(camera.up)
        across = np.cross(forward, self._up)
        self._right = across / np.linalg.norm(across)
        self._picture_up = np.cross(self._right, forward)
        self._elevation = math.degrees(math.asin(np.clip(-forward @ self._up, -1.0, 1.0)))
        self._height = _height(camera, self._distance)

    @property
    def elevations(self) -> tuple[float, float]:
        """The least and the greatest elevation of a view; others are clamped to these."""
        most = max(90.0 - _POLE, abs(self._elevation))
        return -most - self._elevation, most - self._elevation

    def told(self) -> dict[str, Any]:
        """Return all that it takes to go around by oneself, for JSON: how rays spread at the start, and axes.

        Raises
        ------
        ValueError
            If edges are not straight in the camera's pictures.
        """
        check_flat(self._camera)
        origins, ways = spread(self._camera)
        parts = {
            "position": self._position,
            "pivot": self._pivot,
            "up": self._up,
            "right": self._right,
            "pictureUp": self._picture_up,
            "origins": origins,
            "ways": ways,
        }
        return {
            **{name: array.tolist() for name, array in parts.items()},
            "height": self._height,
            "elevations": self.elevations,
            "parallel": isinstance(self._camera, Orthographic),
        }

    def camera(self, view: View) -> AnyCamera:
        """Return the camera of a view: the one it started with, to the bit, if nothing was moved."""
        if view == View():
            return self._camera
        least, most = self.elevations
        raised = max(least, min(most, view.elevation))
        turn = _rotation(self._up, view.azimuth) @ _rotation(self._right, -raised)
        moved = -(view.right * self._right + view.up * self._picture_up) * self._height
        pivot = self._pivot + turn @ moved

        def pose(one: Pose) -> dict[str, Any]:
            away = turn @ (np.array(one.position) - self._pivot) / view.zoom
            return {
                "position": triple("position", pivot + away),
                "target": None,
                "direction": triple("direction", turn @ one.forward),
                "up": triple("up", turn @ np.array(one.up)),
            }

        changes = pose(self._camera)
        if self._camera.end_pose is not None:
            changes["end_pose"] = Pose(**pose(self._camera.end_pose))
        if isinstance(self._camera, Orthographic):
            changes["scale"] = self._camera.scale / view.zoom
        if isinstance(self._camera, ThinLens):
            # The orbit's target stays in focus if it was.
            sharp = self._camera.focused_distance
            own = self._camera.focus_distance is not None
            changes |= {"focus_point": None, "focus_distance": sharp if own else sharp / view.zoom}
        return changed(self._camera, **changes)


def scaled(size: tuple[int, int], factor: float) -> tuple[int, int]:
    """Return a size of so many times as many pixels in each direction, of one at least."""
    return max(round(size[0] * factor), 1), max(round(size[1] * factor), 1)


def _distance(camera: AnyCamera, bounds: NDArray[np.float64] | None) -> float:
    if camera.target is not None:
        return float(np.linalg.norm(np.subtract(camera.target, camera.position)))
    if bounds is None or not np.isfinite(bounds).all():
        return 1.0
    size = float(np.linalg.norm(bounds[1] - bounds[0]))
    along = float((bounds.mean(axis=0) - np.array(camera.position)) @ camera.forward)
    return max(along, 0.01 * size) or 1.0


def _height(camera: AnyCamera, distance: float) -> float:
    """Return the visible height of the plane through the center of the orbit."""
    middle = 0.5 * camera.width
    origins, directions = camera.rays_through([(middle, 0.0), (middle, camera.height)])
    forward = camera.forward
    with np.errstate(invalid="ignore", divide="ignore"):
        t = (distance - (origins - np.array(camera.position)) @ forward) / (directions @ forward)
        points = origins + t[:, np.newaxis] * directions
    height = float(np.linalg.norm(points[0] - points[1]))
    # Fisheyes and panoramas see beyond a plane.
    return height if math.isfinite(height) and (t > 0).all() else distance


def _rotation(axis: NDArray[np.float64], degrees: float) -> NDArray[np.float64]:
    """Return the (3, 3) rotation about a unit axis (Rodrigues 1840)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = math.radians(degrees)
    turned: NDArray[np.float64] = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return turned
