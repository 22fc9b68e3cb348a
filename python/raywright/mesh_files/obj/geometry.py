"""Triangles of an OBJ file, by their materials, in the order of the file."""

import re
from collections.abc import Iterator, Sequence
from itertools import compress
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...io.quiet import quiet
from .text import name_of, told

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_FACE = re.compile(rb"^[ \t]*fo?[ \t]+([^\n]*)", re.MULTILINE)
_MATERIAL = re.compile(rb"^[ \t]*usemtl\b[ \t]*([^\n]*)", re.MULTILINE)
_BACKWARDS = re.compile(rb"^[ \t]*fo?[ \t][^\n]*-", re.MULTILINE)
_COUNTED = re.compile(rb"^[ \t]*(vt|vn|v|fo?)[ \t]+[^\n]*", re.MULTILINE)
# Corners with more slashes than none, one or two.
_MORE = [re.compile(rb"/" + rb"[^\s/]*/" * count) for count in range(3)]


class Part(NamedTuple):
    """The triangles of one material.

    Attributes
    ----------
    material : str, optional
        Its name; None of what stands before any is named.
    vertices : (V, 3) array
    faces : (F, 3) array
        In the order of the file; polygons are fans of triangles.
    normals, uv, colors : (V, 3), (V, 2), (V, 3) array, optional
        Those of the vertices. Colours are numbers as they stand there.
    """

    material: str | None
    vertices: Floats
    faces: Integers
    normals: Floats | None = None
    uv: Floats | None = None
    colors: Floats | None = None


class Geometry:
    """What faces of an OBJ file refer to, and the faces.

    Attributes
    ----------
    lost : tuple of str
        What of it cannot be shown, for a warning.

    Raises
    ------
    ValueError
        If it is no text, a number cannot be read, or a face has a vertex that is not there.
    """

    def __init__(self, text: bytes) -> None:
        if b"\0" in text:
            raise ValueError("it is no text")
        if _BACKWARDS.search(text):
            text = _forwards(text)
        points = _table(text, b"v", "vertices", 3)
        self._points = points[:, :3]
        self._colors = points[:, 3:6] if points.shape[1] >= 6 else None
        uv = _table(text, b"vt", "texture coordinates", 1)
        # Those of one number are of curves, and of pictures one point high.
        self._uv = uv[:, :2] if uv.shape[1] > 1 else np.column_stack([uv, np.zeros_like(uv)])
        self._normals = _table(text, b"vn", "normals", 3)[:, :3]
        self._text = text
        self.lost: tuple[str, ...] = ()

    def parts(self, whole: bool = False) -> Iterator[Part]:
        """Yield the triangles of each material, in the order in which they come first; `whole`, of all."""
        for name, lines in _by_material(self._text, whole).items():
            counts, corners = _corners(lines)
            if len(counts):
                yield self._part(name, _fans(counts), corners)

    def _part(self, name: str | None, faces: Integers, corners: Integers) -> Part:
        point, uv, normal = corners.T - 1
        outside = (corners[:, 0] < 1) | (corners[:, 0] > len(self._points))
        if outside.any():
            first = int(corners[outside, 0][0])
            raise ValueError(f"a face has vertex {first}, out of bounds: there are {len(self._points)}")
        has_uv, has_normals = bool((uv != -1).any()), bool((normal != -1).all())
        if has_uv and not _within(uv, self._uv, -1):
            has_uv = False
            self._lose("texture coordinates")
        if has_normals and not _within(normal, self._normals, 0):
            has_normals = False
            self._lose("normals")
        columns = [point, *([uv] if has_uv else []), *([normal] if has_normals else [])]
        used, place = _distinct(columns)
        return Part(
            name,
            self._points[point[used]],
            place[faces],
            self._normals[normal[used]] if has_normals else None,
            # Corners without any share the first corner of pictures.
            np.where(uv[used, None] < 0, 0.0, self._uv[uv[used]]) if has_uv else None,
            None if self._colors is None else self._colors[point[used]],
        )

    def _lose(self, what: str) -> None:
        if what not in self.lost:
            self.lost = (*self.lost, what)


def _by_material(text: bytes, whole: bool) -> dict[str | None, list[bytes]]:
    """Return the lines of faces, without their keyword, by the material that they name."""
    if whole:
        return {None: _FACE.findall(text)}
    found: dict[str | None, list[bytes]] = {}
    pieces = _MATERIAL.split(text)
    names = [None, *(name_of(piece) or None for piece in pieces[1::2])]
    for name, piece in zip(names, pieces[::2], strict=True):
        if lines := _FACE.findall(piece):
            found.setdefault(name, []).extend(lines)
    return found


def _table(text: bytes, keyword: bytes, what: str, least: int) -> Floats:
    """Return the numbers of all lines of a keyword, as many columns as each of them has."""
    lines = re.findall(rb"^[ \t]*" + keyword + rb"[ \t]+([^\n]*)", text, re.MULTILINE)
    if not lines:
        return np.empty((0, least))
    lines = _uncommented(lines)
    counts = np.fromiter((len(line.split()) for line in lines), np.int64, len(lines))
    columns = int(counts.min())
    if columns < least:
        line = told(lines[int(counts.argmin())].decode("utf-8", "replace"))
        raise ValueError(f"{what} must have shape (N, {least}), and one is {line}")
    numbers = _numbers(b" ".join(lines), np.float64)
    if len(numbers) != counts.sum():
        raise ValueError(f"{what} have {_no_number(lines)}, which is no number")
    first = np.cumsum(counts) - counts
    return np.asarray(numbers[first[:, np.newaxis] + np.arange(columns)], np.float64)


def _numbers(text: bytes, dtype: Any) -> NDArray[Any]:
    """Return the numbers of a text as far as it is of numbers."""
    try:
        with quiet():
            return np.fromstring(text, dtype, sep=" ")
    except ValueError:
        return np.empty(0, dtype)


def _no_number(lines: Sequence[bytes]) -> str:
    for word in b" ".join(lines).split():
        try:
            float(word)
        except ValueError:
            return told(word.decode("utf-8", "replace"))
    return "something"


def _uncommented(lines: list[bytes]) -> list[bytes]:
    return [line.split(b"#")[0] for line in lines] if any(b"#" in line for line in lines) else lines


def _corners(lines: list[bytes]) -> tuple[Integers, Integers]:
    """Return how many corners each face has, and what each corner refers to: (C, 3), 0 where nothing."""
    lines = _uncommented(lines)
    counts = np.fromiter((len(line.split()) for line in lines), np.int64, len(lines))
    if (counts < 3).any():
        lines, counts = list(compress(lines, counts >= 3)), counts[counts >= 3]
    slashes = np.fromiter((line.count(b"/") for line in lines), np.int64, len(lines))
    result = np.zeros((int(counts.sum()), 3), np.int64)
    # Corners of a face are all of one form, with none, one or two slashes; others are read one by one.
    forms = np.where(slashes % counts == 0, slashes // counts, 3)
    for form in np.unique(forms):
        chosen = forms == form
        rows = np.repeat(chosen, counts)
        text = b" ".join(compress(lines, chosen))
        # As many as there should be in all are as many in each where none has more.
        alike = form < 3 and _MORE[int(form)].search(text) is None
        found = _numbers(text.replace(b"//", b"/0/").replace(b"/", b" "), np.int64) if alike else ()
        columns = int(form) + 1
        if alike and len(found) == rows.sum() * columns:
            result[rows, :columns] = np.reshape(found, (-1, columns))
        else:
            result[rows] = [_corner(word) for word in text.split()]
    return counts, result


def _corner(word: bytes) -> tuple[int, int, int]:
    """Return what a corner refers to, such as ``1``, ``1/2``, ``1//3`` or ``1/2/3``."""
    try:
        point, uv, normal = (int(part or b"0") for part in (*word.split(b"/"), b"", b"")[:3])
        if word.count(b"/") > 2 or max(abs(point), abs(uv), abs(normal)) >= 2**63:
            raise ValueError
    except ValueError:
        raise ValueError(f"a face has corner {told(word.decode('utf-8', 'replace'))}") from None
    return point, uv, normal


def _fans(counts: Integers) -> Integers:
    """Return triangles of polygons, (F, 3): numbers of corners, all polygons counted through."""
    triangles = counts - 2
    owner = np.repeat(np.arange(len(counts)), triangles)
    within = np.arange(len(owner)) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    first = (np.cumsum(counts) - counts)[owner]
    return np.stack([first, first + within + 1, first + within + 2], axis=1)


def _within(index: Integers, table: Floats, least: int) -> bool:
    return bool((index >= least).all() and (index < len(table)).all())


def _distinct(columns: list[Integers]) -> tuple[Integers, Integers]:
    """Return where each distinct row stands first, in the order of points, and which one each row is."""
    key = columns[0]
    for column in columns[1:]:
        # Numbered anew at each step, so that products stay below 2^63.
        _, key = np.unique(key, return_inverse=True)
        key = key.reshape(-1) * (int(column.max()) + 2) + column + 1
    _, first, place = np.unique(key, return_index=True, return_inverse=True)
    return first, place.reshape(-1)


def _forwards(text: bytes) -> bytes:
    """Return a text whose faces count from the first vertex on, and none back from where it stands."""
    counts = {b"v": 0, b"vt": 0, b"vn": 0}

    def corner(word: bytes) -> bytes:
        parts = word.split(b"/")
        for i, (part, count) in enumerate(zip(parts, counts.values(), strict=False)):
            # What is before the first of them stays, and is found out of bounds.
            if part.startswith(b"-") and part[1:].isdigit() and len(part) < 19 and 0 < -int(part) <= count:
                parts[i] = b"%d" % (count + 1 + int(part))
        return b"/".join(parts)

    def line(match: "re.Match[bytes]") -> bytes:
        keyword = match[1]
        if keyword in counts:
            counts[keyword] += 1
            return match[0]
        return b" ".join([b"f", *map(corner, match[0].split()[1:])])

    return _COUNTED.sub(line, text)
