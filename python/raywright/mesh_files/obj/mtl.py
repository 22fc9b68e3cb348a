"""Material libraries, MTL files: what they say of each material, statement by statement.

The format is "MTL material format" in "File Formats, Version 4.2" (Alias|Wavefront, 1995), with the
statements for physically based rendering that are in use besides it (Pr, Pm, norm, ...).
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .notes import Notes
from .text import name_of, told

_LINE = re.compile(rb"^[ \t]*([^\s#]\S*)[ \t]*([^\n]*)", re.MULTILINE)
_BLENDER = re.compile(rb"[ \t]*#[ \t]*Blender( \d[\w.]*)?[ \t][^\n]*MTL File", re.IGNORECASE)

UNREADABLE = "what cannot be read is left out"
OUTSIDE = "numbers out of range are moved into it"


class Statement(NamedTuple):
    """A line of a library: its keyword as written, and the rest."""

    keyword: str
    rest: str


Statements = dict[str, Statement]


class Written(NamedTuple):
    """A library as it is written.

    Attributes
    ----------
    materials : dict
        The statements of each material, by their keywords in small letters; of several alike the last.
    blender : float, optional
        Written by Blender: the exponent, Ns, of smooth materials.
    """

    materials: dict[str, Statements]
    blender: float | None


def written(text: bytes) -> Written:
    """Take a library apart. The first of duplicate entries counts."""
    materials: dict[str, Statements] = {}
    current: Statements = {}
    for word, rest in _LINE.findall(text):
        keyword = word.decode("utf-8", "replace")
        if keyword.lower() == "newmtl":
            current = {}
            materials.setdefault(name_of(rest), current)
        else:
            value = rest.decode("utf-8", "replace").strip()
            current[keyword.lower()] = Statement(keyword, value)
    head = _BLENDER.match(text)
    # Blender's first exporter, in Python, had 900; from version 3.1 on, the exporter states its version.
    return Written(materials, None if head is None else 1000.0 if head[1] else 900.0)


class Description:
    """Statements of a library about one material, by keyword.

    Parameters
    ----------
    name : str
        Of the material.
    statements : dict of Statement
        By their keywords in small letters.
    notes : Notes
        Collects notes about unreadable statements.
    blender : float, optional
        As in `Written`.
    """

    def __init__(self, name: str, statements: Statements, notes: Notes, blender: float | None = None) -> None:
        self.name = name
        self.blender = blender
        self._statements = statements
        self._notes = notes
        self._left = dict(statements)

    def __contains__(self, keyword: str) -> bool:
        return keyword.lower() in self._statements

    @property
    def left(self) -> tuple[str, ...]:
        """The keywords of statements that nobody has asked for."""
        return tuple(statement.keyword for statement in self._left.values())

    def note(self, kind: str, what: str) -> None:
        """Tell of something in this material."""
        self._notes.add(kind, what, self.name)

    def take(self, *keywords: str) -> None:
        """Skip statements without visible effect."""
        for keyword in keywords:
            self._left.pop(keyword.lower(), None)

    def text(self, keyword: str) -> str | None:
        """Return what follows a keyword, None where it does not stand."""
        self.take(keyword)
        statement = self._statements.get(keyword.lower())
        return None if statement is None else statement.rest

    def number(self, keyword: str, least: float = 0.0, most: float = 1.0) -> float | None:
        """Return a number in least..most, None where there is none."""
        values = self._values(keyword, 1)
        return None if values is None else float(self._moved(keyword, values, least, most)[0])

    def color(self, keyword: str, most: float = 1.0) -> NDArray[np.float64] | None:
        """Return red, green and blue in 0..most, None where there are none."""
        values = self._values(keyword, 3)
        return None if values is None else self._moved(keyword, values, 0.0, most)

    def unless_zero(self, *keywords: str) -> None:
        """Pass over statements of the number 0, which say that there is nothing to be left out."""
        for keyword in keywords:
            statement = self._statements.get(keyword.lower())
            words = () if statement is None else statement.rest.split()
            if words and all(_number(word) == 0 for word in words):
                self.take(keyword)

    def _values(self, keyword: str, count: int) -> NDArray[np.float64] | None:
        """Return so many finite numbers; one is enough, and stands for all."""
        rest = self.text(keyword)
        if rest is None:
            return None
        words = rest.split("#")[0].split()[:count]
        numbers = [_number(word) for word in words]
        if len(numbers) not in (1, count) or not all(map(math.isfinite, numbers)):
            self.note(UNREADABLE, told(f"{self._statements[keyword.lower()].keyword} {rest}".strip()))
            return None
        return np.broadcast_to(np.array(numbers), (count,)).copy()

    def _moved(
        self, keyword: str, values: NDArray[np.float64], least: float, most: float
    ) -> NDArray[np.float64]:
        inside = np.clip(values, least, most)
        if (inside != values).any():
            shown = " ".join(f"{x:g}" for x in values)
            self.note(OUTSIDE, told(f"{self._statements[keyword.lower()].keyword} {shown}"))
        return inside


def _number(word: str) -> float:
    """Return a number, NaN for other text."""
    try:
        return float(word)
    except ValueError:
        return math.nan
