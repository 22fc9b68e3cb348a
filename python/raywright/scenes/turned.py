"""The same scene, rotated: it shows the dependence of an accelerator on the axes."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import number, triple
from ..shapes.mesh import Mesh


def turned(shapes: Iterable[Mesh], angle: float, axis: ArrayLike = (0.0, 1.0, 0.0)) -> list[Mesh]:
    """Return meshes turned about an axis through the origin.

    Parameters
    ----------
    shapes : iterable of Mesh
        Meshes to turn.
    angle : float
        Angle in degrees, anticlockwise as seen from the tip of the axis.
    axis : 3 floats
        Need not be unit.

    Returns
    -------
    list of Mesh

    Raises
    ------
    ValueError
        If `angle` or `axis` are not finite, or `axis` is zero.
    TypeError
        If an argument is not a number.

    See Also
    --------
    Mesh.transformed : Any affine matrix.

    Examples
    --------
    >>> mesh = rw.Mesh([[1, 0, 0], [2, 0, 0], [1, 1, 0]], [[0, 1, 2]])
    >>> rw.scenes.turned([mesh], 90, axis=(0, 0, 1))[0].vertices.round(6).tolist()
    [[0.0, 1.0, 0.0], [0.0, 2.0, 0.0], [-1.0, 1.0, 0.0]]
    """
    matrix = np.eye(4)
    matrix[:3, :3] = rotation(angle, axis)
    return [shape.transformed(matrix) for shape in shapes]


def rotation(angle: float, axis: ArrayLike = (0.0, 1.0, 0.0)) -> NDArray[np.float64]:
    """Return the (3, 3) matrix that turns column vectors (Rodrigues' formula). Arguments as `turned`."""
    x = np.array(triple("axis", axis))
    largest = np.abs(x).max()
    if largest == 0:
        raise ValueError("axis must not be zero")
    x /= largest
    x /= np.linalg.norm(x)
    radians = math.radians(number("angle", angle))
    cross = np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])
    return np.asarray(np.eye(3) + math.sin(radians) * cross + (1 - math.cos(radians)) * (cross @ cross))
