"""Pictures of a render that is under way, as often as they cost little."""

import time
from collections.abc import Callable

from .image import Image

# The least time between two, and how many times as long as showing one took it is at least.
_SECONDS = 0.1
_SHARE = 9.0


class Snapshots:
    """Shows a render to someone: ten times a second at most, and for a tenth of the time at most.

    Parameters
    ----------
    show : callable
        Takes an Image.
    """

    def __init__(self, show: Callable[[Image], object]) -> None:
        self._show = show
        self._due = time.monotonic() + _SECONDS

    def wait(self) -> float:
        """Return the seconds until the next picture is due."""
        return max(self._due - time.monotonic(), 0.0)

    def take(self, image: Callable[[], Image]) -> None:
        """Show the picture that a function makes."""
        began = time.monotonic()
        self._show(image())
        ended = time.monotonic()
        self._due = ended + max(_SECONDS, _SHARE * (ended - began))
