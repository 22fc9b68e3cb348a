"""Whether mesh files hold as much as they say, found out before trimesh believes them."""

import re
from itertools import islice
from pathlib import Path
from typing import BinaryIO

_STL_HEAD, _STL_FACE = 84, 50
_MOST_HEADER = 2**20


def check_mesh_file(path: Path) -> None:
    """Refuse a PLY, an STL or an OFF that is cut short, or says that it holds what it does not.

    Files of other kinds do not say how much they hold.

    Raises
    ------
    ValueError
        If it is.
    """
    kinds = {".ply": _ply, ".stl": _stl, ".stl_ascii": _stl, ".off": _off}
    check = kinds.get(path.suffix.lower())
    if check is not None:
        with path.open("rb") as file:
            check(file)


def _ply(file: BinaryIO) -> None:
    """Check the lines of a PLY of text, one an element; those of numbers trimesh checks by their length."""
    data = file.read(_MOST_HEADER)
    end = re.search(rb"^end_header[^\n]*\n", data, re.MULTILINE)
    if data[:3].lower() != b"ply" or end is None:
        raise ValueError("it has no header of a PLY")
    head = data[: end.start()]
    elements = {
        name.decode("latin-1"): _count(count)
        for name, count in re.findall(rb"^element[ \t]+(\S+)[ \t]+(\S+)", head, re.MULTILINE)
    }
    if re.search(rb"^format[ \t]+ascii", head, re.MULTILINE) is None:
        return
    body = data[end.end() :] + file.read()
    held = body.count(b"\n") + (not body.endswith(b"\n"))
    if held < sum(elements.values()):
        told = ", ".join(f"{count} of {name}" for name, count in elements.items())
        raise ValueError(f"it has {told} by its header, and {held} lines")
    if re.search(rb"^element[ \t]+face\b[^\n]*\n\s*property[ \t]+list\b", head, re.MULTILINE):
        before = list(elements)[: list(elements).index("face")]
        _check_lists(body.splitlines(), sum(elements[name] for name in before), elements["face"])


def _check_lists(lines: list[bytes], first: int, count: int) -> None:
    """Check that lists are as long as they say."""
    for number, line in enumerate(islice(lines, first, first + count)):
        words = line.split()
        if not words or _count(words[0]) >= len(words):
            raise ValueError(f"face {number} has fewer corners than it says")


def _stl(file: BinaryIO) -> None:
    """Check the length of an STL of numbers, and that the facets of one of text end."""
    head = file.read(_STL_HEAD)
    size = file.seek(0, 2)
    count = int.from_bytes(head[80:84], "little")
    if size == _STL_HEAD + _STL_FACE * count:
        return
    if head.lstrip()[:5].lower() != b"solid":
        if size < _STL_HEAD:
            raise ValueError(f"it is cut short: an STL has at least {_STL_HEAD} bytes, and it has {size}")
        held = (size - _STL_HEAD) // _STL_FACE
        raise ValueError(f"it has {count} faces by its header, and room for {held}")
    file.seek(0)
    text = file.read().lower()
    begun, ended = len(re.findall(rb"\bfacet\s+normal\b", text)), len(re.findall(rb"\bendfacet\b", text))
    if begun != ended or re.search(rb"\bendsolid\b", text) is None:
        raise ValueError(f"it is cut short: {begun} facets begin and {ended} end, and the solid does not end")


def _off(file: BinaryIO) -> None:
    """Check the lines of an OFF: one a vertex, and one a face."""
    lines = [line for line in (full.split(b"#")[0].split() for full in file) if line]
    if lines and lines[0][0].upper() in (b"OFF", b"COFF"):
        lines[0] = lines[0][1:]
        lines = lines if lines[0] else lines[1:]
    if not lines or len(lines[0]) < 2:
        raise ValueError("it has no counts of vertices and faces")
    vertices, faces = map(_count, lines[0][:2])
    if len(lines) - 1 < vertices + faces:
        told = f"{vertices} vertices and {faces} faces"
        raise ValueError(f"it has {told} by its header, and {len(lines) - 1} lines")
    _check_lists([b" ".join(line) for line in lines[1:]], vertices, faces)


def _count(text: bytes) -> int:
    # Longer ones are no counts, and slow to read.
    if not re.fullmatch(rb"\d{1,18}", text):
        raise ValueError(f"{text[:20].decode('latin-1')!r} is no count")
    return int(text)
