"""Which parts of hits are asked for, and the arrays that they are written to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .rays import written_to

# Parts that are written, in the order that the core has them.
STORED = ("t", "shape_id", "primitive_id", "uv", "instance_id")
_NAMES = (*STORED, "hit")
_DOUBLE, _SINGLE, _BOOL = np.dtype(np.float64), np.dtype(np.float32), np.dtype(np.bool_)
_INTEGER = np.dtype(np.int32)
_FLOATS = tuple(map(np.dtype, (np.float64, np.float32, np.float16, np.longdouble)))
_TYPES = {"t": _FLOATS, "uv": _FLOATS, "hit": (_BOOL,)}

Arrays = dict[str, NDArray[Any]]


class Asked:
    """Parts of hits of rays of a leading shape: which they are, and arrays of the caller's.

    Parameters
    ----------
    fields : str or sequence of str, optional
        Which parts; those of `out` if not given.
    out : mapping of str to arrays
        Where some of them are written.
    shape : tuple of int
        Leading shape of the rays.
    """

    def __init__(
        self, fields: str | Sequence[str] | None, out: Mapping[str, NDArray[Any]], shape: tuple[int, ...]
    ) -> None:
        self.names = _names(tuple(out) if fields is None else fields)
        self.shape = shape
        self.out: Arrays = {}
        for name, array in out.items():
            if name not in self.names:
                raise ValueError(f"out has an array of {name!r}, which is not among fields {self.names}")
            lead = (*shape, 2) if name == "uv" else shape
            self.out[name] = written_to(f"out[{name!r}]", array, lead, _TYPES.get(name, (_INTEGER,)))
        arrays = list(self.out.items())
        for i, (name, array) in enumerate(arrays):
            for other, another in arrays[:i]:
                if array.size and np.shares_memory(array, another):
                    raise ValueError(f"out[{name!r}] and out[{other!r}] share memory")

    @property
    def is_hit_alone(self) -> bool:
        """Whether it is asked only if rays hit anything."""
        return self.names == ("hit",)

    @property
    def is_lent(self) -> bool:
        """Whether arrays of the caller's say which faces are hit: they may change after the call."""
        return any(self.out[name].dtype == _INTEGER for name in self.out)

    @property
    def bits(self) -> int:
        """The parts that the core finds, a bit each."""
        needed = {"primitive_id"} if "hit" in self.names else set()
        return sum(1 << i for i, name in enumerate(STORED) if name in needed.union(self.names))

    def given(self) -> tuple[NDArray[Any] | None, ...]:
        """Return the arrays that the core writes to; None for new ones."""
        arrays = (self.out.get(name) for name in STORED)
        return tuple(a if a is None or a.dtype in (_DOUBLE, _SINGLE, _INTEGER) else None for a in arrays)

    def told(self, answer: Sequence[NDArray[Any] | None]) -> Arrays:
        """Return the arrays of an answer of the core by name: those of `out` where there are any."""
        found = {name: array for name, array in zip(STORED, answer, strict=True) if array is not None}
        for array in self.out.values():
            # What leads back into a scene comes read-only; these are the caller's.
            array.setflags(write=True)
        if "instance_id" in self.names and "instance_id" not in found:
            # One number seen from every index, where there are no instances.
            found["instance_id"] = np.broadcast_to(np.int32(-1), self.shape)
        if "hit" in self.names:
            found["hit"] = np.greater_equal(found["primitive_id"], 0, out=self.out.get("hit"))
        for name, array in self.out.items():
            if name in found and found[name] is not array:
                # Of a float type that the core does not write; what does not fit becomes infinite.
                with np.errstate(over="ignore"):
                    np.copyto(array, found[name], casting="same_kind")
                found[name] = array
        return {name: array for name, array in found.items() if name in self.names}


def _names(fields: Any) -> tuple[str, ...]:
    names = (fields,) if isinstance(fields, str) else fields
    if not isinstance(names, Sequence) or not all(isinstance(name, str) for name in names):
        raise TypeError(f"fields must be names among {', '.join(_NAMES)}, got {fields!r}")
    for name in names:
        if name not in _NAMES:
            raise ValueError(f"fields must be among {', '.join(_NAMES)}, got {name!r}")
    if not names:
        raise ValueError(f"fields must name at least one of {', '.join(_NAMES)}")
    return tuple(dict.fromkeys(names))
