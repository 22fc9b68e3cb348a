"""Transforms as scenes give them: steps of XML, nested lists, arrays, or objects with a ``matrix``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]


def of_elements(
    steps: list[tuple[str, dict[str, str]]], fail: Callable[[str], NoReturn]
) -> list[list[float]]:
    """Return the (4, 4) matrix of a ``<transform>``: each step is applied after the ones before it.

    Parameters
    ----------
    steps : list of (tag, attributes)
        Of ``<translate>``, ``<rotate>``, ``<scale>``, ``<lookat>`` and ``<matrix>``.
    fail : function
        Called with an error, and raises.
    """
    matrix = np.eye(4)
    for tag, attributes in steps:
        try:
            matrix = _step(tag, attributes) @ matrix
        except ValueError as error:
            told = str(error) if error.args and str(error).startswith("<") else f"<{tag}> must be numbers"
            fail(told)
    return matrix.tolist()


def _step(tag: str, attributes: dict[str, str]) -> Matrix:
    matrix = np.eye(4)
    if tag == "translate":
        matrix[:3, 3] = _vector(attributes, 0.0)
    elif tag == "scale":
        matrix[:3, :3] = np.diag(_vector(attributes, 1.0))
    elif tag == "rotate":
        axis = _vector(attributes, 0.0)
        if not axis.any() or "angle" not in attributes:
            raise ValueError("<rotate> must have an axis and an angle")
        matrix[:3, :3] = rotation(axis, float(attributes["angle"]))
    elif tag == "lookat":
        if not {"origin", "target"} <= attributes.keys():
            raise ValueError("<lookat> must have an origin and a target")
        origin, target = (_three(attributes[name]) for name in ("origin", "target"))
        return look_at(origin, target, _three(attributes.get("up", "0")))
    elif tag == "matrix":
        found = _numbers(attributes.get("value", ""))
        if len(found) not in (9, 16):
            raise ValueError(f"<matrix> must be 9 or 16 numbers, got {len(found)}")
        size = 3 if len(found) == 9 else 4
        matrix[:size, :size] = np.reshape(found, (size, size))
    else:
        raise ValueError(f"<{tag}> is not a step of a <transform>")
    return matrix


def rotation(axis: NDArray[np.float64], degrees: float) -> Matrix:
    """Return the (3, 3) matrix that turns about an axis, anticlockwise as seen from its tip (Rodrigues)."""
    x, y, z = axis / np.linalg.norm(axis)
    angle = np.radians(degrees)
    cross = np.array([(0, -z, y), (z, 0, -x), (-y, x, 0)])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross))


def look_at(origin: Matrix, target: Matrix, up: Matrix) -> Matrix:
    """Return the (4, 4) matrix of an object at `origin` that looks along its +z, with its +x to the left."""
    forward = target - origin
    if not forward.any():
        raise ValueError("<lookat> must have an origin and a target that differ")
    forward = forward / np.linalg.norm(forward)
    left = np.cross(frame(forward)[0] if not up.any() else up, forward)
    if not np.linalg.norm(left) > 1e-8 * np.linalg.norm(up):
        raise ValueError("<lookat> must have an up that is not parallel to the view")
    left = left / np.linalg.norm(left)
    matrix = np.eye(4)
    matrix[:3] = np.column_stack([left, np.cross(forward, left), forward, origin])
    return matrix


def frame(normal: Matrix) -> tuple[Matrix, Matrix]:
    """Return two unit vectors at right angles to a unit one and to each other (Duff et al., 2017)."""
    x, y, z = normal
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    return np.array([1 + sign * x * x * a, sign * b, -sign * x]), np.array([b, sign + y * y * a, -y])


def matrix_of(value: Any) -> Matrix:
    """Return the (4, 4) matrix of nested lists, of an array, or of an object that has a ``matrix``.

    Raises
    ------
    ValueError
        If it is no finite affine (4, 4) matrix.
    """
    return _square(value, 4)


def uv_matrix(value: Any) -> Matrix:
    """Return the (3, 3) matrix of a transform of texture coordinates, which may be given as (4, 4).

    Of the latter the third row and column count for nothing.
    """
    array = _array(value)
    return _square(array if array.shape != (4, 4) else np.delete(np.delete(array, 2, 0), 2, 1), 3)


def straightened(matrix: Matrix) -> Matrix:
    """Return a (4, 4) matrix with axes at right angles, where they nearly are: files keep few digits.

    Skews of more than 1e-3 stay. Lengths do not count, and handedness stays.
    """
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    if not lengths.all():
        return matrix
    left, stretch, right = np.linalg.svd(matrix[:3, :3] / lengths)
    result = matrix.copy()
    result[:3, :3] = left @ right if np.ptp(stretch) < 1e-3 else matrix[:3, :3] / lengths
    return result


def _array(value: Any) -> Matrix:
    given = getattr(value, "matrix", value)
    try:
        array = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"must be a matrix, got {type(value).__name__}") from None
    # Vectorized variants of Mitsuba give an array of one matrix.
    return array[..., 0] if array.ndim == 3 and array.shape[2] == 1 else array


def _square(value: Any, size: int) -> Matrix:
    array = _array(value)
    if array.shape != (size, size):
        raise ValueError(f"must be a matrix of shape ({size}, {size}), got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError("must be a finite matrix")
    if not (array[-1] == np.eye(size)[-1]).all():
        raise ValueError(f"must be affine, and its last row is {array[-1].tolist()}")
    return array


def _vector(attributes: dict[str, str], missing: float) -> NDArray[np.float64]:
    if "value" not in attributes:
        return np.array([float(attributes.get(axis, missing)) for axis in "xyz"])
    return _three(attributes["value"])


def _three(text: str) -> NDArray[np.float64]:
    found = _numbers(text)
    if len(found) == 1:
        found *= 3
    if len(found) != 3:
        raise ValueError
    return np.array(found)


def _numbers(text: str) -> list[float]:
    return [float(part) for part in text.replace(",", " ").split()]
