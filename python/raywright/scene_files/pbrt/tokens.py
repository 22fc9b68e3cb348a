"""Words of a file, and the directives that they make."""

from __future__ import annotations

import gzip
import re
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from ..notes import Notes
from .errors import PbrtError
from .parameters import Parameters

# A quoted text, a bracket, or any word without spaces; a comment starts with #.
_WORD = re.compile(r'"((?:[^"\\\n]|\\.)*)"|(#[^\n]*)|([\[\]])|([^\s"\[\]#]+)|(\n)')
# Numbers and texts before the parameters of each directive.
_NUMBERS = {
    "LookAt": 9, "Translate": 3, "Scale": 3, "Rotate": 4, "Transform": 16, "ConcatTransform": 16,
    "TransformTimes": 2,
}  # fmt: skip
_TEXTS = {
    "Accelerator": 1, "AreaLightSource": 1, "Attribute": 1, "Camera": 1, "ColorSpace": 1,
    "CoordinateSystem": 1, "CoordSysTransform": 1, "Film": 1, "Import": 1, "Include": 1, "Integrator": 1,
    "LightSource": 1, "MakeNamedMaterial": 1, "MakeNamedMedium": 1, "Material": 1, "MediumInterface": 2,
    "NamedMaterial": 1, "ObjectBegin": 1, "ObjectInstance": 1, "Option": 0, "PixelFilter": 1, "Sampler": 1,
    "Shape": 1, "Texture": 3,
}  # fmt: skip
_BARE = (
    "AttributeBegin", "AttributeEnd", "Identity", "ObjectEnd", "ReverseOrientation", "TransformBegin",
    "TransformEnd", "WorldBegin",
)  # fmt: skip
# Arguments of ActiveTransform, words without quotes.
_TIMES = ("All", "StartTime", "EndTime")


class Word(NamedTuple):
    """A word of a file, whether it was in quotes, and its line."""

    text: str
    quoted: bool
    line: int


class Directive(NamedTuple):
    """A directive of a file: its name, and its arguments."""

    name: str
    texts: tuple[str, ...]
    numbers: tuple[float, ...]
    parameters: Parameters
    where: str


def directives(path: Path, notes: Notes) -> Iterator[Directive]:
    """Yield the directives of a file, one after the other.

    Parameters
    ----------
    path : Path
        The file; one that ends in ``.gz`` is decompressed.
    notes : Notes
        Notes about the scene.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    ValueError
        If it is not as pbrt's files are; the error gives the line.
    """
    words = _Words(path)
    while (word := words.next()) is not None:
        where = f"{path}, line {word.line}"
        name = word.text
        if word.quoted or not (name in _NUMBERS or name in _TEXTS or name in (*_BARE, "ActiveTransform")):
            raise PbrtError(f"{where}: {name[:40]!r} is not a known directive")
        numbers = words.numbers(_NUMBERS[name], where) if name in _NUMBERS else ()
        texts: list[str] = [words.time(where)] if name == "ActiveTransform" else []
        for _ in range(_TEXTS.get(name, 0)):
            text = words.next()
            if text is None or not text.quoted:
                if name == "MediumInterface" and texts:
                    # A single name applies to both sides.
                    words.back(text)
                    break
                raise PbrtError(f"{where}: {name} must have a quoted string")
            texts.append(text.text)
        takes = name in _TEXTS and name not in ("Include", "Import", "NamedMaterial", "MediumInterface")
        given = _parameters(words) if takes else {}
        # Notes appear once per kind of directive, and names chosen by the file are not kinds.
        kind = "" if name.startswith("MakeNamed") else "".join(texts[-1:])
        parameters = Parameters(
            given, f"{where}: {' '.join((name, *texts))}", f"{name} {kind}".strip(), notes
        )
        yield Directive(name, tuple(texts), numbers, parameters, where)


def text_of(path: Path) -> str:
    """Return the text of a file; one that ends in ``.gz`` is decompressed."""
    data = path.read_bytes()
    if path.suffix.lower() == ".gz":
        try:
            data = gzip.decompress(data)
        except (OSError, EOFError, zlib.error) as error:
            raise PbrtError(f"{path} is not a gzip file that can be read ({error})") from error
    return data.decode("utf-8-sig", errors="replace").replace("\r\n", "\n").replace("\r", "\n")


def _parameters(words: _Words) -> dict[str, tuple[str, list[Any]]]:
    found: dict[str, tuple[str, list[Any]]] = {}
    while (word := words.next()) is not None:
        if not word.quoted:
            words.back(word)
            break
        where = f"{words.path}, line {word.line}"
        kind, _, name = word.text.strip().partition(" ")
        name = name.strip()
        if not name:
            raise PbrtError(f"{where}: a parameter must be a type and a name, got {word.text[:40]!r}")
        if name in found:
            raise PbrtError(f"{where}: {name} is given twice")
        found[name] = kind, words.values(where)
    return found


class _Words:
    """The words of a file, one after the other, with one step back."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._text = text_of(path)
        self._matches = _WORD.finditer(self._text)
        self._line = 1
        self._back: Word | None = None
        self._at = 0

    def next(self) -> Word | None:
        if self._back is not None:
            word, self._back = self._back, None
            return word
        for match in self._matches:
            if self._text[self._at : match.start()].strip():
                raise PbrtError(f"{self.path}, line {self._line}: a quoted string does not end")
            self._at = match.end()
            if match[5] is not None:
                self._line += 1
            elif match[2] is None:
                quoted = match[1] is not None
                return Word(match[1] if quoted else match[3] or match[4], quoted, self._line)
        if self._text[self._at :].strip():
            raise PbrtError(f"{self.path}, line {self._line}: a quoted string does not end")
        return None

    def back(self, word: Word | None) -> None:
        self._back = word

    def numbers(self, count: int, where: str) -> tuple[float, ...]:
        values = [value for value in self._list(count, where) if isinstance(value, float)]
        if len(values) != count:
            raise PbrtError(f"{where}: {count} numbers expected, got {len(values)}")
        return tuple(values)

    def time(self, where: str) -> str:
        word = self.next()
        if word is None or word.quoted or word.text not in _TIMES:
            raise PbrtError(f"{where}: ActiveTransform must be one of {', '.join(_TIMES)}")
        return word.text

    def values(self, where: str) -> list[Any]:
        return self._list(1, where)

    def _list(self, bare: int, where: str) -> list[Any]:
        """Return what is in brackets, or so many values without."""
        first = self.next()
        if first is None:
            raise PbrtError(f"{where}: values are missing")
        if first.quoted or first.text != "[":
            self.back(first)
            return [self._value(self.next(), where) for _ in range(bare)]
        found: list[Any] = []
        while True:
            word = self.next()
            if word is None:
                raise PbrtError(f"{where}: a bracket is not closed")
            if not word.quoted and word.text == "]":
                return found
            found.append(self._value(word, where))

    def _value(self, word: Word | None, where: str) -> Any:
        if word is None:
            raise PbrtError(f"{where}: values are missing")
        if word.quoted:
            return word.text
        if word.text in ("true", "false"):
            return word.text == "true"
        try:
            return float(word.text)
        except ValueError:
            raise PbrtError(f"{where}: {word.text[:40]!r} is not a value") from None
