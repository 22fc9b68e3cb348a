"""The pinhole camera, given by an angle or by a matrix."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import last_axis, number
from .any_camera import AnyCamera, Pair, pair, picture_axis, picture_length, view_angle
from .matrices import of_camera_matrix, of_extrinsics, of_world
from .pose import Pose

_FOV = 40.0


@dataclass(frozen=True, init=False, repr=False, kw_only=True)
class Camera(AnyCamera):
    """A perspective (pinhole) camera.

    Parameters
    ----------
    position : 3 floats
        Position of the camera, in the scene's unit of length.
    target : 3 floats, optional
        The point in the middle of the picture. Either this or `direction` is given.
    up : 3 floats
        The direction that points up in the picture; need not be unit nor perpendicular to the view.
    fov : float, optional
        Angle of view in degrees, between 0 and 180; 40 if neither this nor `focal_length_px` is given.
    width, height : int
        Size of the picture in pixels, 1 to 65536.
    direction : 3 floats, optional
        The direction that the camera looks in, instead of a target.
    fov_axis : str
        Axis along which `fov` is measured: ``"x"``, ``"y"``, the ``"smaller"`` or ``"larger"`` of these, or
        the ``"diagonal"``.
    focal_length_px : 2 floats, optional
        Instead of `fov`, focal lengths in pixels, across and down; negative ones mirror the picture.
    principal_point : 2 floats, optional
        The point of the picture that the view goes through, in pixels from its left and its top as in
        `rays_through`; the middle if not given. Any other point is a shifted lens, or a crop of a picture.
    skew : float
        Skew coefficient K[0, 1] of a camera matrix, in pixels. With `focal_length_px` only.
    end_pose : Pose, optional
        Pose as the shutter closes; a camera is accepted too.
    shutter : 2 floats
        Opening and closing time of the shutter; instances move from time 0 to 1.

    Raises
    ------
    ValueError
        If a number is out of range or not finite, if `position` equals `target`, or if `up` is zero or
        parallel to the view.
    TypeError
        If an argument is not a number.

    See Also
    --------
    ThinLens : A camera with depth of field.
    Orthographic, Fisheye, Panorama

    Examples
    --------
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=90, width=4, height=4)
    >>> camera.forward.tolist()
    [0.0, 0.0, -1.0]
    >>> camera.project([[0, 0, 0], [2.5, 0, 0]]).round(6).tolist()
    [[2.0, 2.0], [3.0, 2.0]]
    """

    fov: float | None = None
    fov_axis: str = "y"
    focal_length_px: Pair | None = None
    principal_point: Pair | None = None
    skew: float = 0.0

    def __init__(
        self,
        position: ArrayLike,
        target: ArrayLike | None = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        fov: float | None = None,
        width: int = 512,
        height: int = 512,
        *,
        direction: ArrayLike | None = None,
        fov_axis: str = "y",
        focal_length_px: ArrayLike | None = None,
        principal_point: ArrayLike | None = None,
        skew: float = 0.0,
        end_pose: Pose | None = None,
        shutter: ArrayLike = (0.0, 1.0),
    ) -> None:
        super().__init__(position, target, up, direction, width, height, end_pose, shutter)
        if fov is not None and focal_length_px is not None:
            raise ValueError("either fov or focal_length_px must be given, got both")
        if focal_length_px is None:
            fov = view_angle("fov", _FOV if fov is None else fov)
        lengths = None if focal_length_px is None else pair("focal_length_px", focal_length_px)
        if lengths is not None and 0 in lengths:
            raise ValueError(f"focal_length_px must not be zero, got {lengths}")
        self._keep(
            fov=fov,
            fov_axis=picture_axis("fov_axis", fov_axis),
            focal_length_px=lengths,
            principal_point=None if principal_point is None else pair("principal_point", principal_point),
            skew=number("skew", skew),
        )
        if self.skew and focal_length_px is None:
            raise ValueError("skew must be given with focal_length_px, got it with fov")

    @classmethod
    def from_intrinsics(
        cls,
        K: ArrayLike,
        R: ArrayLike,
        t: ArrayLike,
        width: int,
        height: int,
        *,
        pixel_center: float = 0.0,
        end_pose: Pose | None = None,
        shutter: ArrayLike = (0.0, 1.0),
    ) -> Camera:
        """Return a camera from K, R and t: a point X projects to the pixel ``K @ (R @ X + t)``.

        Parameters
        ----------
        K : (3, 3) array
            ``[[fx, skew, cx], [0, fy, cy], [0, 0, 1]]``, in pixels.
        R, t : (3, 3) and (3,) or (3, 1) arrays
            Rotation and translation from world to camera, whose x is to the right, y down and z forward.
        width, height : int
            Size of the picture in pixels.
        pixel_center : float
            Coordinates of the first pixel's center, across and down: 0 as in OpenCV, so that the center of
            the pixel in row i and column j is at (j, i); 0.5 to count from the picture's corner, as in
            COLMAP.
        end_pose, shutter
            As for any camera; ``Pose.from_extrinsics(R, t)`` makes an end pose.

        Returns
        -------
        Camera

        Raises
        ------
        ValueError
            If a shape is another, a number is not finite, K is not upper triangular or has no inverse, or R
            is not a rotation to within 1e-6.

        See Also
        --------
        Pose.from_extrinsics : Any camera, without a camera matrix.

        Examples
        --------
        >>> K = [[100, 0, 31.5], [0, 100, 23.5], [0, 0, 1]]
        >>> camera = rw.Camera.from_intrinsics(K, np.eye(3), [0, 0, 5], width=64, height=48)
        >>> camera.intrinsics.tolist() == K
        True
        >>> camera.project([0, 0, 0]).tolist()
        [32.0, 24.0]
        """
        focal_length_px, (x, y), skew = of_camera_matrix(K)
        shift = 0.5 - number("pixel_center", pixel_center)
        lens = {"focal_length_px": focal_length_px, "principal_point": (x + shift, y + shift), "skew": skew}
        others = {"width": width, "height": height, "end_pose": end_pose, "shutter": shutter}
        return cls._at(of_extrinsics(R, t), {**lens, **others})

    @classmethod
    def from_matrix(cls, to_world: ArrayLike, convention: str = "gltf", **others: Any) -> Camera:
        """Return the camera with a given matrix, as in `Pose.from_matrix`.

        A mirroring matrix is allowed; it mirrors the picture.

        Parameters
        ----------
        to_world, convention, **others
            As for `Pose.from_matrix`.

        Returns
        -------
        Camera

        Raises
        ------
        ValueError
            If the matrix has another shape, is not finite, or has axes that are not at right angles to within
            1e-6.

        See Also
        --------
        Camera.from_intrinsics : With a camera matrix.

        Examples
        --------
        >>> camera = rw.Camera.from_matrix(np.diag([-1, 1, 1, 1]), fov=90, width=4, height=4)
        >>> camera.project([1, 0, -2]).round(6).tolist()
        [1.0, 2.0]
        """
        stand = of_world(to_world, convention)
        camera = cls._at(stand, others)
        if not stand.mirrored:
            return camera
        (across, _, x), (_, down, y), _ = camera.intrinsics.tolist()
        focal_length_px, principal_point = (-across, down), (x + 0.5, y + 0.5)
        return replace(
            camera, fov=None, fov_axis="y", focal_length_px=focal_length_px, principal_point=principal_point
        )

    @property
    def intrinsics(self) -> NDArray[np.float64]:
        """The camera matrix K, (3, 3), with the centers of pixels at integers, as in OpenCV.

        To count from the picture's corner, add 0.5 to its K[0, 2] and K[1, 2].
        """
        if self.focal_length_px is None:
            tangent = math.tan(math.radians(0.5 * (self.fov or _FOV)))
            across = down = 0.5 * picture_length(self, self.fov_axis) / tangent
        else:
            across, down = self.focal_length_px
        x, y = self.principal_point or (0.5 * self.width, 0.5 * self.height)
        return np.array([(across, self.skew, x - 0.5), (0, down, y - 0.5), (0, 0, 1)])

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """Project points into the picture, without a test for occlusion.

        Parameters
        ----------
        points : (..., 3) array
            In the scene.

        Returns
        -------
        (..., 2) float64 array
            Pixel coordinates from the left and from the top of the picture, as in `rays_through`: the pixel
            in row i and column j is from (j, i) to (j + 1, i + 1). Points outside of the picture have
            coordinates beyond its edges; points behind the camera, or in the plane through it, have NaN. A
            moving camera is taken as the shutter opens.

        Raises
        ------
        ValueError
            If the last dimension is not 3.
        TypeError
            If the array does not hold real numbers.

        See Also
        --------
        Camera.rays_through : The inverse: rays through points of the picture.

        Examples
        --------
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=90, width=10, height=10)
        >>> camera.project([[0, 0, 0], [0, 2.5, 0], [0, 0, 9]]).round(6).tolist()
        [[5.0, 5.0], [5.0, 2.5], [nan, nan]]
        """
        (across, skew, x), (_, down, y), _ = self.intrinsics
        # Relative to the camera, so that large map coordinates lose no digits.
        seen = (last_axis("points", points, 3).astype(np.float64) - self.position) @ self.extrinsics[0].T
        ahead = np.where(seen[..., 2] > 0, seen[..., 2], np.nan)
        u, v = seen[..., 0] / ahead, seen[..., 1] / ahead
        return np.stack([across * u + skew * v + x + 0.5, down * v + y + 0.5], axis=-1)
