"""The camera that sees wide angles in a circle."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import choice
from .any_camera import AnyCamera, picture_axis, view_angle
from .pose import Pose

# By mapping: the widest field of view in degrees, and whether that limit itself is allowed.
_WIDEST = {
    "equidistant": (360.0, True),
    "equisolid": (360.0, True),
    "stereographic": (360.0, False),
    "orthographic": (180.0, True),
}


@dataclass(frozen=True, init=False, repr=False, kw_only=True)
class Fisheye(AnyCamera):
    """A fisheye camera: a wide angle of view in a circle (Miyamoto 1964), and nothing outside of it.

    Parameters
    ----------
    position, target, up, direction
        Position and orientation, as in `Camera`.
    fov : float
        Angle of view in degrees, from one edge of the circle to the other: up to 360, below 360 if the
        mapping is stereographic, up to 180 if it is orthographic.
    width, height : int
        Size of the picture in pixels, 1 to 65536.
    mapping : str
        Distance from the center of the picture of a direction at an angle θ from the view: ``"equidistant"``,
        as θ; ``"equisolid"``, as sin(θ/2), so that equal solid angles have equal areas; ``"stereographic"``,
        as tan(θ/2), so that small circles stay circles; ``"orthographic"``, as sin θ.
    fov_axis : str
        Side of the picture that equals the diameter of the circle: the ``"smaller"`` (all of the circle is
        visible), ``"x"``, ``"y"``, the ``"larger"``, or the ``"diagonal"`` (the circle fills the picture).
    end_pose, shutter
        As in `Camera`.

    Raises
    ------
    ValueError
        If a number is out of range or not finite, or the mapping is none of these.
    TypeError
        If an argument is not a number.

    See Also
    --------
    Panorama : The whole sphere in a rectangle.

    Examples
    --------
    >>> camera = rw.Fisheye((0, 0, 0), direction=(0, 0, -1), fov=180, width=5, height=5)
    >>> directions = camera.rays()[1]
    >>> directions[2, 2].tolist(), bool(np.isnan(directions[0, 0]).all())
    ([0.0, 0.0, -1.0], True)
    """

    fov: float
    mapping: str = "equidistant"
    fov_axis: str = "smaller"

    def __init__(
        self,
        position: ArrayLike,
        target: ArrayLike | None = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        fov: float = 180.0,
        width: int = 512,
        height: int = 512,
        *,
        mapping: str = "equidistant",
        fov_axis: str = "smaller",
        direction: ArrayLike | None = None,
        end_pose: Pose | None = None,
        shutter: ArrayLike = (0.0, 1.0),
    ) -> None:
        super().__init__(position, target, up, direction, width, height, end_pose, shutter)
        choice("mapping", mapping, tuple(_WIDEST))
        most, closed = _WIDEST[mapping]
        self._keep(
            fov=view_angle("fov", fov, most, closed),
            mapping=mapping,
            fov_axis=picture_axis("fov_axis", fov_axis),
        )
