"""Colors of EXR files: luminance and chroma, and primaries other than those of Rec. 709."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]

# x and y of red, green, blue and white (ITU-R BT.709).
REC_709 = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
# Tolerance, since files round chromaticities.
_ALIKE = 1e-3
# Half of the filter for the midpoint of 14 samples, of OpenEXR's ImfRgbaYca.cpp; its sum is 1 but for
# rounding.
_HALFWAY = np.array([0.002128, -0.007540, 0.019597, -0.043159, 0.087929, -0.186077, 0.627123])
_HALFWAY = np.concatenate([_HALFWAY, _HALFWAY[::-1]]) / (2 * _HALFWAY.sum())


def of_luminance(planes: Floats, chromaticities: Sequence[float] | None) -> Floats:
    """Return red, green and blue of (H, W, 3) luminance Y and chroma, (R - Y) / Y and (B - Y) / Y.

    Raises
    ------
    ValueError
        If the chromaticities are none of three colors and a white.
    """
    weights = _to_xyz(REC_709 if chromaticities is None else chromaticities)[1]
    luminance, of_red, of_blue = np.moveaxis(planes.astype(np.float64), -1, 0)
    red, blue = (of_red + 1) * luminance, (of_blue + 1) * luminance
    green = (luminance - weights[0] * red - weights[2] * blue) / weights[1]
    with np.errstate(over="ignore"):
        return np.stack([red, green, blue], axis=-1).astype(np.float32)


def to_rec_709(colors: Floats, chromaticities: Sequence[float] | None) -> Floats:
    """Return (H, W, 3) linear colors in Rec. 709: the same in CIE's X, Y and Z, whatever the white.

    Raises
    ------
    ValueError
        If the chromaticities are none of three colors and a white.
    """
    if chromaticities is None or np.allclose(chromaticities, REC_709, rtol=0, atol=_ALIKE):
        return colors
    matrix = np.linalg.solve(_to_xyz(REC_709), _to_xyz(chromaticities))
    with np.errstate(over="ignore", invalid="ignore"):
        return (colors.astype(np.float64) @ matrix.T).astype(np.float32)


def upsampled(plane: Floats, across: int, down: int) -> Floats:
    """Return all pixels of a channel that has those of every such column and row."""
    return _along(_along(plane, across, 1), down, 0)


def _along(plane: Floats, step: int, axis: int) -> Floats:
    if step == 1:
        return plane
    known = np.moveaxis(plane, axis, 0)
    count = len(known)
    result = np.empty((count * step, *known.shape[1:]), np.float32)
    result[::step] = known

    def later(shift: int) -> NDArray[np.float64]:
        return known[np.clip(np.arange(count) + shift, 0, count - 1)].astype(np.float64)

    for offset in range(1, step):
        if step == 2:
            between = sum((weight * later(k - 6) for k, weight in enumerate(_HALFWAY)), np.zeros(known.shape))
        else:
            between = later(0) + (later(1) - later(0)) * (offset / step)
        result[offset::step] = between
    return np.moveaxis(result, 0, axis)


def _to_xyz(chromaticities: Sequence[float]) -> NDArray[np.float64]:
    """Return the matrix from red, green and blue to X, Y and Z whose white has a Y of 1."""
    x, y = np.array(chromaticities, np.float64).reshape(4, 2).T
    columns = np.stack([x, y, 1 - x - y])
    try:
        white = columns[:, 3] / y[3] if y[3] else np.full(3, np.nan)
        matrix = columns[:, :3] * np.linalg.solve(columns[:, :3], white)
    except np.linalg.LinAlgError:
        matrix = np.full((3, 3), np.nan)
    if not np.isfinite(matrix).all() or not matrix[1, 1]:
        told = ", ".join(f"{value:g}" for value in chromaticities)
        raise ValueError(f"its chromaticities are not colors: {told}")
    return matrix
