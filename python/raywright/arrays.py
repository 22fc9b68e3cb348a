"""What comes in as numbers: checked, converted, and refused with one clear line."""

import math
import operator
import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Triple = tuple[float, float, float]

# What numpy says of nested lists whose lengths differ.
_RAGGED = ("inhomogeneous", "could not broadcast", "setting an array element with a sequence")

# As many may be started on any machine, if they are asked for.
_THREADS = 64

_DOUBLE, _SINGLE = np.dtype(np.float64), np.dtype(np.float32)


def real_array(name: str, value: ArrayLike) -> NDArray[Any]:
    """Return `value` as an array of float32 or float64 in native byte order, without a copy where possible.

    Integers and the other real types become float64.

    Raises
    ------
    TypeError
        If the values are not real numbers (bool, complex, text, objects), or numpy cannot read them: why, and
        what helps.
    ValueError
        If nested sequences are ragged.
    """
    if type(value) is np.ndarray and (value.dtype is _DOUBLE or value.dtype is _SINGLE):
        return value
    array = _as_array(name, value)
    _unmasked(name, value)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{name} must be real numbers, got {_describe(value, array, short=True)}")
    native = array.dtype.newbyteorder("=")
    return array.astype(np.float32 if native == np.float32 else np.float64, copy=False)


def last_axis(name: str, value: ArrayLike, length: int) -> NDArray[Any]:
    """Return `value` as `real_array` does, having checked that its last dimension has `length` entries."""
    array = real_array(name, value)
    if array.ndim == 0 or array.shape[-1] != length:
        raise ValueError(f"{name} must have shape (..., {length}), got {array.shape}")
    return array


def rows(name: str, value: ArrayLike, columns: int, count: int | None = None) -> NDArray[Any]:
    """Return a read-only, C-contiguous copy of an array of shape (count, columns)."""
    array = real_array(name, value)
    if array.size == 0 and array.ndim == 1:
        array = array.reshape(0, columns)
    if array.ndim != 2 or array.shape[1] != columns or (count is not None and len(array) != count):
        expected = f"({'N' if count is None else count}, {columns})"
        raise ValueError(f"{name} must have shape {expected}, got {array.shape}")
    return frozen(array)


def triangles(name: str, value: ArrayLike, vertices: int) -> NDArray[np.uint32]:
    """Return a read-only, C-contiguous uint32 copy of (F, 3) indices, each in 0..vertices - 1."""
    array = _as_array(name, value)
    _unmasked(name, value)
    if array.size == 0 and array.shape in ((0,), (0, 3)):
        array = np.empty((0, 3), np.uint32)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name} must be integers, got {_describe(value, array)}")
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} must have shape (F, 3), got {array.shape}")
    if array.size and (int(array.min()) < 0 or int(array.max()) >= vertices):
        first = int(np.argmax(((array < 0) | (array >= vertices)).any(axis=1)))
        corners = ", ".join(str(int(i)) for i in array[first])
        raise ValueError(f"face {first} of {name} is ({corners}), but there are {vertices} vertices")
    return frozen(array.astype(np.uint32))


def indices(name: str, value: ArrayLike, count: int) -> NDArray[np.int64]:
    """Return integers of any shape, each in 0..count - 1."""
    array = _as_array(name, value)
    _unmasked(name, value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name} must be integers, got {_describe(value, array)}")
    if array.size and (int(array.min()) < 0 or int(array.max()) >= count):
        first = array.reshape(-1)[np.argmax((array < 0) | (array >= count))]
        raise ValueError(f"{name} must be between 0 and {count - 1}, got {first}")
    return array.astype(np.int64)


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Return a read-only, C-contiguous copy."""
    copy = np.array(array, order="C", copy=True, subok=False)
    copy.setflags(write=False)
    return copy


def triple(name: str, value: ArrayLike) -> Triple:
    """Return three finite numbers as a tuple of floats."""
    array = real_array(name, value)
    if array.shape != (3,):
        raise ValueError(f"{name} must be 3 numbers, got shape {array.shape}")
    return _finite(name, array)


def colour(name: str, value: ArrayLike, most: float = math.inf) -> Triple:
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


def thread_limit(threads: int | None) -> int | None:
    """Return how many threads may be used, or None for one a core.

    Many more than there are cores bring nothing, and take long to be started: of those there are no more.
    """
    if threads is None:
        return None
    limit = integer("threads", threads, 1)
    return limit if limit <= _THREADS else min(limit, max(_THREADS, os.cpu_count() or 1))


def choice(name: str, value: str, choices: tuple[str, ...]) -> None:
    """Refuse what is not one of the choices."""
    if value not in choices:
        raise ValueError(f"{name} must be one of {', '.join(map(repr, choices))}, got {value!r}")


def _as_array(name: str, value: ArrayLike) -> NDArray[Any]:
    try:
        return np.asarray(value)
    except MemoryError:
        raise
    except Exception as error:
        # What numpy itself says of a list has no frame of Python below this one; what its entries say may.
        is_own = isinstance(value, list | tuple) and error.__traceback__ and not error.__traceback__.tb_next
        if is_own and isinstance(error, ValueError) and any(words in str(error) for words in _RAGGED):
            raise ValueError(
                f"{name} must be a rectangular array, got ragged {type(value).__name__}"
            ) from None
        culprit = _culprit(value)
        within = "" if culprit is value else f" of {type(culprit).__name__}"
        told = " ".join(str(error).split()).rstrip(".") or type(error).__name__
        came = f"{type(value).__name__}{within}, which numpy cannot read ({told}){_cure(culprit)}"
        kind = ValueError if isinstance(error, ValueError) else TypeError
        raise kind(f"{name} must be an array of numbers, got {came}") from error


def _culprit(value: object) -> object:
    """Return what in nested lists numpy cannot read."""
    while isinstance(value, list | tuple):
        for entry in value:
            try:
                np.asarray(entry)
            except Exception:
                value = entry
                break
        else:
            break
    return value


def _cure(value: object) -> str:
    """Return what makes an array of something that numpy cannot read or finds no numbers in."""
    if hasattr(value, "detach") and hasattr(value, "cpu"):
        steps = [".detach()"] if getattr(value, "requires_grad", False) else []
        steps += [".cpu()"] if str(getattr(value, "device", "cpu")).partition(":")[0] != "cpu" else []
        return f"; pass its {''.join(steps or ['.detach().cpu()'])}.numpy()"
    if hasattr(value, "__cuda_array_interface__"):
        return "; pass its copy on the host" + (", .get()" if hasattr(value, "get") else "")
    if hasattr(value, "to_numpy"):
        return "; pass its .to_numpy(dtype=float, na_value=float('nan')), or fill what is missing first"
    if hasattr(value, "to_pandas"):
        return "; pass its .to_pandas().to_numpy(dtype=float)"
    return ""


def _unmasked(name: str, value: ArrayLike) -> None:
    """Refuse masked entries, which numpy would take for what lies below the mask."""
    if isinstance(value, np.ma.MaskedArray) and (count := int(np.ma.getmaskarray(value).sum())):
        raise ValueError(f"{name} must have no masked entries, got {count}: fill them, as with NaN")


def _finite(name: str, array: NDArray[Any]) -> Triple:
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got {tuple(array.tolist())}")
    x, y, z = (float(v) for v in array)
    return x, y, z


def _describe(value: object, array: NDArray[Any], short: bool = False) -> str:
    """Return what came instead of numbers and, where it is objects, the first that is none and what helps."""
    if not array.ndim and not isinstance(value, np.ndarray):
        return f"{value!r}{_cure(value)}"
    is_named = not (short and isinstance(value, np.ndarray))
    came = f"{type(value).__name__} of dtype {array.dtype}" if is_named else f"dtype {array.dtype}"
    if array.dtype != object or isinstance(value, list | tuple):
        return came
    others = (i for i, entry in np.ndenumerate(array) if not isinstance(entry, float | int | np.number))
    first = next(others, None)
    if first is None:
        return f"{came}: numbers of a type that numpy has not{_cure(value) or '; pass its .astype(float)'}"
    at = ", ".join(map(str, first))
    return f"{came}, with {array[first]!r} at [{at}]{_cure(value)}"
