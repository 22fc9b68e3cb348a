"""Where textures lie: affine maps of texture coordinates, and of the space of a shape."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import number, real_array

Row3: TypeAlias = tuple[float, float, float]
Row4: TypeAlias = tuple[float, float, float, float]


@dataclass(frozen=True, init=False)
class UvTransform:
    """An affine map of texture coordinates: scale, then rotation, then translation.

    Parameters
    ----------
    scale : float or 2 floats
        Number of repetitions along u and v.
    rotation : float
        Rotation of coordinates in degrees, anticlockwise.
    offset : 2 floats
        Translation of coordinates.
    matrix : (2, 3) array, optional
        The whole map as a matrix that acts on column vectors (u, v, 1); the other arguments are then ignored.

    Attributes
    ----------
    matrix : tuple of 2 tuples of 3 floats
        The map.

    Raises
    ------
    ValueError
        If a number is not finite, or there are too few or too many of them.
    TypeError
        If an argument is not a number.

    See Also
    --------
    ObjectTransform : In the space of a shape.

    Examples
    --------
    >>> turned = rw.textures.UvTransform(scale=2, rotation=90)
    >>> np.round(turned.matrix, 6).tolist()
    [[0.0, -2.0, 0.0], [2.0, 0.0, 0.0]]
    """

    matrix: tuple[Row3, Row3]

    def __init__(
        self,
        scale: ArrayLike = 1.0,
        rotation: float = 0.0,
        offset: ArrayLike = (0.0, 0.0),
        *,
        matrix: ArrayLike | None = None,
    ) -> None:
        if matrix is not None:
            rows = _finite("matrix", matrix, (2, 3))
        else:
            across, up = np.broadcast_to(_finite("scale", scale, (), (2,)), 2)
            x, y = _finite("offset", offset, (2,))
            turn = math.radians(number("rotation", rotation))
            cos, sin = math.cos(turn), math.sin(turn)
            rows = np.array([(cos * across, -sin * up, x), (sin * across, cos * up, y)])
        first, second = rows.tolist()
        object.__setattr__(self, "matrix", (tuple(first), tuple(second)))


@dataclass(frozen=True, init=False)
class ObjectTransform:
    """An affine map from the space of a shape to that of a solid texture.

    The shape looks cut from a block of the texture. In an instance the space is that of the instance's
    shapes, so all copies look alike.

    Parameters
    ----------
    scale : float or 3 floats
        Units of the texture in one unit of the shape, along x, y and z.
    offset : 3 floats
        Translation of points, in units of the texture.
    matrix : (3, 4) or (4, 4) array, optional
        The whole map as a matrix that acts on column vectors (x, y, z, 1); the other arguments are then
        ignored.

    Attributes
    ----------
    matrix : tuple of 3 tuples of 4 floats
        The map.

    Raises
    ------
    ValueError
        If a number is not finite, there are too few or too many of them, or the last of four rows is not
        (0, 0, 0, 1).
    TypeError
        If an argument is not a number.

    See Also
    --------
    UvTransform : In texture coordinates.

    Examples
    --------
    >>> rw.textures.ObjectTransform(scale=2, offset=(1, 0, 0)).matrix
    ((2.0, 0.0, 0.0, 1.0), (0.0, 2.0, 0.0, 0.0), (0.0, 0.0, 2.0, 0.0))
    """

    matrix: tuple[Row4, Row4, Row4]

    def __init__(
        self,
        scale: ArrayLike = 1.0,
        offset: ArrayLike = (0.0, 0.0, 0.0),
        *,
        matrix: ArrayLike | None = None,
    ) -> None:
        if matrix is not None:
            rows = _finite("matrix", matrix, (3, 4), (4, 4))
            if len(rows) == 4 and rows[3].tolist() != [0, 0, 0, 1]:
                raise ValueError(f"matrix must have (0, 0, 0, 1) as its last row, got {rows[3].tolist()}")
        else:
            scales = np.broadcast_to(_finite("scale", scale, (), (3,)), 3)
            rows = np.column_stack([np.diag(scales), _finite("offset", offset, (3,))])
        first, second, third = rows[:3].tolist()
        object.__setattr__(self, "matrix", (tuple(first), tuple(second), tuple(third)))


Transform: TypeAlias = UvTransform | ObjectTransform


def placed(given: Transform | float | None, default: type[UvTransform] | type[ObjectTransform]) -> Transform:
    """Return a transform; a number is the scale of one of the default kind.

    Raises
    ------
    ValueError
        If a number is not finite.
    TypeError
        If it is something else.
    """
    if isinstance(given, UvTransform | ObjectTransform):
        return given
    if given is None:
        return default()
    if not isinstance(given, int | float | np.number):
        came = type(given).__name__
        raise TypeError(f"transform must be a UvTransform, an ObjectTransform or a number, got {came}")
    return default(number("transform", float(given)))


def _finite(name: str, value: ArrayLike, *shapes: tuple[int, ...]) -> NDArray[np.float64]:
    array = real_array(name, value).astype(np.float64)
    if array.shape not in shapes:
        raise ValueError(f"{name} must have shape {' or '.join(map(str, shapes))}, got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got {array.tolist()}")
    # -0.0 and 0.0 are the same map, and must compare equal.
    return array + 0.0
