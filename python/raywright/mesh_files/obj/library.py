"""The materials that an OBJ file names, from the libraries beside it."""

from __future__ import annotations

import re
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..beside import beside
from ..look import Look
from .maps import Pictures
from .material import look_of_mtl
from .mtl import Description, Written, written
from .notes import Notes
from .text import name_of, text_of, told

LOST_FILES = "files of materials are left out"
LOST_MATERIALS = "materials that are in no file beside it are left out"
# More files than any program names, since the reader searches for each.
_MOST = 256
_ONE = re.compile(r"\S.*?\.mtl\b|\S+", re.IGNORECASE)


class Library:
    """The materials of an OBJ file.

    Parameters
    ----------
    path : Path
        The file.
    lines : list of bytes
        Names of its files.
    notes : Notes
        Collects notes about missing files.
    """

    def __init__(self, path: Path, lines: list[bytes], notes: Notes) -> None:
        self._notes = notes
        self._files: list[tuple[Written, Pictures, Notes]] = []
        self._named = False
        # In the order of the file, each once: many programs repeat the name before each object.
        for line in islice(dict.fromkeys(map(name_of, lines)), _MOST):
            self._named = True
            for found in self._found(path, line):
                self._add(found)

    def look(self, name: str | None, span: float | None) -> Look | None:
        """Return how a material looks, None where nothing is said of it; `span` as in `look_of_mtl`."""
        if name is None:
            return None
        for library, pictures, notes in self._files:
            if name in library.materials:
                said = Description(name, library.materials[name], notes, library.blender)
                return look_of_mtl(said, pictures, span)
        if self._files or not self._named:
            self._notes.add(LOST_MATERIALS, told(name))
        return None

    def warn(self) -> None:
        """Warn of all that is not shown as the libraries say."""
        for _, _, notes in self._files:
            notes.warn()

    def _add(self, path: Path) -> None:
        try:
            text = text_of(path.read_bytes())
        except OSError as error:
            self._notes.add(LOST_FILES, f"{told(path.name)} ({error.strerror})")
            return
        self._files.append((written(text), Pictures(path.parent), Notes(path.name)))

    def _found(self, path: Path, line: str) -> list[Path]:
        """Return the files of a line, which may be several, or one with spaces in its name."""
        whole = beside(path.parent, line)
        if whole is not None:
            return [whole]
        files = []
        for name in _ONE.findall(line)[:_MOST]:
            found = beside(path.parent, name)
            if found is None:
                self._notes.add(LOST_FILES, f"{told(name)} (it is not beside it)")
            else:
                files.append(found)
        return files


def span_of(vertices: NDArray[np.float64], faces: NDArray[np.int64], uv: NDArray[np.float64]) -> float:
    """Return the mean length on the surface of 1 in texture coordinates; 0 if it is unknown."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    p, q, r = (uv[faces[:, i]] for i in range(3))
    with np.errstate(all="ignore"):
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        (x, y), (z, w) = (q - p).T, (r - p).T
        share = np.abs(x * w - y * z)
        known = np.isfinite(area) & np.isfinite(share)
        total = float(np.sqrt(area[known].sum() / share[known].sum())) if share[known].any() else 0.0
    return total if np.isfinite(total) else 0.0
