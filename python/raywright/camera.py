"""Where a picture is taken from."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .arrays import Triple, integer, number, triple

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

    def rays(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the rays through the centres of all pixels.

        Returns
        -------
        origins, directions : (height, width, 3) float64
            Row 0 is the top of the picture, column 0 its left.
        """
        return _core.camera_rays(self)


def _unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    # Scaled by its greatest part first, so that squares neither overflow nor vanish.
    vector = vector / np.abs(vector).max()
    unit: NDArray[np.float64] = vector / np.linalg.norm(vector)
    return unit
