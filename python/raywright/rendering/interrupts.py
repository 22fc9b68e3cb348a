"""Renders that are ended from outside: by Ctrl-C, and by SIGTERM, which leaves a checkpoint behind."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

ON_INTERRUPT = ("raise", "return")


class _TerminatedError(BaseException):
    """SIGTERM has come."""


def unless_terminated(work: Callable[[], None], keep: Callable[[], None]) -> None:
    """Do work; if SIGTERM comes meanwhile, keep the result, and then let the signal act.

    Without a handler of its own the process then ends, by the signal. Where one lets it live, the work goes
    on. SIGTERM is heard in the main thread alone, and not where the process ignores it, or hears it in C.
    """
    while True:
        try:
            with _heard():
                return work()
        except _TerminatedError:
            keep()
            signal.raise_signal(signal.SIGTERM)


@contextmanager
def _heard() -> Iterator[None]:
    """Raise `_TerminatedError` when SIGTERM comes; the handler that there was before is there again after."""
    before = signal.getsignal(signal.SIGTERM)
    if threading.current_thread() is not threading.main_thread() or before in (None, signal.SIG_IGN):
        yield
        return

    def end(_number: int, _frame: FrameType | None) -> None:
        raise _TerminatedError

    signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
