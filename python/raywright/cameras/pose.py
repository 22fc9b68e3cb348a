"""Where a camera stands and how it is turned."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Triple, triple
from .matrices import Stand, of_extrinsics, of_world

# Sine of the smallest angle between `up` and the view direction that still fixes the roll.
_LEAST_SINE = 1e-8

P = TypeVar("P", bound="Pose")


@dataclass(frozen=True, init=False, repr=False)
class Pose:
    """A position with an orientation. Every camera is one; others give the end of a camera's motion.

    Parameters
    ----------
    position : 3 floats
        Position, in the scene's unit of length.
    target : 3 floats, optional
        The point that it looks at. Either this or `direction` is given.
    up : 3 floats
        The direction that points up in the picture; need not be unit nor perpendicular to the view.
    direction : 3 floats, optional
        The direction that it looks in, of any length.

    Raises
    ------
    ValueError
        If a number is not finite, there are both or neither of `target` and `direction`, `position` equals
        `target`, or `up` is zero or parallel to the view.
    TypeError
        If an argument is not a number.

    See Also
    --------
    Camera : Takes one as the end of a motion.

    Examples
    --------
    >>> pose = rw.Pose((0, 0, 5), target=(0, 0, 0))
    >>> pose.forward.tolist()
    [0.0, 0.0, -1.0]
    """

    position: Triple
    target: Triple | None
    up: Triple
    direction: Triple | None = None

    def __init__(
        self,
        position: ArrayLike,
        target: ArrayLike | None = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        direction: ArrayLike | None = None,
    ) -> None:
        self._keep(
            position=triple("position", position),
            target=None if target is None else triple("target", target),
            up=triple("up", up),
            direction=None if direction is None else triple("direction", direction),
        )
        if (self.target is None) == (self.direction is None):
            both = "both" if self.direction else "neither"
            raise ValueError(f"either target or direction must be given, got {both}")
        if self.position == self.target:
            raise ValueError(f"position and target must differ, got {self.position} for both")
        if self.direction == (0.0, 0.0, 0.0):
            raise ValueError("direction must not be zero")
        if self.up == (0.0, 0.0, 0.0):
            raise ValueError("up must not be zero")
        if np.linalg.norm(np.cross(self.forward, _unit(np.array(self.up)))) < _LEAST_SINE:
            along = "target - position" if self.target else "direction"
            raise ValueError(f"up must not be parallel to the view, got up {self.up} along {along}")

    def _keep(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @classmethod
    def from_matrix(cls: type[P], to_world: ArrayLike, convention: str = "gltf", **others: Any) -> P:
        """Return the pose, or the camera, with a given matrix.

        Parameters
        ----------
        to_world : (4, 4) array
            Matrix from the camera's own space to the scene's, acting on column vectors (x, y, z, 1). The
            lengths of its axes are ignored.
        convention : str
            Axes of the camera's own space: ``"gltf"``, it looks along -z with x to the right and y up (as in
            Blender and OpenGL); ``"mitsuba"``, along +z with x to the left and y up; ``"opencv"``, along +z
            with x to the right and y down.
        **others
            Other arguments of the class, without `position`, `target`, `up` and `direction`.

        Returns
        -------
        Pose or camera
            An instance of the class that it is called on.

        Raises
        ------
        ValueError
            If the matrix has another shape, is not finite, mirrors, or has axes that are not at right angles
            to within 1e-6.

        See Also
        --------
        Pose.from_extrinsics : From rotation and translation.

        Examples
        --------
        >>> matrix = np.eye(4)
        >>> matrix[:3, 3] = [0, 0, 5]
        >>> camera = rw.Camera.from_matrix(matrix, fov=60, width=8, height=6)
        >>> camera.forward.tolist(), bool((camera.matrix == matrix).all())
        ([-0.0, -0.0, -1.0], True)
        """
        stand = of_world(to_world, convention)
        if stand.mirrored:
            raise ValueError("to_world must not mirror: its axes are left-handed")
        return cls._at(stand, others)

    @classmethod
    def from_extrinsics(cls: type[P], R: ArrayLike, t: ArrayLike, **others: Any) -> P:
        """Return the pose, or the camera, with extrinsics R and t: it sees a point X at ``R @ X + t``.

        Parameters
        ----------
        R : (3, 3) array
            Rotation from the scene's axes to those of the camera: x to the right, y down, z forward.
        t : (3,) or (3, 1) array
            Translation from world to camera, in the scene's unit.
        **others
            Other arguments of the class, without `position`, `target`, `up` and `direction`.

        Returns
        -------
        Pose or camera
            An instance of the class that it is called on.

        Raises
        ------
        ValueError
            If a shape is another, a number is not finite, or `R` is not a rotation to within 1e-6. A small
            deviation is corrected from the third row, and then the second.

        See Also
        --------
        Camera.from_intrinsics : With a camera matrix.

        Examples
        --------
        >>> pose = rw.Pose.from_extrinsics(np.diag([1, -1, -1]), [0, 0, 5])
        >>> pose.forward.tolist(), pose.extrinsics[1].tolist()
        ([0.0, 0.0, -1.0], [-0.0, -0.0, 5.0])
        """
        return cls._at(of_extrinsics(R, t), others)

    @classmethod
    def _at(cls: type[P], stand: Stand, others: dict[str, Any]) -> P:
        made = {"position": stand.position, "direction": stand.forward, "up": stand.up}
        if taken := sorted({*made, "target"} & others.keys()):
            raise TypeError(f"{taken[0]} must not be given: the matrix defines it")
        return cls(**made, **others)

    @property
    def forward(self) -> NDArray[np.float64]:
        """The unit direction of the view, (3,)."""
        if self.target is None:
            return _unit(np.array(self.direction))
        # Halved, so that no difference overflows.
        return _unit(np.array(self.target) / 2 - np.array(self.position) / 2)

    @property
    def extrinsics(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """R (3, 3) and t (3,): a point X has the coordinates ``R @ X + t`` to the right, down and forward."""
        forward = self.forward
        right = _unit(np.cross(forward, _unit(np.array(self.up))))
        rotation = np.stack([right, np.cross(forward, right), forward])
        return rotation, -(rotation @ self.position)

    @property
    def matrix(self) -> NDArray[np.float64]:
        """The (4, 4) matrix from camera to world, along -z with y up: the inverse of `from_matrix`."""
        result = np.eye(4)
        result[:3, :3] = self.extrinsics[0].T * (1, -1, -1)
        result[:3, 3] = self.position
        return result

    def __repr__(self) -> str:
        # Only attributes that differ from their defaults.
        told = ((f.name, getattr(self, f.name), f.default) for f in fields(self))
        parts = (f"{name}={value!r}" for name, value, default in told if value != default)
        return f"{type(self).__name__}({', '.join(parts)})"


def _unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    # Scaled by its greatest component first, so that squares neither overflow nor underflow.
    vector = vector / np.abs(vector).max()
    unit: NDArray[np.float64] = vector / np.linalg.norm(vector)
    return unit
