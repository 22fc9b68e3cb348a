"""Digests that tell two objects apart without keeping them."""

from __future__ import annotations

import pickle
from typing import Any


class _Digest:
    """A file that keeps only a digest of the bytes written to it."""

    def __init__(self) -> None:
        # Imported here, because only checkpoints and executors need it (import time).
        import hashlib

        self._hash = hashlib.sha256()

    def write(self, data: Any) -> int:
        self._hash.update(data)
        return len(data)

    def hexdigest(self) -> str:
        return self._hash.hexdigest()


def digest(thing: object) -> str:
    """Return a digest of all that a description holds: equal ones have the same, in any process.

    Raises
    ------
    TypeError
        If it cannot be pickled.
    """
    sink = _Digest()
    # Without a memo, equal data gives equal bytes whether it is one object or two.
    pickler = pickle.Pickler(sink, protocol=4)
    pickler.fast = True
    try:
        pickler.dump(thing)
    except (pickle.PicklingError, AttributeError, TypeError, RecursionError) as error:
        raise TypeError(f"{type(thing).__name__} cannot be pickled: {error}") from error
    return sink.hexdigest()
