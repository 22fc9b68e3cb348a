"""The JSON of a glTF file, read without trust: errors name their place."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Beyond all lengths, counts and offsets of files.
_MOST = 2**53


class Part:
    """One object of the JSON, and where it stands: ``nodes[3]``, or nothing for the whole.

    Attributes
    ----------
    place : str
        Its place in the file.
    index : int
        Its index in its list; 0 outside of lists.

    Raises
    ------
    ValueError
        By its methods: one line with the error and its place.
    """

    def __init__(self, value: Any, place: str = "", index: int = 0) -> None:
        if not isinstance(value, dict):
            raise ValueError(f"{place or 'its JSON'} must be an object, and is {_told(value)}")
        self._fields: dict[str, Any] = value
        self.place = place
        self.index = index

    def __contains__(self, name: str) -> bool:
        return name in self._fields

    def names(self) -> tuple[str, ...]:
        """Return the names of its members."""
        return tuple(self._fields)

    def at(self, name: str) -> str:
        """Return where something in it stands."""
        return f"{self.place}.{name}" if self.place else name

    def part(self, name: str) -> Part:
        """Return an object in it, an empty one if there is none."""
        return Part(self._fields.get(name, {}), self.at(name))

    def extension(self, name: str) -> Part | None:
        """Return one of its extensions, None if it is not there."""
        extensions = self.part("extensions")
        return extensions.part(name) if name in extensions else None

    def parts(self, name: str) -> list[Part]:
        """Return a list of objects in it, an empty one if there is none."""
        place = self.at(name)
        return [Part(one, f"{place}[{i}]", i) for i, one in enumerate(self._list(name))]

    def text(self, name: str, default: str | None = None) -> str:
        """Return a text, which must be there if there is no default."""
        value = self._fields.get(name, default)
        if not isinstance(value, str):
            raise ValueError(f"{self.at(name)} must be a text, and is {self._came(name)}")
        return value

    def texts(self, name: str) -> tuple[str, ...]:
        """Return a list of texts, an empty one if there is none."""
        values = self._list(name)
        if not all(isinstance(value, str) for value in values):
            raise ValueError(f"{self.at(name)} must be texts")
        return tuple(values)

    def flag(self, name: str) -> bool:
        """Return true or false; what is not there is false."""
        value = self._fields.get(name, False)
        if not isinstance(value, bool):
            raise ValueError(f"{self.at(name)} must be true or false, and is {_told(value)}")
        return value

    def integer(self, name: str, default: int | None = None, least: int = 0, most: int = _MOST) -> int:
        """Return an integer in least..most, which must be there if there is no default."""
        return _integer(self.at(name), self._fields.get(name, default), self._came(name), least, most)

    def reference(self, name: str, of: str, count: int) -> int:
        """Return which of `count` others is meant."""
        result = self.integer(name)
        if result >= count:
            raise ValueError(f"{self.at(name)} is {result}, and there {_are(count)} of {of}")
        return result

    def references(self, name: str, of: str, count: int) -> list[int]:
        """Return which of `count` others are meant, none if nothing is said."""
        found = []
        for i, value in enumerate(self._list(name)):
            place = f"{self.at(name)}[{i}]"
            found.append(_integer(place, value, _told(value), 0, _MOST))
            if found[-1] >= count:
                raise ValueError(f"{place} is {found[-1]}, and there {_are(count)} of {of}")
        return found

    def number(
        self,
        name: str,
        default: float | None = None,
        least: float = -math.inf,
        most: float = math.inf,
    ) -> float:
        """Return a finite number in least..most, which must be there if there is no default."""
        value: Any = self._fields.get(name, default)
        if not _is_number(value):
            raise ValueError(f"{self.at(name)} must be a finite number, and is {self._came(name)}")
        result = float(value)
        if not least <= result <= most:
            raise ValueError(f"{self.at(name)} must be {_between(least, most)}, and is {result:g}")
        return result

    def numbers(
        self,
        name: str,
        count: int | None,
        default: tuple[float, ...] | None = None,
        least: float = -math.inf,
        most: float = math.inf,
    ) -> NDArray[np.float64]:
        """Return so many finite numbers in least..most, which must be there if there is no default."""
        values = self._fields.get(name, default)
        told = "finite numbers" if count is None else f"{count} finite numbers"
        if not (isinstance(values, list | tuple) and all(map(_is_number, values))):
            raise ValueError(f"{self.at(name)} must be {told}, and is {self._came(name)}")
        if count is not None and len(values) != count:
            raise ValueError(f"{self.at(name)} must be {told}, and is {len(values)}")
        result = np.array(values, np.float64)
        if not ((result >= least) & (result <= most)).all():
            told = ", ".join(f"{x:g}" for x in result)
            raise ValueError(f"{self.at(name)} must be {_between(least, most)}, and is ({told})")
        return result

    def _list(self, name: str) -> list[Any]:
        values = self._fields.get(name, [])
        if not isinstance(values, list):
            raise ValueError(f"{self.at(name)} must be a list, and is {_told(values)}")
        return values

    def _came(self, name: str) -> str:
        return _told(self._fields[name]) if name in self._fields else "missing"


def _is_number(value: Any) -> bool:
    # An integer may exceed the range of floats.
    return type(value) in (int, float) and abs(value) <= 1.7e308


def _integer(place: str, value: Any, came: str, least: int, most: int) -> int:
    # JSON has one type of number only, and some programs write 3.0.
    if not _is_number(value) or value != int(value):
        raise ValueError(f"{place} must be an integer, and is {came}")
    if not least <= value <= most:
        raise ValueError(f"{place} must be {_between(least, most)}, and is {came}")
    return int(value)


def _told(value: Any) -> str:
    if value is None or isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list | tuple | dict):
        kind = "an object" if isinstance(value, dict) else "a list"
        return f"{kind} of {len(value)}"
    # Python refuses to print integers of more than some thousand digits.
    told = repr(value) if not isinstance(value, int) or abs(value) < 10**30 else "a very great number"
    return told if len(told) <= 40 else f"{told[:37]}..."


def _between(least: float, most: float) -> str:
    if most in (math.inf, _MOST):
        return f"at least {least:g}"
    return f"between {least:g} and {most:g}"


def _are(count: int) -> str:
    return "are none" if count == 0 else f"is only {count}" if count == 1 else f"are only {count}"
