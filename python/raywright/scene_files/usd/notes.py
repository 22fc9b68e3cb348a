"""What of a file is not shown as it says, and what is wrong with it."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


@contextmanager
def told_of(prim: Any) -> Iterator[None]:
    """Name the prim in whatever is wrong with its values."""
    try:
        yield
    except (ValueError, TypeError, IndexError) as error:
        told, name = str(error), str(prim.GetPath())
        raise ValueError(told if told.startswith(name) else f"{name}: {told}") from error


class Notes:
    """Notes about a file, each told once."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._told: dict[str, None] = {}

    def tell(self, what: str) -> None:
        """Keep a note."""
        self._told.setdefault(what)

    def warn(self) -> None:
        """Warn of all of them."""
        for what in self._told:
            warnings.warn(f"{self.path}: {what}", RuntimeWarning, stacklevel=3)
