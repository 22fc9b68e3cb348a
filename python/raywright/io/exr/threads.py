"""Work on the chunks of a picture, in as many threads as pay: zlib, numpy and the core run beside each other."""

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")
Result = TypeVar("Result")

# Below so many bytes it takes longer to start threads than to do without.
_FEW = 2**20


def each(function: Callable[[T], Result], items: Sequence[T], size: int) -> Iterator[Result]:
    """Yield a function's result for each of some items, in their order; `size` is that of all, in bytes."""
    workers = min(os.cpu_count() or 1, len(items))
    if workers < 2 or size < _FEW:
        yield from map(function, items)
        return
    with ThreadPoolExecutor(workers) as pool:
        yield from pool.map(function, items)
