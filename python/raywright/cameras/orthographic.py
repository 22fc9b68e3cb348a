"""The camera of parallel rays."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import positive
from .any_camera import AnyCamera, picture_axis
from .pose import Pose


@dataclass(frozen=True, init=False, repr=False, kw_only=True)
class Orthographic(AnyCamera):
    """A camera with parallel rays: lengths are the same at every distance.

    Rays start in the plane through `position` across the view, so shapes behind it are not seen.

    Parameters
    ----------
    position, target, up, direction
        Position of the middle of the picture, and orientation, as in `Camera`.
    scale : float
        Length of the scene across the picture, in the scene's unit.
    width, height : int
        Size of the picture in pixels, 1 to 65536.
    scale_axis : str
        Axis along which `scale` is measured: ``"x"``, ``"y"``, the ``"smaller"`` or ``"larger"`` of these, or
        the ``"diagonal"``. (glTF has ymag, half of the scale along y.)
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
    Camera : A perspective camera.

    Examples
    --------
    >>> camera = rw.Orthographic((0, 0, 5), (0, 0, 0), scale=4, width=4, height=4)
    >>> origins, directions = camera.rays()
    >>> origins[0, :, 0].tolist(), directions[0, 0].tolist()
    ([-1.5, -0.5, 0.5, 1.5], [0.0, 0.0, -1.0])
    """

    scale: float
    scale_axis: str = "y"

    def __init__(
        self,
        position: ArrayLike,
        target: ArrayLike | None = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        scale: float = 1.0,
        width: int = 512,
        height: int = 512,
        *,
        direction: ArrayLike | None = None,
        scale_axis: str = "y",
        end_pose: Pose | None = None,
        shutter: ArrayLike = (0.0, 1.0),
    ) -> None:
        super().__init__(position, target, up, direction, width, height, end_pose, shutter)
        self._keep(scale=positive("scale", scale), scale_axis=picture_axis("scale_axis", scale_axis))
