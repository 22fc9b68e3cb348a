"""Pictures of a render that is under way, as often as they cost little."""

from __future__ import annotations

import time
import weakref
from collections.abc import Callable

from .image import Image
from .partial_image import ImageSoFar

# Least seconds between two pictures, and ten times their cost at least, so that they take a tenth of the
# work.
_SECONDS = 0.1
_TIMES = 10.0
# Least pause after a picture, in multiples of its time, however many threads there are.
_REST = 1.0


class Snapshots:
    """Shows a render to someone: ten times a second at most, and for a tenth of the work at most.

    Pixels are computed on access: a callback that only reads the progress, or stops the render, is called ten
    times a second however large the picture is.

    Parameters
    ----------
    show : callable
        Takes an Image.
    threads : int
        Number of threads that render meanwhile: showing a picture takes the time of one of them.
    """

    def __init__(self, show: Callable[[Image], object], threads: int) -> None:
        self._show, self._threads = show, threads
        self._due = time.monotonic() + _SECONDS

    @property
    def due(self) -> bool:
        """Return whether the next picture is due."""
        return time.monotonic() >= self._due

    def take(self, image: Callable[[], ImageSoFar], waits: Callable[[], bool]) -> None:
        """Show the picture that a function makes; another says in the end whether the render `waits`."""
        began = time.monotonic()
        shown = image()
        kept = weakref.ref(shown)
        self._show(shown)
        whole = shown.is_whole
        del shown
        # A picture still referenced elsewhere computes all its pixels now.
        still = kept()
        if still is not None:
            still.settle()
            whole = True
        ended = time.monotonic()
        # Error estimates use all cores.
        alone = 1 if whole or waits() else self._threads
        rest = max(_TIMES / alone - 1, _REST) * (ended - began)
        self._due = max(began + _SECONDS, ended + rest)
