"""Meshes with textures: coordinates of corners, and materials of faces."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .corners import distinct

Integers = NDArray[np.integer[Any]]


def split_corners(
    corners: Integers, uv: NDArray[np.floating[Any]], count: int
) -> tuple[Integers, Integers, NDArray[np.floating[Any]]]:
    """Return vertices that have one texture coordinate each, of corners of faces that have their own.

    Parameters
    ----------
    corners : (C,) int array
        The vertex of each corner.
    uv : (C, 2) array
        Its coordinates.
    count : int
        Number of vertices.

    Returns
    -------
    sources : (W,) int64 array
        Original index of each vertex: the first `count` are themselves, and behind them are the copies of
        vertices with several coordinates.
    corners : (C,) int64 array
        The new vertex of each corner.
    uv : (W, 2) array
        0 for vertices without a face.
    """
    sources = np.arange(count)
    placed = np.zeros((count, 2), uv.dtype)
    if not len(corners):
        return sources, corners.astype(np.int64), placed
    vertex = corners.astype(np.int64)
    u, v = (np.unique(uv[:, k], return_inverse=True)[1].reshape(-1).astype(np.int64) for k in (0, 1))
    first, place = distinct([vertex, u, v])
    owner = vertex[first]
    order = np.argsort(owner, kind="stable")
    is_own = np.zeros(len(owner), np.bool_)
    is_own[order[np.flatnonzero(np.diff(owner[order], prepend=-1))]] = True
    number = np.where(is_own, owner, count - 1 + np.cumsum(~is_own))
    placed[owner[is_own]] = uv[first[is_own]]
    added = first[~is_own]
    return (
        np.concatenate([sources, vertex[added]]),
        number[place],
        np.concatenate([placed, uv[added]]),
    )


def by_number(numbers: Integers, among: int) -> Iterator[tuple[int, Any]]:
    """Yield each number that is there, those out of range as -1, with its places; a slice for all."""
    known = np.where((numbers >= 0) & (numbers < among), numbers, -1)
    found = np.unique(known) if len(known) else np.array([-1])
    for number in found:
        yield int(number), (slice(None) if len(found) == 1 else np.flatnonzero(known == number))
