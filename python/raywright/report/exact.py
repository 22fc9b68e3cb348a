"""Exact ray-triangle intersection: the reference of the routines.

Floats are integers times powers of two. With the powers multiplied out, all that is decided here is decided
in arrays of Python's integers: without any rounding, and without anything that the core computes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = list[NDArray[np.object_]]
"""The coordinates of N points: x, y and z, each (N,) integers."""


@dataclass(frozen=True)
class ExactHits:
    """Exact hits of N rays with their triangles.

    Attributes
    ----------
    hit : (N,) bool
        A triangle that has no area, or is seen edge-on, is not hit; one that is met on its border is.
    numerator, denominator : (N,) object
        Integers whose quotient is t where there is a hit; the denominator is above zero.
    """

    hit: NDArray[np.bool_]
    numerator: NDArray[np.object_]
    denominator: NDArray[np.object_]

    @property
    def t(self) -> NDArray[np.float64]:
        """Correctly rounded t: (N,) float64, inf for a miss."""
        t = np.full(len(self.hit), np.inf)
        # Python rounds a quotient of integers correctly.
        t[self.hit] = (self.numerator[self.hit] / self.denominator[self.hit]).astype(np.float64)
        return t

    def ulps(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return by how many units in the last place of a float32 each `t` is off.

        Parameters
        ----------
        t : (N,) float64
            Results of a routine; inf for a miss.

        Returns
        -------
        (M,) float64
            For those of the rays that are hit, and for which `t` is finite.
        """
        both = self.hit & np.isfinite(t)
        numerator, denominator = self.numerator[both], self.denominator[both]
        if not len(numerator):
            return np.empty(0)
        _, size = np.frexp(self.t[both])
        ulp = np.maximum(size - 1, -126) - 23
        found, exponent = _scaled(t[both])
        # |found · 2^exponent - numerator / denominator| / 2^ulp, with every power made one of an integer.
        low = np.minimum(exponent, 0)
        error = abs(_shifted(found * denominator, exponent - low) - _shifted(numerator, -low))
        over = low - ulp
        quotient = _shifted(error, np.maximum(over, 0)) / _shifted(denominator, np.maximum(-over, 0))
        return np.asarray(quotient, np.float64)


def exact_hits(
    origins: NDArray[np.floating[Any]],
    directions: NDArray[np.floating[Any]],
    corners: NDArray[np.floating[Any]],
) -> ExactHits:
    """Decide exactly whether each ray meets its triangle, and where.

    The line hits the triangle if it passes no edge on the side opposite to another's: by the signs of three
    volumes (Segura and Feito 2001).

    Parameters
    ----------
    origins, directions : (N, 3) float32 or float64
        Finite.
    corners : (N, 3, 3) float32 or float64
        Finite.
    """
    points, point_exponent = _integers(np.concatenate([corners.reshape(-1, 9), origins], axis=1))
    d, direction_exponent = _integers(directions)
    a, b, c = (_minus(points[i : i + 3], points[9:]) for i in (0, 3, 6))
    volumes = [_dot(d, _cross(b, c)), _dot(d, _cross(c, a)), _dot(d, _cross(a, b))]
    one_side = np.ones(len(origins), np.bool_)
    other_side = one_side.copy()
    for volume in volumes:
        one_side &= (volume >= 0).astype(np.bool_)
        other_side &= (volume <= 0).astype(np.bool_)
    denominator = volumes[0] + volumes[1] + volumes[2]
    numerator = _dot(a, _cross(_minus(b, a), _minus(c, a)))
    flipped = (denominator < 0).astype(np.bool_)
    numerator, denominator = np.where(flipped, -numerator, numerator), abs(denominator)
    seen = (denominator != 0).astype(np.bool_)
    ahead = (numerator >= 0).astype(np.bool_)
    scale = point_exponent - direction_exponent
    return ExactHits(
        seen & ahead & (one_side | other_side),
        _shifted(numerator, np.maximum(scale, 0)),
        _shifted(denominator, np.maximum(-scale, 0)),
    )


def _integers(values: NDArray[np.floating[Any]]) -> tuple[Vector, NDArray[np.int64]]:
    """Columns of integers, and for each row the power of two that they are multiples of."""
    mantissas, exponents = _scaled(values)
    low = np.where(values == 0, np.iinfo(np.int64).max, exponents).min(axis=1)
    low[(values == 0).all(axis=1)] = 0
    shifts = np.where(values == 0, 0, exponents - low[:, None])
    return list(_shifted(mantissas, shifts).T), low


def _scaled(values: NDArray[np.floating[Any]]) -> tuple[NDArray[np.object_], NDArray[np.int64]]:
    """Each value as an integer times a power of two."""
    mantissas, exponents = np.frexp(values.astype(np.float64))
    whole = np.ldexp(mantissas, 53).astype(np.int64)
    # Without trailing zeros: short integers are fast.
    zeros = np.where(whole == 0, 0, np.frexp((whole & -whole).astype(np.float64))[1] - 1)
    return (whole >> zeros).astype(object), exponents.astype(np.int64) - 53 + zeros


def _shifted(values: NDArray[np.object_], by: NDArray[np.integer[Any]]) -> NDArray[np.object_]:
    return np.asarray(values << by.astype(object))


def _minus(p: Vector, q: Vector) -> Vector:
    return [x - y for x, y in zip(p, q, strict=True)]


def _dot(p: Vector, q: Vector) -> NDArray[np.object_]:
    return np.asarray(p[0] * q[0] + p[1] * q[1] + p[2] * q[2])


def _cross(p: Vector, q: Vector) -> Vector:
    return [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
