"""Threads for the chunks of a picture: zlib, numpy and the core release the interpreter's lock."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from ..._core import cores

T = TypeVar("T")
Result = TypeVar("Result")

# For fewer bytes, starting threads takes longer than it saves.
_FEW = 2**20


def each(function: Callable[[T], Result], items: Sequence[T], size: int) -> Iterator[Result]:
    """Yield the result of a function for each item, in order; `size` is the number of bytes of all items."""
    workers = min(cores(), len(items))
    if workers < 2 or size < _FEW:
        yield from map(function, items)
        return
    # Imported here, because only packing needs it (import time).
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(workers) as pool:
        yield from pool.map(function, items)
