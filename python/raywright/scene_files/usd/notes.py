"""Errors of a USD stage by prim."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ..notes import Notes

__all__ = ["Notes", "told_of"]


@contextmanager
def told_of(prim: Any) -> Iterator[None]:
    """Name the prim in whatever is wrong with its values."""
    try:
        yield
    except (ValueError, TypeError, IndexError) as error:
        told, name = str(error), str(prim.GetPath())
        raise ValueError(told if told.startswith(name) else f"{name}: {told}") from error
