"""Parameters of a directive, by type and name; each of them must be understood."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ..notes import Notes
from .errors import PbrtError

Floats = NDArray[np.float64]
Given = Mapping[str, tuple[str, list[Any]]]


class Parameters:
    """The parameters of a directive, taken one by one; `done` refuses what is left.

    Parameters
    ----------
    given : mapping
        The type and the values of each, by name.
    where : str
        The file, the line and the directive.
    what : str
        The directive and its type, for notes.
    notes : Notes
        Notes about the file.
    """

    def __init__(self, given: Given, where: str, what: str, notes: Notes) -> None:
        self.given, self.where, self.what, self.notes = dict(given), where, what, notes
        self._left = set(given)

    def over(self, defaults: Given) -> Parameters:
        """Return these, with the missing ones from others, which need not be understood."""
        both = Parameters({**defaults, **self.given}, self.where, self.what, self.notes)
        both._left = set(self.given)
        return both

    def fail(self, why: str) -> NoReturn:
        """Refuse the directive."""
        raise PbrtError(f"{self.where}: {why}")

    def has(self, name: str) -> bool:
        """Return whether a parameter is given."""
        return name in self.given

    def ignore(self, *names: str) -> None:
        """Skip a parameter that changes no picture here."""
        self._left.difference_update(names)

    def leave_out(self, *names: str) -> None:
        """Note and skip parameters that would change a picture, but are not supported."""
        for name in names:
            if self.has(name):
                self.notes.tell(f"parameter {name!r} of {self.what} is left out")
        self.ignore(*names)

    def leave_out_if_true(self, *names: str) -> None:
        """Take switches that are not supported, and note those that are on."""
        for name in names:
            if self.switch(name, False):
                self.leave_out(name)

    def take(self, name: str) -> tuple[str, list[Any]] | None:
        """Return the type and the values of a parameter; None if it is not given."""
        self._left.discard(name)
        return self.given.get(name)

    def numbers(self, name: str, columns: int = 1) -> Floats | None:
        """Return the numbers of a parameter, (N, columns) or of one column (N,); None if it is not given."""
        found = self.take(name)
        if found is None:
            return None
        plain = set(map(type, found[1])) <= {float}
        array = np.array(found[1] if plain else [np.nan], np.float64)
        if not np.isfinite(array).all() or array.ndim != 1 or array.size % columns:
            each = "" if columns == 1 else f", {columns} each"
            self.fail(f"{name} must be finite numbers{each}")
        return array if columns == 1 else array.reshape(-1, columns)

    def number(self, name: str, default: float) -> float:
        """Return one number."""
        found = self.numbers(name)
        if found is None:
            return default
        if found.shape != (1,):
            self.fail(f"{name} must be one number, got {len(found)}")
        return float(found[0])

    def integer(self, name: str, default: int) -> int:
        """Return one whole number."""
        value = self.number(name, default)
        if value != int(value):
            self.fail(f"{name} must be a whole number, got {value:g}")
        return int(value)

    def vector(self, name: str, default: tuple[float, float, float]) -> Floats:
        """Return three numbers."""
        found = self.numbers(name)
        if found is None:
            return np.array(default)
        if found.shape != (3,):
            self.fail(f"{name} must be 3 numbers, got {len(found)}")
        return found

    def switch(self, name: str, default: bool) -> bool:
        """Return a bool."""
        found = self.take(name)
        if found is None:
            return default
        values = [
            {"true": True, "false": False}.get(one, one) if isinstance(one, str) else one for one in found[1]
        ]
        if len(values) != 1 or not isinstance(values[0], bool):
            self.fail(f"{name} must be true or false")
        return bool(values[0])

    def text(self, name: str, default: str | None = None) -> str:
        """Return a text, which must be there if it has no default."""
        found = self.take(name)
        if found is None:
            if default is None:
                self.fail(f"{name} must be given")
            return default
        if len(found[1]) != 1 or not isinstance(found[1][0], str):
            self.fail(f"{name} must be one text in quotes")
        return str(found[1][0])

    def done(self) -> None:
        """Refuse parameters that nobody has taken."""
        for name in self.given:
            if name in self._left:
                self.fail(f"parameter {name!r} is not supported")
