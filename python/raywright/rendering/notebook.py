"""Pictures in notebooks, updated during a render."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from .image import Image


def display() -> Callable[[Image], None] | None:
    """Return the display under the running notebook cell, in which each picture replaces the last.

    None where no notebook is. Nothing is imported then: a notebook has imported IPython already. The last
    picture knows that it is displayed, and shows no second one if the cell ends with it.
    """
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    # A terminal has a shell as well, but neither a kernel nor room for pictures.
    if getattr(shell, "kernel", None) is None:
        return None
    from IPython.display import DisplayHandle

    handle = DisplayHandle()
    shown = False
    cell = _cell(shell)

    def show(image: Image) -> None:
        nonlocal shown
        if shown:
            handle.update(image)
        else:
            handle.display(image)
        shown = True
        # Not a field of the picture: it only holds here, and copies must not have it.
        vars(image)["_is_shown"] = lambda: _cell(shell) == cell

    return show


def _cell(shell: Any) -> int | None:
    """Return the number of the cell that is being run."""
    number: int | None = getattr(shell, "execution_count", None)
    return number
