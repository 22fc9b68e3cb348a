"""Numbers as input: checked, converted, and refused with one clear line."""

from __future__ import annotations

import math
import operator
import sys
from typing import TYPE_CHECKING, Any, TypeAlias, Union, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import cores
from .foreign_arrays import as_array, describe

if TYPE_CHECKING:
    from numpy.random import Generator, SeedSequence

Triple = tuple[float, float, float]
# By name: numpy imports its random numbers when they are first used.
SeedLike: TypeAlias = Union[int, "Generator", "SeedSequence"]

# Any machine may start this many threads on request.
_THREADS = 64

_DOUBLE, _SINGLE = np.dtype(np.float64), np.dtype(np.float32)


def real_array(name: str, value: ArrayLike) -> NDArray[Any]:
    """Return `value` as an array of float32 or float64 in native byte order, without a copy where possible.

    Integers and the other real types become float64. `as_array` lists the types of other libraries.

    Raises
    ------
    TypeError
        If the values are not real numbers (bool, complex, text, objects), have a unit, are not on the CPU, or
        numpy cannot read them: with the reason and a remedy.
    ValueError
        If nested sequences are ragged, or entries are masked.
    """
    if type(value) is np.ndarray and (value.dtype is _DOUBLE or value.dtype is _SINGLE):
        return value
    array = as_array(name, value)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{name} must be real numbers, got {describe(value, array, short=True)}")
    native = array.dtype.newbyteorder("=")
    return array.astype(np.float32 if native == np.float32 else np.float64, copy=False)


def last_axis(name: str, value: ArrayLike, length: int) -> NDArray[Any]:
    """Return `value` as `real_array` does, having checked that its last dimension has `length` entries."""
    array = real_array(name, value)
    if array.shape[-1:] != (length,):
        raise ValueError(f"{name} must have shape (..., {length}), got {array.shape}")
    return array


def rows(name: str, value: ArrayLike, columns: int, count: int | None = None) -> NDArray[Any]:
    """Return an array of shape (count, columns) as `frozen` does."""
    array = real_array(name, value)
    if array.size == 0 and array.ndim == 1:
        array = array.reshape(0, columns)
    if array.ndim != 2 or array.shape[1] != columns or (count is not None and len(array) != count):
        expected = f"({'N' if count is None else count}, {columns})"
        raise ValueError(f"{name} must have shape {expected}, got {array.shape}")
    return frozen(array)


def triangles(name: str, value: ArrayLike, vertices: int) -> NDArray[np.uint32]:
    """Return (F, 3) indices, each in 0..vertices - 1, as uint32, read-only and C-contiguous."""
    array = as_array(name, value)
    if array.size == 0 and array.shape in ((0,), (0, 3)):
        array = np.empty((0, 3), np.uint32)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name} must be integers, got {describe(value, array)}")
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} must have shape (F, 3), got {array.shape}")
    if array.size and (int(array.min()) < 0 or int(array.max()) >= vertices):
        first = int(np.argmax(((array < 0) | (array >= vertices)).any(axis=1)))
        corners = ", ".join(str(int(i)) for i in array[first])
        raise ValueError(f"face {first} of {name} is ({corners}), but there are {vertices} vertices")
    if array.dtype == np.uint32:
        return frozen(array)
    numbers = array.astype(np.uint32, order="C")
    numbers.setflags(write=False)
    return numbers


def indices(name: str, value: ArrayLike, count: int, instead: str = "") -> NDArray[np.int64]:
    """Return integers of any shape, each in 0..count - 1; `instead` ends the error for real numbers."""
    array = as_array(name, value)
    if array.dtype.kind not in "iu":
        told = instead if array.dtype.kind == "f" else ""
        raise TypeError(f"{name} must be integers, got {describe(value, array)}{told}")
    if array.size and (int(array.min()) < 0 or int(array.max()) >= count):
        first = array.reshape(-1)[np.argmax((array < 0) | (array >= count))]
        raise ValueError(f"{name} must be between 0 and {count - 1}, got {first}")
    return array.astype(np.int64)


def bools(name: str, value: ArrayLike, what: str) -> NDArray[np.bool_]:
    """Return an array of bool of any shape; `what` names each of them in an error."""
    array = as_array(name, value)
    if array.dtype != np.bool_:
        raise TypeError(f"{name} must be bool, {what}, got dtype {array.dtype}")
    return array


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Return a read-only, C-contiguous copy, or the array itself if it cannot be written to."""
    if array.flags.c_contiguous and array.flags.aligned and _is_constant(array):
        return array
    copy = np.array(array, order="C", copy=True, subok=False)
    copy.setflags(write=False)
    return copy


def sealed(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array, which can be read only from now on."""
    array.setflags(write=False)
    return array


def same(a: NDArray[Any] | None, b: NDArray[Any] | None) -> bool:
    """Return whether two arrays have the same type and values, or neither is there; NaN is equal to NaN."""
    if a is None or b is None:
        return a is b
    return a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind == "f")


def triple(name: str, value: ArrayLike) -> Triple:
    """Return three finite numbers as a tuple of floats."""
    array = real_array(name, value)
    if array.shape != (3,):
        raise ValueError(f"{name} must be 3 numbers, got shape {array.shape}")
    return _finite(name, array)


def color(name: str, value: ArrayLike, most: float = math.inf) -> Triple:
    """Return one number or three (red, green, blue) as three floats, each finite and in 0..most."""
    array = real_array(name, value)
    if array.shape not in ((), (3,)):
        raise ValueError(f"{name} must be one number or 3, got shape {array.shape}")
    red, green, blue = _finite(name, np.broadcast_to(array, 3))
    if min(red, green, blue) < 0 or max(red, green, blue) > most:
        allowed = "at least 0" if most == math.inf else f"between 0 and {most:g}"
        raise ValueError(f"{name} must be {allowed}, got {value!r}")
    return red, green, blue


def number(name: str, value: float) -> float:
    """Return one finite number as a float."""
    array = real_array(name, value)
    if array.ndim:
        raise ValueError(f"{name} must be one number, got shape {array.shape}")
    if not np.isfinite(array):
        raise ValueError(f"{name} must be finite, got {value}")
    return float(array)


def positive(name: str, value: float) -> float:
    """Return one finite number greater than 0 as a float."""
    result = number(name, value)
    if result <= 0:
        raise ValueError(f"{name} must be greater than 0, got {value}")
    return result


def label(name: str, value: str | None) -> str | None:
    """Return a text, or None."""
    if value is not None and not isinstance(value, str):
        raise TypeError(f"{name} must be a str, got {type(value).__name__}")
    return value or None


def integer(name: str, value: int, least: int, most: int | None = None) -> int:
    """Return an integer in least..most."""
    try:
        if isinstance(value, bool | np.bool_):
            raise TypeError
        result = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be an integer, got {value!r}") from None
    if result < least or (most is not None and result > most):
        allowed = f"at least {least}" if most is None else f"between {least} and {most}"
        raise ValueError(f"{name} must be {allowed}, got {result}")
    return result


def seed_number(value: SeedLike, most: int | None = 2**64 - 1, name: str = "seed") -> int:
    """Return a seed as an integer in 0..most, or at least 0.

    A Generator is advanced by one draw, so that the next call that takes it gets another seed. A SeedSequence
    is not changed, and always gives the same. Their integers are below 2^64; `most` must be one less than a
    power of two.
    """
    # Where numpy's random numbers are not imported, nobody has an object of them.
    random: Any = sys.modules.get("numpy.random")
    if random is not None:
        mask = -1 if most is None else most
        if isinstance(value, random.Generator):
            return int(value.integers(2**64 - 1, dtype=np.uint64, endpoint=True)) & mask
        if isinstance(value, random.SeedSequence):
            return int(value.generate_state(1, np.uint64)[0]) & mask
        if isinstance(value, random.RandomState | random.BitGenerator):
            raise TypeError(f"{name} must be an integer, a Generator or a SeedSequence, got {value!r}")
    return integer(name, cast(int, value), 0, most)


def thread_limit(threads: int | None) -> int | None:
    """Return how many threads may be used, or None for one per core.

    Many more threads than cores gain nothing and take long to start, so their number is limited.
    """
    if threads is None:
        return None
    limit = integer("threads", threads, 1)
    return limit if limit <= _THREADS else min(limit, max(_THREADS, cores()))


def choice(name: str, value: str, choices: tuple[str, ...]) -> None:
    """Refuse other values than the choices."""
    if value not in choices:
        raise ValueError(f"{name} must be one of {', '.join(map(repr, choices))}, got {value!r}")


def _is_constant(array: NDArray[Any]) -> bool:
    """Return whether an array, and the base of its view, are numpy's own and cannot be written to."""
    base: Any = array
    while type(base) is np.ndarray and not base.flags.writeable:
        if base.base is None:
            return True
        base = base.base
    return False


def _finite(name: str, array: NDArray[Any]) -> Triple:
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got {tuple(array.tolist())}")
    x, y, z = (float(v) for v in array)
    return x, y, z
