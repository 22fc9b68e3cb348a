"""STL files, of text and of bytes.

They are read here since trimesh refuses what has bytes behind its end, and text whose lines end otherwise.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..io.quiet import refused
from ..shapes.mesh import Mesh
from .tokens import leading_numbers, plain_text
from .triangulation import triangulate

Floats = NDArray[np.float64]

_HEAD = 84
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_WORDS = (b"endfacet", b"endloop", b"facet", b"normal", b"outer", b"loop", b"vertex")
_BEGIN = re.compile(rb"\bfacet\s+normal\b")
_VERTEX = re.compile(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)")


def read_stl(path: Path) -> tuple[Mesh, ...]:
    """Read an STL file: a mesh for each solid, each face with corners of its own.

    Raises
    ------
    ValueError
        If it is none that can be read.
    """
    try:
        solids = list(_solids(path.read_bytes()))
        return tuple(
            Mesh(points, faces, name=name if name and len(solids) > 1 else path.name)
            for name, points, faces in solids
        )
    except Exception as error:
        raise refused(path, "mesh", error) from error


def _solids(data: bytes) -> Iterator[tuple[str, Floats, NDArray[np.int64]]]:
    """Yield the name, corners and faces of each solid."""
    count = int.from_bytes(data[80:_HEAD], "little")
    end = _HEAD + _FACET.itemsize * count
    # Some programs begin binary headers with the keyword of text files.
    if len(data) != end and (data.startswith((b"\xff\xfe", b"\xfe\xff")) or b"\0" not in data[:_HEAD]):
        text = plain_text(data)
        if b"solid" in text.lower():
            yield from _of_text(text)
            return
    if len(data) < _HEAD:
        raise ValueError(f"it is cut short: an STL has at least {_HEAD} bytes, and it has {len(data)}")
    if len(data) < end:
        held = (len(data) - _HEAD) // _FACET.itemsize
        raise ValueError(f"it has {count} faces by its header, and room for {held}")
    points = np.frombuffer(data, _FACET, count, _HEAD)["corners"].reshape(-1, 3).astype(np.float64)
    yield "", points, np.arange(len(points)).reshape(-1, 3)


def _of_text(text: bytes) -> Iterator[tuple[str, Floats, NDArray[np.int64]]]:
    for name, body in _sections(text):
        ended = body.count(b"endfacet")
        begun = body.count(b"facet") - ended
        if begun != ended:
            raise ValueError(f"it is cut short: {begun} facets begin and {ended} end")
        if ended:
            yield (name, *_facets(body, ended))


def _sections(text: bytes) -> Iterator[tuple[str, bytes]]:
    """Yield the name of each solid, and its contents in lower case."""
    lower = text.lower()
    at, name, begin = 0, "", -1
    while (found := lower.find(b"solid", at)) >= 0:
        is_end = lower[max(found - 3, 0) : found] == b"end"
        if begin >= 0:
            yield name, lower[begin : found - 3 if is_end else found]
        line = lower.find(b"\n", found)
        line = len(lower) if line < 0 else line
        # A whole file may stand in one line.
        facet = _BEGIN.search(lower, found, line)
        at = line if facet is None else facet.start()
        begin = -1 if is_end else at
        if not is_end:
            name = " ".join(text[found + 5 : at].decode("utf-8", "replace").split())
    if begin >= 0:
        body = lower[begin:]
        ended = body.count(b"endfacet")
        told = f"{body.count(b'facet') - ended} facets begin and {ended} end, and the solid does not end"
        raise ValueError(f"it is cut short: {told}")


def _facets(body: bytes, count: int) -> tuple[Floats, NDArray[np.int64]]:
    """Return the corners and faces of a solid with so many facets."""
    numbers = leading_numbers(body, _WORDS)
    if len(numbers) == 12 * count:
        points = numbers.reshape(-1, 4, 3)[:, 1:].reshape(-1, 3)
        return points, np.arange(len(points)).reshape(-1, 3)
    # Normals that are not numbers, and facets with more corners.
    found = [_VERTEX.findall(facet) for facet in body.split(b"endfacet")[:count]]
    counts = np.array([len(corners) for corners in found], np.int64)
    points = np.array([corner for corners in found for corner in corners], np.float64).reshape(-1, 3)
    return points, triangulate(points, np.arange(len(points)), counts)
