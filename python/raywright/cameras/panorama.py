"""The camera that sees all around."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from .any_camera import AnyCamera
from .pose import Pose


@dataclass(frozen=True, init=False, repr=False, kw_only=True)
class Panorama(AnyCamera):
    """A camera that sees the whole sphere, in an equirectangular picture.

    Columns are longitudes, rows latitudes. The camera looks at the middle of the picture; the top row is up,
    and the left and right edges are behind. A quarter of the width to the right of the middle is to the
    right.

    Parameters
    ----------
    position, target, up, direction
        Position and orientation, as in `Camera`. With neither target nor direction it looks along -z.
    width, height : int
        Size of the picture in pixels, 1 to 65536.
    end_pose, shutter
        As in `Camera`.

    Raises
    ------
    ValueError
        If a number is out of range or not finite.
    TypeError
        If an argument is not a number.

    See Also
    --------
    Fisheye : A circle of up to 360°.

    Notes
    -----
    The camera that looks along -z with +y up sees, at the fractions (u, v) of the picture's width from its
    left and of its height from its top, the direction (sin φ sin θ, cos θ, -cos φ sin θ) with φ = 2π (u - ½)
    and θ = π v.

    Examples
    --------
    >>> camera = rw.Panorama((0, 0, 0), width=8, height=4)
    >>> _, directions = camera.rays_through([[4, 2], [6, 2], [4, 0]])
    >>> directions.round(6).tolist()
    [[0.0, 0.0, -1.0], [1.0, 0.0, -0.0], [0.0, 1.0, -0.0]]
    """

    def __init__(
        self,
        position: ArrayLike,
        target: ArrayLike | None = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        width: int = 1024,
        height: int = 512,
        *,
        direction: ArrayLike | None = None,
        end_pose: Pose | None = None,
        shutter: ArrayLike = (0.0, 1.0),
    ) -> None:
        if target is None and direction is None:
            direction = (0.0, 0.0, -1.0)
        super().__init__(position, target, up, direction, width, height, end_pose, shutter)
