"""Headers of PLY files (Turk, "The PLY Polygon File Format", 1994): elements, and the properties of each."""

from __future__ import annotations

import re
from typing import NamedTuple

from ..elements import Element, Property

_MOST_HEADER = 2**20
_END = re.compile(rb"(?:^|[\r\n])[ \t]*end_header[ \t]*(\r\n|\r|\n|\Z)")
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("long", "int64"), "i8"),
    **dict.fromkeys(("ulong", "uint64"), "u8"),
    "float16": "f2",
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}


class Header(NamedTuple):
    """The header of a PLY file.

    Attributes
    ----------
    order : str
        "<" or ">" for the order of bytes, "" for text.
    elements : tuple of Element
        In the order of the file.
    pictures : tuple of str
        Names of its textures.
    end : int
        The byte where its elements begin.
    """

    order: str
    elements: tuple[Element, ...]
    pictures: tuple[str, ...]
    end: int


def read_header(data: bytes) -> Header:
    """Return the header of a PLY file.

    Raises
    ------
    ValueError
        If there is none, or it is broken.
    """
    found = _END.search(data, 0, _MOST_HEADER)
    if data[:3].lower() != b"ply" or found is None:
        raise ValueError("it has no header of a PLY")
    end = found.end()
    # If carriage returns alone end lines, a line feed after the last one belongs to the body.
    first = re.search(rb"\r\n|\r|\n", data)
    if found[1] == b"\r\n" and first is not None and first[0] == b"\r":
        end -= 1
    order: str | None = None
    pictures: list[str] = []
    elements: list[tuple[str, int, list[Property]]] = []
    for line in re.split(rb"[\r\n]+", data[: found.start()]):
        words = line.decode("utf-8", "replace").split()
        kind = words[0].lower() if words else ""
        if kind == "format" and len(words) > 1:
            order = _ORDERS.get(words[1].lower())
            if order is None:
                raise ValueError(f"its format is {words[1][:20]!r}, expected one of {', '.join(_ORDERS)}")
        elif kind == "element" and len(words) == 3:
            elements.append((words[1], _count(words[2]), []))
        elif kind == "property" and len(words) >= 3 and elements:
            elements[-1][2].append(_property(words))
        elif kind == "comment" and len(words) > 2 and words[1].lower() == "texturefile":
            pictures.append(" ".join(words[2:]))
    if order is None:
        raise ValueError("its header has no format")
    made = tuple(Element(name, count, tuple(properties)) for name, count, properties in elements)
    return Header(order, made, tuple(pictures), end)


def _property(words: list[str]) -> Property:
    types = words[1:-1]
    is_list = types[0].lower() == "list" and len(types) == 3
    for name in types[1:] if is_list else types:
        if name.lower() not in _TYPES:
            raise ValueError(f"property {words[-1][:20]!r} has type {name[:20]!r}, which is none of PLY")
    kinds = [_TYPES[name.lower()] for name in (types[1:] if is_list else types)]
    if is_list and kinds[0].startswith("f"):
        raise ValueError(
            f"the length of list {words[-1][:20]!r} has type {types[1]!r}, expected an integer type"
        )
    return Property(words[-1], kinds[1], kinds[0]) if is_list else Property(words[-1], kinds[0])


def _count(text: str) -> int:
    # Longer numbers are not counts, and slow to parse.
    if not re.fullmatch(r"\d{1,18}", text, re.ASCII):
        raise ValueError(f"{text[:20]!r} is not a valid count")
    return int(text)
