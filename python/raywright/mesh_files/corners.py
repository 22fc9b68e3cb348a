"""Corners of faces share a vertex if all of their attributes are equal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Integers = NDArray[np.int64]


def distinct(columns: list[Integers]) -> tuple[Integers, Integers]:
    """Return where each distinct row stands first, in the order of points, and which one each row is."""
    key = columns[0]
    # Many programs write the same index three times.
    others = [column for column in columns[1:] if not np.array_equal(column, key)]
    for column in others:
        size = int(column.max()) + 2
        if int(key.max()) >= 2**62 // size:
            # Renumbered, so that products stay below 2^63.
            _, key = np.unique(key, return_inverse=True)
        key = key.reshape(-1) * size + column + 1
    if not others:
        # Same result as below, without sorting.
        first = np.full(int(key.max()) + 1, -1)
        first[key[::-1]] = np.arange(len(key))[::-1]
        used = first >= 0
        return first[used], (np.cumsum(used) - 1)[key]
    _, first, place = np.unique(key, return_index=True, return_inverse=True)
    return first, place.reshape(-1)
