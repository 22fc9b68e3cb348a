"""Notes about a scene file: what of it is not shown as it says."""

from __future__ import annotations

from pathlib import Path

from ..io.quiet import warn_caller


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
        """Warn of all notes, where the library was called."""
        for what in self._told:
            warn_caller(f"{self.path}: {what}")
