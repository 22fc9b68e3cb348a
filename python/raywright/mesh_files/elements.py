"""Elements of PLY and OFF files, of text and of bytes: numbers and lists of numbers."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .tokens import leading_numbers, lines_of, word_at

Numbers: TypeAlias = NDArray[Any]
Integers: TypeAlias = NDArray[np.int64]


class Property(NamedTuple):
    """A number, or a list of numbers, of each element.

    Attributes
    ----------
    name : str
    type : str
        Of the number, as numpy calls it.
    count_type : str, optional
        Of the length of a list; None for a single number.
    """

    name: str
    type: str
    count_type: str | None = None


class Element(NamedTuple):
    """A kind of thing that the file lists, and how many of it."""

    name: str
    length: int
    properties: tuple[Property, ...]


class Lists(NamedTuple):
    """A list for each element: how long each is, and the numbers of all one after the other."""

    counts: Integers
    values: Numbers


class Data(NamedTuple):
    """Data of the elements of one kind in a file, by the names of properties."""

    numbers: dict[str, Numbers]
    lists: dict[str, Lists]


def read_bytes(data: bytes, order: str, start: int, elements: Sequence[Element]) -> dict[str, Data]:
    """Return elements that begin at a byte of a file, by their names; `order` is "<" or ">".

    Raises
    ------
    ValueError
        If the file is cut short.
    """
    return _read(_Octets(data, order, start), elements)


def read_text(text: bytes, elements: Sequence[Element]) -> dict[str, Data]:
    """Return the elements of a `plain_text`, by their names.

    Its numbers may stand in any lines. A text that has more numbers than its elements is read line by line
    instead, if it has a line for each element.

    Raises
    ------
    ValueError
        If the text is cut short, or has a word that is not a number.
    """
    cells = _Words(text)
    try:
        found = _read(cells, elements)
    except ValueError as error:
        by_line = _by_line(cells, elements)
        if by_line is None:
            raise error
        return by_line
    if cells.at == cells.size:
        return found
    return _by_line(cells, elements) or found


class _Octets:
    """The body of a file of bytes; a cell is a byte."""

    def __init__(self, data: bytes, order: str, start: int) -> None:
        self.data, self.order, self.at, self.size = data, order, start, len(data)

    def width(self, kind: str) -> int:
        """Return how many cells a number takes."""
        return int(kind[1:])

    def reader(self, kind: str) -> Callable[[int], int]:
        """Return what reads a length."""
        if kind == "u1":
            return self.data.__getitem__
        code = {"i1": "b", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "i8": "q", "u8": "Q"}[kind]
        unpack, data = struct.Struct(self.order + code).unpack_from, self.data
        return lambda at: int(unpack(data, at)[0])

    def rows(self, count: int, stride: int, offset: int, kind: str, length: int) -> Numbers:
        """Return so many numbers of each of `count` rows of equal length."""
        dtype = np.dtype(self.order + kind)
        shape, strides = (count, length), (stride, dtype.itemsize)
        return np.ndarray(shape, dtype, self.data, self.at + offset, strides).astype(kind)

    def take(self, places: Integers, kind: str) -> Numbers:
        """Return the numbers at places."""
        dtype = np.dtype(self.order + kind)
        found = np.empty(len(places), kind)
        for phase in range(dtype.itemsize):
            chosen = places % dtype.itemsize == phase
            if chosen.any():
                held = (self.size - phase) // dtype.itemsize
                found[chosen] = np.frombuffer(self.data, dtype, held, phase)[places[chosen] // dtype.itemsize]
        return found

    def trouble(self) -> str:
        """Return why there are no more cells."""
        return f"the file has {self.size} bytes"


class _Words:
    """The body of a file of text; a cell is a number."""

    def __init__(self, text: bytes) -> None:
        self.text, self.values, self.at = text, leading_numbers(text), 0
        self.size = len(self.values)

    def width(self, kind: str) -> int:
        """Return how many cells a number takes."""
        return 1

    def reader(self, kind: str) -> Callable[[int], int]:
        """Return what reads a length."""
        view: Any = memoryview(self.values)  # type: ignore[arg-type]

        def read(at: int) -> int:
            value = view[at]
            if not value.is_integer():
                raise ValueError(f"{value:g} is not a valid list length")
            return int(value)

        return read

    def rows(self, count: int, stride: int, offset: int, kind: str, length: int) -> Numbers:
        """Return so many numbers of each of `count` rows of equal length."""
        rows = self.values[self.at : self.at + count * stride].reshape(count, stride)
        return _typed(rows[:, offset : offset + length], kind)

    def take(self, places: Integers, kind: str) -> Numbers:
        """Return the numbers at places."""
        return _typed(self.values[places], kind)

    def trouble(self) -> str:
        """Return why there are no more cells."""
        word = word_at(self.text, self.size)
        if word is None:
            return f"its body ends after {self.size} numbers"
        return f"word {self.size + 1} of its body is {word}, which is not a number"


def _typed(values: Numbers, kind: str) -> Numbers:
    """Return numbers of text as their type has them, or as they are if they do not fit it."""
    if kind.startswith("f"):
        with np.errstate(over="ignore"):
            return values.astype(kind)
    limits = np.iinfo(kind)
    fits = (values >= limits.min) & (values <= limits.max) & (values % 1 == 0)
    return values.astype(kind) if fits.all() else values


_Cells: TypeAlias = _Octets | _Words


def _read(cells: _Cells, elements: Sequence[Element]) -> dict[str, Data]:
    return {element.name: _element(cells, element) for element in elements}


def _element(cells: _Cells, element: Element) -> Data:
    """Return all of one element, and leave the cells behind it."""
    least = sum(cells.width(p.count_type or p.type) for p in element.properties)
    if element.length * least > cells.size - cells.at:
        raise ValueError(_cut(cells, element))
    lengths = _first_lengths(cells, element) if element.length else [0] * len(element.properties)
    data = _alike(cells, element, lengths)
    if data is None:
        starts, counts = _scanned(cells, element)
        data = _gathered(cells, element, starts, counts)
    return data


def _cut(cells: _Cells, element: Element) -> str:
    return f"it is cut short: it has {element.length} of {element.name} by its header, and {cells.trouble()}"


def _first_lengths(cells: _Cells, element: Element) -> list[int]:
    """Return how many numbers each property of the first element has."""
    lengths, at = [], cells.at
    for one in element.properties:
        if one.count_type is None:
            lengths.append(1)
        else:
            lengths.append(_length(cells, element, one, at))
            at += cells.width(one.count_type)
        at += lengths[-1] * cells.width(one.type)
    return lengths


def _length(cells: _Cells, element: Element, one: Property, at: int) -> int:
    assert one.count_type is not None
    try:
        length = cells.reader(one.count_type)(at)
    except (IndexError, struct.error):
        raise ValueError(_cut(cells, element)) from None
    if length < 0:
        raise ValueError(f"a {element.name} has a list of {length} numbers")
    return length


def _alike(cells: _Cells, element: Element, lengths: list[int]) -> Data | None:
    """Return the element if each of its lists is as long in all rows, else None."""
    count = element.length
    numbers: dict[str, Numbers] = {}
    lists: dict[str, Lists] = {}
    widths = [cells.width(p.type) * n for p, n in zip(element.properties, lengths, strict=True)]
    heads = [0 if p.count_type is None else cells.width(p.count_type) for p in element.properties]
    stride = sum(widths) + sum(heads)
    if cells.at + stride * count > cells.size:
        return None
    at = 0
    for one, length, width, head in zip(element.properties, lengths, widths, heads, strict=True):
        if one.count_type is not None and (cells.rows(count, stride, at, one.count_type, 1) != length).any():
            return None
        rows = cells.rows(count, stride, at + head, one.type, length)
        if one.count_type is None:
            numbers[one.name] = rows.reshape(-1)
        else:
            lists[one.name] = Lists(np.full(count, length), rows.reshape(-1))
        at += head + width
    cells.at += stride * count
    return Data(numbers, lists)


def _scanned(cells: _Cells, element: Element) -> tuple[Integers, dict[str, Integers]]:
    """Return where each row begins, and how long each list is in it, and leave the cells behind the last."""
    steps: list[tuple[int, Callable[[int], int], int, list[int]]] = []
    counts: dict[str, list[int]] = {}
    # Number of cells between one list length and the next.
    fixed = 0
    for one in element.properties:
        if one.count_type is None:
            fixed += cells.width(one.type)
        else:
            own = counts.setdefault(one.name, [])
            steps.append((fixed, cells.reader(one.count_type), cells.width(one.type), own))
            fixed = cells.width(one.count_type)
    at, starts = cells.at, []
    try:
        for _ in range(element.length):
            starts.append(at)
            for before, read, width, own in steps:
                at += before
                length = read(at)
                at += length * width
                own.append(length)
            at += fixed
    except (IndexError, struct.error):
        raise ValueError(_cut(cells, element)) from None
    if (least := min((min(own) for own in counts.values() if own), default=0)) < 0:
        raise ValueError(f"a {element.name} has a list of {least} numbers")
    if at > cells.size:
        raise ValueError(_cut(cells, element))
    cells.at = at
    return np.array(starts, np.int64), {name: np.array(own, np.int64) for name, own in counts.items()}


def _gathered(cells: _Cells, element: Element, starts: Integers, counts: dict[str, Integers]) -> Data:
    """Return the element whose rows begin at places."""
    numbers: dict[str, Numbers] = {}
    lists: dict[str, Lists] = {}
    at = starts.copy()
    for one in element.properties:
        width = cells.width(one.type)
        if one.count_type is None:
            numbers[one.name] = cells.take(at, one.type)
            at += width
            continue
        at += cells.width(one.count_type)
        own = counts[one.name]
        within = np.arange(own.sum()) - np.repeat(np.cumsum(own) - own, own)
        lists[one.name] = Lists(own, cells.take(np.repeat(at, own) + within * width, one.type))
        at += own * width
    return Data(numbers, lists)


def _by_line(cells: _Words, elements: Sequence[Element]) -> dict[str, Data] | None:
    """Return the elements of a text that has a line for each, with perhaps more in it; None if it has not."""
    lines = lines_of(cells.text)
    rows = np.fromiter((len(line.split()) for line in lines), np.int64, len(lines))
    starts = np.cumsum(rows) - rows
    first, result = 0, {}
    for element in elements:
        last = first + element.length
        if last > len(lines):
            return None
        counts = _lengths_by_line(cells, element, starts[first:last], rows[first:last])
        if counts is None:
            return None
        result[element.name] = _gathered(cells, element, starts[first:last], counts)
        first = last
    return result


def _lengths_by_line(
    cells: _Words, element: Element, starts: Integers, rows: Integers
) -> dict[str, Integers] | None:
    """Return how long each list is in lines that begin at places; None if a line has too few numbers."""
    counts: dict[str, Integers] = {}
    used = np.zeros(len(starts), np.int64)
    if (starts + rows > cells.size).any():
        return None
    for one in element.properties:
        if one.count_type is None:
            used += 1
            continue
        if (used >= rows).any():
            return None
        own = cells.values[starts + used]
        if not ((own >= 0) & (own <= rows)).all() or (own % 1 != 0).any():
            return None
        counts[one.name] = own.astype(np.int64)
        used += 1 + counts[one.name]
    return None if (used > rows).any() else counts
