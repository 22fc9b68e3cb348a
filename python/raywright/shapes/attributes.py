"""Values of the vertices and faces of meshes, by name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import frozen, real_array, same

Attributes: TypeAlias = Mapping[str, NDArray[Any]]
_NONE: Attributes = MappingProxyType({})


def attributes(name: str, given: Mapping[str, ArrayLike] | None, count: int) -> Attributes:
    """Return read-only copies of (count, ...) arrays of real numbers or bool by their names.

    Raises
    ------
    ValueError
        If an array has another length.
    TypeError
        If `given` is not a mapping, a name is not a str, or an array does not hold real numbers or bool.
    """
    if not given:
        return _NONE
    if not isinstance(given, Mapping):
        raise TypeError(f"{name} must be a dict of arrays by name, got {type(given).__name__}")
    kept: dict[str, NDArray[Any]] = {}
    for key, value in given.items():
        if not isinstance(key, str):
            raise TypeError(f"{name} must have names of type str, got {key!r}")
        # Integers and bools keep their type, as they may be labels.
        is_plain = isinstance(value, np.ndarray) and value.dtype.kind in "iufb"
        array = np.asarray(value) if is_plain else real_array(f"{name}[{key!r}]", value)
        if array.ndim == 0 or len(array) != count:
            raise ValueError(f"{name}[{key!r}] must have shape ({count}, ...), got {array.shape}")
        kept[key] = frozen(array.astype(array.dtype.newbyteorder("="), copy=False))
    return MappingProxyType(kept)


def cell_numbers(name: str, given: ArrayLike, count: int) -> NDArray[np.int64]:
    """Return a read-only copy of (count,) numbers of cells.

    Raises
    ------
    ValueError
        If there are not so many, or one is negative.
    TypeError
        If `given` is not an integer.
    """
    array = np.asarray(given)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name} must be integers, got dtype {array.dtype}")
    if array.shape != (count,):
        raise ValueError(f"{name} must have shape ({count},), one number per face, got {array.shape}")
    if count and int(array.min()) < 0:
        raise ValueError(f"{name} must be at least 0, got {array.min()} of face {int(array.argmin())}")
    return frozen(array.astype(np.int64, copy=False))


def same_attributes(a: Attributes, b: Attributes) -> bool:
    """Return whether two have the same names and values; NaN is equal to NaN."""
    return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
