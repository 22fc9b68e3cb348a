"""Interpolation from patches to their corners, for smooth display."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Faces that meet at a sharper edge than this, in degrees, are not smoothed: a corner of a room stays a
# corner, a vault is smooth.
_CREASE = 30.0


def at_corners(
    values: Floats, corners: Floats, areas: Floats, shapes: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Return the values at each corner of patches, (N, 3, 3).

    At a corner it is the mean, by area, of the patches of the same shape that meet there and do not stand at
    an edge to the patch itself.

    Parameters
    ----------
    values : (N, 3)
        Of the patches.
    corners : (N, 3, 3)
        Where they lie; NaN for shapes that are not triangles, which have one value everywhere.
    areas, shapes : (N,)
        Areas and shapes of the patches.
    """
    result = np.repeat(values[:, None, :], 3, axis=1)
    flat = np.flatnonzero(np.isfinite(corners).all(axis=(1, 2)))
    if not flat.size:
        return result
    places = corners[flat].reshape(-1, 3)
    # Shared corners agree but for rounding, since they are computed from weights.
    grid = max(float(np.ptp(places, axis=0).max()), float(np.abs(places).max())) * 2.0**-40
    keys = np.column_stack([np.repeat(shapes[flat], 3), np.round(places / grid)])
    _, group = np.unique(keys, axis=0, return_inverse=True)
    group = group.reshape(-1)
    a, b, c = (corners[flat, i] for i in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    mine, other = _pairs(group)
    patch, neighbor = mine // 3, other // 3
    near = np.einsum("ij,ij->i", normals[patch], normals[neighbor]) > np.cos(np.radians(_CREASE))
    mine, neighbor = mine[near], neighbor[near]
    weights = areas[flat][neighbor]
    whole = np.bincount(mine, weights, len(group))
    for channel in range(3):
        sums = np.bincount(mine, weights * values[flat, channel][neighbor], len(group))
        result[flat, :, channel] = (sums / whole).reshape(-1, 3)
    return result


def _pairs(group: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return all pairs of members of the same group, each with itself too."""
    order = np.argsort(group, kind="stable")
    sizes = np.bincount(group)
    starts = np.cumsum(sizes) - sizes
    size, start = sizes[group[order]], starts[group[order]]
    first = np.repeat(order, size)
    within = np.arange(len(first)) - np.repeat(np.cumsum(size) - size, size)
    return first, order[np.repeat(start, size) + within]
