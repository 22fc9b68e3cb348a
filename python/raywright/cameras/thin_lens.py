"""The camera with a lens, which is in focus at one distance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Triple, integer, number, positive, triple
from .any_camera import AnyCamera, Pair, pair, picture_axis, picture_length, view_angle
from .pose import Pose

_FOV = 40.0
_SENSOR = 0.024


@dataclass(frozen=True, init=False, repr=False, kw_only=True)
class ThinLens(AnyCamera):
    """A camera with a thin lens (Potmesil and Chakravarty 1981): sharp in one plane across its view.

    `aperture_radius` sets the blur, or `f_stop` as in photography. `focus_distance` or `focus_point` sets the
    plane in focus; otherwise the target is in focus. The angle of view is that of the lens focused at
    infinity, and does not depend on the focus.

    Parameters
    ----------
    position, target, up, direction
        Position of the middle of the lens, and orientation, as in `Camera`.
    fov : float, optional
        Angle of view in degrees, between 0 and 180; 40 if neither this nor `focal_length` is given.
    width, height : int
        Size of the picture in pixels, 1 to 65536.
    f_stop : float, optional
        Focal length over the diameter of the aperture. Either this or `aperture_radius` is given.
    aperture_radius : float, optional
        Radius of the aperture, in the scene's unit; 0 makes a pinhole.
    focus_distance : float, optional
        Distance from the lens to the plane in focus, along the view, in the scene's unit.
    focus_point : 3 floats, optional
        A point of the plane in focus, instead of its distance.
    focal_length : float, optional
        Focal length of the lens, in the scene's unit, instead of `fov`: with the sensor's height, it gives
        the vertical angle of view.
    sensor_height : float
        Height of the sensor behind the lens, in the scene's unit. The default is 24 mm in scenes in meters;
        only `f_stop` and `focal_length` need it.
    blades : int
        Number of sides of the aperture: a regular polygon with its corners at the aperture's radius, or a
        disk if 0.
    blade_rotation : float
        Rotation of the polygon, in degrees, counterclockwise as the camera looks; at 0 a corner is to the
        right.
    fov_axis : str
        Axis along which `fov` is measured, as in `Camera`.
    principal_point : 2 floats, optional
        Center of the view, in pixels from the left and the top of the picture; its middle if not given.
        Elsewhere the lens is shifted.
    end_pose, shutter
        As in `Camera`. The focus distance stays as it is when the shutter opens.

    Raises
    ------
    ValueError
        If a number is out of range or not finite, something is given twice or not at all, or the plane in
        focus is not in front of the camera.
    TypeError
        If an argument is not a number.

    See Also
    --------
    Camera : A pinhole: sharp at every distance.

    Examples
    --------
    >>> camera = rw.ThinLens((0, 0, 5), (0, 0, 0), aperture_radius=0.1, width=4, height=4)
    >>> camera.focused_distance
    5.0
    >>> origins, directions = camera.rays(lens=(1.0, 0.5))
    >>> at_focus = origins + directions * (5 / -directions[..., 2:])
    >>> sharp, _ = camera.rays(lens=(0.5, 0.5))
    >>> round(float(np.abs(origins - sharp).max()), 6)
    0.1
    """

    fov: float | None = None
    f_stop: float | None = None
    aperture_radius: float | None = None
    focus_distance: float | None = None
    focus_point: Triple | None = None
    focal_length: float | None = None
    sensor_height: float = _SENSOR
    blades: int = 0
    blade_rotation: float = 0.0
    fov_axis: str = "y"
    principal_point: Pair | None = None

    def __init__(
        self,
        position: ArrayLike,
        target: ArrayLike | None = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        fov: float | None = None,
        width: int = 512,
        height: int = 512,
        *,
        f_stop: float | None = None,
        aperture_radius: float | None = None,
        focus_distance: float | None = None,
        focus_point: ArrayLike | None = None,
        focal_length: float | None = None,
        sensor_height: float = _SENSOR,
        blades: int = 0,
        blade_rotation: float = 0.0,
        direction: ArrayLike | None = None,
        fov_axis: str = "y",
        principal_point: ArrayLike | None = None,
        end_pose: Pose | None = None,
        shutter: ArrayLike = (0.0, 1.0),
    ) -> None:
        super().__init__(position, target, up, direction, width, height, end_pose, shutter)
        if fov is not None and focal_length is not None:
            raise ValueError("either fov or focal_length must be given, got both")
        if (f_stop is None) == (aperture_radius is None):
            told = "neither" if f_stop is None else "both"
            raise ValueError(f"either f_stop or aperture_radius must be given, got {told}")
        if focus_distance is not None and focus_point is not None:
            raise ValueError("either focus_distance or focus_point must be given, got both")
        if focal_length is None:
            fov = view_angle("fov", _FOV if fov is None else fov)
        self._keep(
            fov=fov,
            f_stop=None if f_stop is None else positive("f_stop", f_stop),
            aperture_radius=None if aperture_radius is None else number("aperture_radius", aperture_radius),
            focus_distance=None if focus_distance is None else positive("focus_distance", focus_distance),
            focus_point=None if focus_point is None else triple("focus_point", focus_point),
            focal_length=None if focal_length is None else positive("focal_length", focal_length),
            sensor_height=positive("sensor_height", sensor_height),
            blades=integer("blades", blades, 0, 1024),
            blade_rotation=number("blade_rotation", blade_rotation),
            fov_axis=picture_axis("fov_axis", fov_axis),
            principal_point=None if principal_point is None else pair("principal_point", principal_point),
        )
        if self.aperture_radius is not None and self.aperture_radius < 0:
            raise ValueError(f"aperture_radius must be at least 0, got {aperture_radius}")
        if self.blades in (1, 2):
            raise ValueError(f"blades must be 0 or at least 3, got {blades}")
        if not self.focused_distance > 0:
            if self.focus_point is None:
                raise ValueError("focus_distance must be given if the camera has a direction and no target")
            raise ValueError(f"focus_point must be in front of the camera, got {self.focus_point}")

    @property
    def focused_distance(self) -> float:
        """Distance from the lens to the plane in focus, along the view, in the scene's unit."""
        if self.focus_distance is not None:
            return self.focus_distance
        sharp = self.target if self.focus_point is None else self.focus_point
        if sharp is None:
            return math.nan
        return float(np.subtract(sharp, self.position) @ self.forward)

    @property
    def lens_radius(self) -> float:
        """Radius of the aperture, in the scene's unit."""
        if self.aperture_radius is not None:
            return self.aperture_radius
        if self.focal_length is not None:
            focal = self.focal_length
        else:
            pixels = self.height / picture_length(self, self.fov_axis)
            focal = self.sensor_height / (2 * math.tan(math.radians(0.5 * (self.fov or _FOV))) * pixels)
        return focal / (2 * (self.f_stop or math.inf))

    @property
    def _view(self) -> tuple[float, str]:
        """The angle of view in degrees, and its axis."""
        if self.focal_length is None:
            return self.fov or _FOV, self.fov_axis
        return 2 * math.degrees(math.atan(0.5 * self.sensor_height / self.focal_length)), "y"
