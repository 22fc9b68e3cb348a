"""Unsupported features of a file, gathered for one warning."""

from __future__ import annotations

from ...io.quiet import warn_caller
from .text import told

_MOST = 12


class Notes:
    """Warnings about one file: one of each kind, which names its subjects.

    Parameters
    ----------
    file : str
        The file's name.
    """

    def __init__(self, file: str) -> None:
        self._file = file
        self._kinds: dict[str, dict[str, list[str]]] = {}

    def add(self, kind: str, what: str, material: str | None = None) -> None:
        """Keep that there is something of a kind, in a material if it is in one."""
        of = self._kinds.setdefault(kind, {}).setdefault(what, [])
        if material is not None and material not in of:
            of.append(material)

    def warn(self) -> None:
        """Warn of all that was kept."""
        for kind, found in self._kinds.items():
            shown = [f"{what}{_of(names)}" for what, names in list(found.items())[:_MOST]]
            more = f", and {len(found) - _MOST} more" if len(found) > _MOST else ""
            warn_caller(f"{self._file}: {kind}: {', '.join(shown)}{more}")
        self._kinds.clear()


def _of(materials: list[str]) -> str:
    if not materials:
        return ""
    others = f" and {len(materials) - 1} more" if len(materials) > 1 else ""
    return f" of {told(materials[0])}{others}"
