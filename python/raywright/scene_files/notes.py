"""Notes about a scene file: what of it is not shown as it says."""

import warnings
from pathlib import Path


class Notes:
    """Notes about a file, each told once.

    Parameters
    ----------
    path : Path
        The file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._told: dict[str, None] = {}

    def tell(self, what: str) -> None:
        """Keep a note."""
        self._told.setdefault(what)

    @property
    def told(self) -> list[str]:
        """All notes."""
        return list(self._told)

    def warn(self) -> None:
        """Warn of all notes, in the name of whoever called the reader."""
        for what in self._told:
            warnings.warn(f"{self.path}: {what}", RuntimeWarning, stacklevel=4)
