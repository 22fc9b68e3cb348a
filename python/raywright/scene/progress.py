"""Progress of builds: a bar on stderr for long ones, or a callback."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import TypeAlias

Report: TypeAlias = Callable[[float], object]
BuildProgress: TypeAlias = bool | Report

# Seconds before a bar appears: shorter builds do not need one.
_PATIENCE = 2.0


def check_progress(progress: object) -> None:
    """Raise a TypeError unless it says how a build is watched."""
    if not (callable(progress) or isinstance(progress, bool)):
        raise TypeError(f"progress must be True, False or a function, got {progress!r}")


def watcher(progress: BuildProgress | None, what: str = "build") -> AbstractContextManager[Report | None]:
    """Return a callback that takes the finished share of the work; None for no report.

    By default, a bar is shown if stderr is a terminal.
    """
    if progress is None:
        progress = sys.stderr is not None and sys.stderr.isatty()
    if callable(progress):
        return _to_the_end(progress)
    return bar(what) if progress else nullcontext()


@contextmanager
def _to_the_end(report: Report) -> Iterator[Report]:
    yield report
    report(1.0)


@contextmanager
def bar(what: str) -> Iterator[Report]:
    """Show a bar on stderr once a work has taken two seconds."""
    start, shown = time.monotonic(), None

    def report(share: float) -> None:
        nonlocal shown
        if shown is None:
            if time.monotonic() - start < _PATIENCE:
                return
            from tqdm import tqdm

            form = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}"
            shown = tqdm(total=1.0, desc=what, bar_format=form, file=sys.stderr)
        shown.update(share - shown.n)
        # Refreshes the elapsed time even if the share stands still.
        shown.refresh()

    try:
        yield report
        if shown is not None:
            shown.update(1.0 - shown.n)
    finally:
        if shown is not None:
            shown.close()
