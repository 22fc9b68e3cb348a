"""OFF files, of text and of bytes (Phillips, Levy, Munzner, "Geomview Manual", 4.2.5).

They are read here since trimesh reads text by lines, takes polygons for fans, and knows no normals.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..io.quiet import refused
from ..shapes.mesh import Mesh
from .elements import Data, Element, Property, read_bytes, read_text
from .look import colored, shares_of
from .polygons import mesh_of_polygons
from .tokens import lines_of, plain_text

Floats = NDArray[np.float64]

# Some programs omit the white space after the keyword, and some the keyword itself.
_KEYWORD = re.compile(rb"\s*((?:ST|C|N|4|n)*OFF|(?:st|c|n|4)*off)")
_BINARY = re.compile(rb"[ \t]*BINARY[^\n]*\n")
_FACE = Property("vertex_indices", "i4", "i4")


class _Kind(NamedTuple):
    """Attributes of vertices, by the letters before OFF."""

    letters: str

    @property
    def dimensions(self) -> int:
        """Number of coordinates; the fourth is the divisor of the others."""
        return 4 if "4" in self.letters else 3

    def properties(self, colors: int, kind: str = "f8") -> tuple[Property, ...]:
        """Return the properties of a vertex, in the order of the file."""
        names = list("xyzw"[: self.dimensions])
        names += ["nx", "ny", "nz"] if "N" in self.letters else []
        names += ["red", "green", "blue", "alpha"][:colors] if "C" in self.letters else []
        names += ["u", "v"] if "S" in self.letters else []
        return tuple(Property(name, kind) for name in names)


def read_off(path: Path) -> tuple[Mesh, ...]:
    """Read an OFF file as one mesh, with normals, texture coordinates and colors of vertices.

    Vertices and faces are those of the file, in its order; polygons as in `triangulate`. Colors of faces are
    left out.

    Raises
    ------
    ValueError
        If it is none that can be read.
    """
    try:
        return (_mesh(path),)
    except Exception as error:
        raise refused(path, "mesh", error) from error


def _mesh(path: Path) -> Mesh:
    elements, kind = _elements(path.read_bytes())
    vertices, polygons = elements["vertex"].numbers, elements["face"].lists[_FACE.name]

    def columns(*names: str) -> Floats | None:
        found = [vertices[name].astype(np.float64) for name in names if name in vertices]
        return np.stack(found, axis=1) if len(found) == len(names) else None

    points = columns("x", "y", "z")
    assert points is not None
    if kind.dimensions == 4:
        with np.errstate(all="ignore"):
            points = points / vertices["w"].astype(np.float64)[:, None]
    with np.errstate(invalid="ignore"):
        corners = polygons.values.astype(np.int64)
    outside = (corners < 0) | (corners >= len(points))
    if outside.any():
        raise ValueError(f"a face has vertex {corners[outside][0]}, but there are {len(points)} vertices")
    colors = columns("red", "green", "blue")
    # Colors are taken as sRGB.
    look = colored(None if colors is None else shares_of(colors))
    normals, uv = columns("nx", "ny", "nz"), columns("u", "v")
    looks: dict[str, Any] = {"material": look.material, "colors": look.colors, "name": path.name}
    return mesh_of_polygons(points, corners, polygons.counts, normals=normals, uv=uv, **looks)


def _elements(data: bytes) -> tuple[dict[str, Data], _Kind]:
    """Return the vertices and faces of a file, and the attributes of vertices."""
    keyword = _KEYWORD.match(data)
    binary = _BINARY.match(data, keyword.end()) if keyword else None
    if keyword and binary:
        kind = _Kind(_letters(keyword[1]))
        return _binary(data, binary.end(), kind), kind
    text = re.sub(rb"#[^\n]*", b"", plain_text(data))
    keyword = _KEYWORD.match(text)
    kind = _Kind(_letters(keyword[1]) if keyword else "")
    if "n" in kind.letters:
        raise ValueError("vertices of any number of dimensions (nOFF) are not read")
    body = text[keyword.end() :] if keyword else text
    vertices, faces, body = _counts(body)
    troubles = []
    for colors in _colors(body, kind):
        elements = (
            Element("vertex", vertices, kind.properties(colors)),
            Element("face", faces, (_FACE,)),
        )
        try:
            return read_text(body, elements), kind
        except ValueError as error:
            troubles.append(error)
    raise troubles[0]


def _letters(keyword: bytes) -> str:
    letters = keyword.decode()[:-3]
    return letters if keyword.endswith(b"OFF") else letters.upper()


def _counts(body: bytes) -> tuple[int, int, bytes]:
    """Return the numbers of vertices and faces, and the rest; the number of edges may be missing."""
    words = re.match(rb"\s*(\S+)\s+(\S+)", body)
    if words is None or not all(re.fullmatch(rb"\d{1,18}", word) for word in words.groups()):
        raise ValueError("it has no counts of vertices and faces")
    rest = body[words.end() :]
    edges = re.match(rb"\s*(\S+)", rest)
    first = lines_of(body)[0].split()
    # Two counts alone in a line are complete, unless a third stands alone below.
    if len(first) == 2 and edges is not None:
        below = rest[: rest.find(b"\n", edges.end())] if b"\n" in rest[edges.end() :] else rest
        edges = edges if len(below.split()) == 1 else None
    return int(words[1]), int(words[2]), rest[edges.end() :] if edges else rest


def _colors(body: bytes, kind: _Kind) -> tuple[int, ...]:
    """Return how many numbers a color may have: four by the definition, but three in many files."""
    if "C" not in kind.letters:
        return (0,)
    first = re.match(rb"\s*([^\n]*)", body)
    words = len(first[1].split()) if first else 0
    return (3, 4) if words == len(kind.properties(3)) else (4, 3)


def _binary(data: bytes, start: int, kind: _Kind) -> dict[str, Data]:
    """Return the elements of a file of bytes, whose faces have any number of colors each."""
    if len(data) < start + 12:
        raise ValueError("it has no counts of vertices and faces")
    vertices, faces = (int(n) for n in np.frombuffer(data, ">i4", 2, start))
    if min(vertices, faces) < 0:
        raise ValueError(f"it has {vertices} vertices and {faces} faces by its header")
    elements = (
        Element("vertex", vertices, kind.properties(4, "f4")),
        Element("face", faces, (_FACE, Property("colors", "f4", "i4"))),
    )
    return read_bytes(data, ">", start + 12, elements)
