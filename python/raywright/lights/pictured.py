"""Storage and comparison of lights with pictures."""

from __future__ import annotations

from dataclasses import fields
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import frozen, real_array
from ..descriptions import restored, state
from ..io.pictures import read_linear
from ..io.quiet import warn_caller

Texels = NDArray[np.float32]

# Share of negative light in a picture that passes for rounding or out-of-gamut colors of Rec. 709.
_LITTLE = 1e-2


def texels(name: str, value: ArrayLike | str | PathLike[str]) -> Texels:
    """Return a picture of light, (H, W, 3) or (H, W), or the path of one, as read-only linear float32 texels.

    Raises
    ------
    ValueError
        If it is empty, has another shape, or holds numbers that are not finite, or is not a file and negative
        by more than a hundredth of all its light (the error says where).
    TypeError
        If it does not hold real numbers.
    FileNotFoundError
        If a file is missing.

    Warns
    -----
    RuntimeWarning
        If other negative values are taken as 0.
    """
    is_file = isinstance(value, str | PathLike)
    array = read_linear(value) if isinstance(value, str | PathLike) else real_array(name, value)
    if array.ndim == 2:
        array = np.repeat(array[..., None], 3, axis=2)
    if array.ndim != 3 or array.shape[2] != 3 or 0 in array.shape:
        raise ValueError(f"{name} must have shape (H, W, 3) or (H, W), and not be empty, got {array.shape}")
    # Overflow to infinity is reported below.
    with np.errstate(over="ignore"):
        single = frozen(array.astype(np.float32))
    finite = np.isfinite(single)
    negative = finite & (single < 0)
    bad = ~finite | negative
    if bad.any() and np.array_equal(bad, negative) and (is_file or _is_little(single)):
        # Resampling and wider gamuts leave small negative values.
        least = float(single.min())
        single = frozen(np.maximum(single, np.float32(0)))
        warn_caller(
            f"{name}: {int(negative.sum())} negative values, the least of them {least:g}, are taken as 0"
        )
    elif bad.any():
        row, column, _ = np.argwhere(bad)[0]
        came = array[row, column].tolist()
        raise ValueError(f"{name} must be finite and at least 0, got {came} in row {row}, column {column}")
    return single


def _is_little(single: Texels) -> bool:
    """Return whether the negative values of a picture are a hundredth of the others at most, in all."""
    total = single.sum(dtype=np.float64)
    below = -np.minimum(single, 0).sum(dtype=np.float64)
    return bool(below <= _LITTLE * (total + below))


class Pictured:
    """A frozen dataclass that holds arrays: it compares, hashes, prints and pickles by their contents."""

    def _values(self) -> tuple[Any, ...]:
        values = (getattr(self, field.name) for field in fields(self))  # type: ignore[arg-type]
        return tuple((v.shape, v.tobytes()) if isinstance(v, np.ndarray) else v for v in values)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self) or not isinstance(other, Pictured):
            return NotImplemented
        return self._values() == other._values()

    def __hash__(self) -> int:
        return hash((type(self), self._values()))

    def __reduce__(self) -> tuple[Any, ...]:
        return restored, (type(self), state(self))

    def __repr__(self) -> str:
        def told(value: Any) -> str:
            if not isinstance(value, np.ndarray):
                return repr(value)
            height, width = value.shape[:2]
            return f"<{width} x {height} texels>" if value.ndim == 3 else repr(value.tolist())

        parts = [f"{f.name}={told(getattr(self, f.name))}" for f in fields(self)]  # type: ignore[arg-type]
        return f"{type(self).__name__}({', '.join(parts)})"
