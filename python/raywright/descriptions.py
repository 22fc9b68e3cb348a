"""Copies of descriptions, such as shapes, which keep their class, whatever its constructor takes."""

from __future__ import annotations

from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from .arrays import frozen

T = TypeVar("T")


def changed(described: T, **values: Any) -> T:
    """Return a copy with other values, which are checked already; arrays are shared."""
    copy = object.__new__(type(described))
    vars(copy).update(state(described), **values)
    return copy


def state(described: object) -> dict[str, Any]:
    """Return what a description holds, without what is computed from it when needed."""
    kind = type(described)
    return {
        name: value
        for name, value in vars(described).items()
        if not isinstance(getattr(kind, name, None), cached_property)
    }


def as_kind(kind: type[T], made: T) -> T:
    """Return an instance of a subclass that holds what one of its base holds."""
    copy = object.__new__(kind)
    vars(copy).update(vars(made))
    return copy


def restored(kind: type[T], values: dict[str, Any]) -> T:
    """Return the instance of a class that holds these values, unpickled: its arrays are read-only again."""
    copy = object.__new__(kind)
    vars(copy).update(
        (name, frozen(value) if isinstance(value, np.ndarray) else value) for name, value in values.items()
    )
    return copy
