"""Locks that a forked process does not wait for."""

from __future__ import annotations

import os
import threading
import weakref
from collections.abc import Callable
from types import TracebackType

_all: weakref.WeakSet[Lock] = weakref.WeakSet()


class Lock:
    """A lock that the thread that holds it may take again.

    A forked process has one thread, the one that forked, and would wait for ever for locks that other threads
    of its parent held. There such a lock is open.

    Parameters
    ----------
    abandoned : callable, optional
        Called in a forked process if another thread of the parent held the lock, to undo its unfinished work.
    """

    def __init__(self, abandoned: Callable[[], None] | None = None) -> None:
        self._abandoned = abandoned
        self._lock = threading.RLock()
        self._holder: int | None = None
        self._depth = 0
        _all.add(self)

    def __enter__(self) -> None:
        self._lock.acquire()
        self._holder = threading.get_ident()
        self._depth += 1

    def __exit__(
        self,
        kind: type[BaseException] | None = None,
        error: BaseException | None = None,
        trace: TracebackType | None = None,
    ) -> None:
        self._depth -= 1
        if not self._depth:
            self._holder = None
        self._lock.release()

    def _renew(self) -> None:
        """Open it, in a forked process, unless the only thread there holds it."""
        if self._holder == threading.get_ident():
            return
        is_abandoned = self._holder is not None
        # The lock may be held before its holder is recorded.
        self._lock, self._holder, self._depth = threading.RLock(), None, 0
        if is_abandoned and self._abandoned is not None:
            self._abandoned()


def _renew_all() -> None:
    for lock in list(_all):
        lock._renew()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_renew_all)
