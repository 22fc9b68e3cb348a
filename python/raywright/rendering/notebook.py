"""Pictures in notebooks, where they change while a render goes on."""

import sys
from collections.abc import Callable

from .image import Image


def display() -> Callable[[Image], None] | None:
    """Return what shows pictures under the notebook cell that is being run, one in the place of the other.

    None where no notebook is. Nothing is imported then: a notebook has imported IPython already.
    """
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    # A terminal has a shell as well, but no kernel, and no place for pictures.
    if getattr(shell, "kernel", None) is None:
        return None
    from IPython.display import DisplayHandle

    handle = DisplayHandle()
    shown = False

    def show(image: Image) -> None:
        nonlocal shown
        if shown:
            handle.update(image)
        else:
            handle.display(image)
        shown = True

    return show
