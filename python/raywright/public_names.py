"""The names that `dir` and tab completion show of a module."""

from __future__ import annotations

import sys
from collections.abc import Callable


def public_names(module: str) -> Callable[[], list[str]]:
    """Return the ``__dir__`` of a module: its ``__all__`` and the dunder names, without what it imports."""

    def listed() -> list[str]:
        own = vars(sys.modules[module])
        return sorted({*own["__all__"], *(name for name in own if name.startswith("__"))})

    return listed
