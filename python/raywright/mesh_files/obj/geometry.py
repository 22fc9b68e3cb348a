"""Triangles of an OBJ file, by their materials, in the order of the file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import compress
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...io.quiet import quiet
from ..corners import distinct
from ..triangulation import polygon_of, triangulate
from .text import name_of, told

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_BACK = re.compile(rb"-[0-9]{1,18}")
# By form: corners with more slashes than none, one or two.
_MORE = [re.compile(rb"/" + rb"[^\s/]*/" * count) for count in range(3)]


class Part(NamedTuple):
    """The triangles of one material.

    Attributes
    ----------
    material : str, optional
        Its name; None for parts before the first name.
    vertices : (V, 3) array
    faces : (F, 3) array
        In the order of the file; polygons as in `triangulate`.
    normals, uv, colors : (V, 3), (V, 2), (V, 3) array, optional
        Those of the vertices. Colors are numbers as they stand there.
    cells : (F,) array, optional
        Index of each one's face in the file; None if they are the same.
    """

    material: str | None
    vertices: Floats
    faces: Integers
    normals: Floats | None = None
    uv: Floats | None = None
    colors: Floats | None = None
    cells: Integers | None = None


class Geometry:
    """Vertices of an OBJ file, and its faces.

    Parameters
    ----------
    text : bytes
        The file, as in `text_of`.
    whole : bool
        True if all faces are one part, whatever their materials.

    Attributes
    ----------
    libraries : list of bytes
        Names of material files, in the order of the file.
    lost : tuple of str
        Features that are not supported, for a warning.

    Raises
    ------
    ValueError
        If it is not a text file, a number cannot be read, or a face has a vertex that is not there.
    """

    def __init__(self, text: bytes, whole: bool = False) -> None:
        if b"\0" in text:
            raise ValueError("it is not a text file")
        tables: dict[bytes, list[bytes]] = {b"v": [], b"vt": [], b"vn": []}
        self.libraries: list[bytes] = []
        self._faces: dict[str | None, list[bytes]] = {}
        # Start of each run of faces of one material, among all faces of that material.
        self._runs: list[tuple[str | None, int]] = [(None, 0)]
        name: str | None = None
        faces: list[bytes] | None = None
        for line in text.split(b"\n"):
            word, _, rest = line.partition(b" ")
            if not word:
                word, _, rest = line.lstrip().partition(b" ")
            if word in (b"f", b"fo"):
                if faces is None:
                    faces = self._faces.setdefault(name, [])
                faces.append(_forwards(rest, tables) if b"-" in rest else rest)
            elif word in tables:
                tables[word].append(rest)
            elif word == b"usemtl" and not whole:
                name = name_of(rest) or None
                faces = self._faces.get(name)
                self._runs.append((name, len(faces or ())))
            elif word == b"mtllib":
                self.libraries.append(rest)
        points = _table(tables[b"v"], "vertices", 3)
        self._points = points[:, :3]
        self._colors = points[:, 3:6] if points.shape[1] >= 6 else None
        uv = _table(tables[b"vt"], "texture coordinates", 1)
        # Rows of one number belong to curves, or to pictures one pixel high.
        self._uv = uv[:, :2] if uv.shape[1] > 1 else np.column_stack([uv, np.zeros_like(uv)])
        self._normals = _table(tables[b"vn"], "normals", 3)[:, :3]
        self.lost: tuple[str, ...] = ()

    def parts(self) -> Iterator[Part]:
        """Yield the triangles of each material, in the order of their first faces."""
        numbers = self._numbers()
        for name, lines in self._faces.items():
            kept, counts, corners = _corners(lines)
            if len(counts):
                yield self._part(name, counts, corners, numbers[name][kept])

    def _numbers(self) -> dict[str | None, Integers]:
        """Return which faces of the file those of each material are."""
        ends = {name: len(lines) for name, lines in self._faces.items()}
        runs: dict[str | None, list[int]] = {}
        lengths = []
        for name, start in reversed(self._runs):
            lengths.append(max(ends.get(name, 0) - start, 0))
            ends[name] = start
        first = 0
        for (name, _), length in zip(self._runs, reversed(lengths), strict=True):
            runs.setdefault(name, []).extend((first, length))
            first += length
        return {
            name: np.concatenate([np.arange(a, a + n) for a, n in zip(own[::2], own[1::2], strict=True)])
            for name, own in runs.items()
        }

    def _part(self, name: str | None, counts: Integers, corners: Integers, numbers: Integers) -> Part:
        cells = numbers[polygon_of(counts)]
        is_plain = np.array_equal(cells, np.arange(len(cells)))
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
        used, place = distinct(columns)
        return Part(
            name,
            self._points[point[used]],
            place[triangulate(self._points, point, counts)],
            self._normals[normal[used]] if has_normals else None,
            # Corners without coordinates get (0, 0).
            np.where(uv[used, None] < 0, 0.0, self._uv[uv[used]]) if has_uv else None,
            None if self._colors is None else self._colors[point[used]],
            None if is_plain else cells,
        )

    def _lose(self, what: str) -> None:
        if what not in self.lost:
            self.lost = (*self.lost, what)


def _table(lines: list[bytes], what: str, least: int) -> Floats:
    """Return the numbers of lines, as many columns as each of them has."""
    if not lines:
        return np.empty((0, least))
    lines = _uncommented(lines)
    counts = np.fromiter((len(line.split()) for line in lines), np.int64, len(lines))
    columns = int(counts.min())
    if columns < least:
        line = told(name_of(lines[int(counts.argmin())]))
        raise ValueError(f"{what} must have shape (N, {least}), and one is {line}")
    numbers = _numbers(b" ".join(lines), np.float64)
    if len(numbers) != counts.sum():
        raise ValueError(f"{what} have {_no_number(lines)}, which is not a number")
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


def _corners(lines: list[bytes]) -> tuple[NDArray[np.bool_], Integers, Integers]:
    """Return the faces with three corners or more, their numbers of corners, and the indices of each corner.

    The last is (C, 3), 0 where nothing.
    """
    lines = _uncommented(lines)
    counts = np.fromiter((len(line.split()) for line in lines), np.int64, len(lines))
    kept = counts >= 3
    if not kept.all():
        lines, counts = list(compress(lines, kept)), counts[kept]
    slashes = np.fromiter((line.count(b"/") for line in lines), np.int64, len(lines))
    result = np.zeros((int(counts.sum()), 3), np.int64)
    # Usually all corners of a face have one form, with none, one or two slashes; other faces are parsed one
    # by one.
    forms = np.where(slashes % counts == 0, slashes // counts, 3)
    for form in np.unique(forms):
        chosen = forms == form
        rows = np.repeat(chosen, counts)
        text = b" ".join(compress(lines, chosen))
        # If no corner has too many numbers and the total is right, each corner has the right number.
        alike = form < 3 and _MORE[int(form)].search(text) is None
        found = _numbers(text.replace(b"//", b"/0/").replace(b"/", b" "), np.int64) if alike else ()
        columns = int(form) + 1
        if alike and len(found) == rows.sum() * columns:
            result[rows, :columns] = np.reshape(found, (-1, columns))
        else:
            result[rows] = [_corner(word) for word in text.split()]
    return kept, counts, result


def _corner(word: bytes) -> tuple[int, int, int]:
    """Return what a corner refers to, such as ``1``, ``1/2``, ``1//3`` or ``1/2/3``."""
    try:
        point, uv, normal = (int(part or b"0") for part in (*word.split(b"/"), b"", b"")[:3])
        if word.count(b"/") > 2 or max(abs(point), abs(uv), abs(normal)) >= 2**63:
            raise ValueError
    except ValueError:
        raise ValueError(f"a face has corner {told(word.decode('utf-8', 'replace'))}") from None
    return point, uv, normal


def _within(index: Integers, table: Floats, least: int) -> bool:
    return bool((index >= least).all() and (index < len(table)).all())


def _forwards(rest: bytes, tables: dict[bytes, list[bytes]]) -> bytes:
    """Return the corners of a face counted from the first vertex on, none back from where it stands."""

    def corner(word: bytes) -> bytes:
        parts = word.split(b"/")
        for i, (part, table) in enumerate(zip(parts, tables.values(), strict=False)):
            back = int(part[1:]) if _BACK.fullmatch(part) else 0
            # An index before the first entry stays relative, and is reported as out of bounds later.
            if 0 < back <= len(table):
                parts[i] = b"%d" % (len(table) + 1 - back)
        return b"/".join(parts)

    return b" ".join(map(corner, rest.split(b"#")[0].split()))
