"""Colors and pictures of PLY files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...io.pictures import read
from ...io.quiet import reason, warn_caller
from ...materials import Diffuse
from ...textures import ImageTexture
from ..beside import beside
from ..elements import Data
from ..look import Look, colored

Floats = NDArray[np.float64]

# Names of red, green and blue in use.
_COLORS = (
    ("red", "green", "blue"),
    ("r", "g", "b"),
    ("diffuse_red", "diffuse_green", "diffuse_blue"),
)
_UV = (("u", "v"), ("s", "t"), ("texture_u", "texture_v"), ("texture_s", "texture_t"))


def columns(data: Data | None, *names: tuple[str, ...]) -> Floats | None:
    """Return the properties of the first names that are all there, (N, len(names)); None if none are."""
    found = {} if data is None else {name.lower(): values for name, values in data.numbers.items()}
    for some in names:
        if all(name in found for name in some):
            return np.stack([found[name].astype(np.float64) for name in some], axis=1)
    return None


def coordinates(vertices: Data) -> Floats | None:
    """Return the texture coordinates of vertices."""
    return columns(vertices, *_UV)


def color_shares(data: Data | None) -> Floats | None:
    """Return red, green and blue as shares in sRGB, (N, 3); None if there are none.

    Integers are parts of the most that their type holds, up to 16 bits, or of 255. Floats are shares, unless
    any of them is above 1.
    """
    colors = columns(data, *_COLORS)
    if colors is None or data is None or not len(colors):
        return None
    found = {name.lower(): values.dtype for name, values in data.numbers.items()}
    kinds = {found[name] for names in _COLORS if names[0] in found for name in names if name in found}
    if kinds == {np.dtype("u2")}:
        most = 65535.0
    else:
        has_integers = all(kind.kind in "ui" for kind in kinds)
        most = 255.0 if has_integers or np.nanmax(colors, initial=0.0) > 1 else 1.0
    return np.clip(np.nan_to_num(colors / most), 0, 1)


def look_of(path: Path, elements: dict[str, Data], pictures: tuple[str, ...], has_uv: bool) -> Look:
    """Return the picture of a file if there are coordinates for it, or the colors of vertices or faces.

    Of colors of faces the most frequent one is taken.

    Warns
    -----
    RuntimeWarning
        If its picture is not there, or cannot be read.
    """
    if has_uv and pictures:
        found = beside(path.parent, pictures[-1])
        try:
            if found is not None:
                return Look(Diffuse(ImageTexture(read(found))))
            why = "it is not beside it"
        except ValueError as error:
            why = reason(error)
        warn_caller(f"{path.name}: its picture {pictures[-1]!r} is left out ({why})")
    colors = color_shares(elements.get("vertex"))
    if colors is not None:
        return colored(colors)
    colors = color_shares(elements.get("face"))
    if colors is None:
        return Look()
    rows, counts = np.unique(colors, axis=0, return_counts=True)
    return colored(rows[[counts.argmax()]])
