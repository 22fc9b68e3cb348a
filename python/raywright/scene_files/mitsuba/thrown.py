"""Textures as pictures that lights throw: what they are at given coordinates."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .plugin import Plugin
from .textures import linear_colors, picture
from .values import UNIFORM, color, of_plugin

Floats = NDArray[np.float64]


def size_of(plugin: Plugin) -> tuple[int, int]:
    """Return the width and the height of a texture in points: one if it is not a picture."""
    if plugin.type != "bitmap":
        return 1, 1
    array = picture(plugin)[0]
    return array.shape[1], array.shape[0]


def at(plugin: Plugin, u: Floats, v: Floats) -> Floats:
    """Return the colors of a texture at coordinates as in Mitsuba, (..., 3), and take it.

    Raises
    ------
    ValueError
        If its type, or a parameter of it, is not supported; the error names it.
    """
    if plugin.type in UNIFORM:
        return np.broadcast_to(of_plugin(plugin, True), (*u.shape, 3))
    if plugin.type not in ("bitmap", "checkerboard"):
        plugin.fail("this kind of texture is not supported in what a light throws")
    matrix = plugin.to_uv()
    x, y = (matrix[row, 0] * u + matrix[row, 1] * v + matrix[row, 2] for row in range(2))
    if plugin.type == "checkerboard":
        a, b = (color(plugin, name, default) for name, default in (("color0", 0.4), ("color1", 0.2)))
        plugin.done()
        same = (x - np.floor(x) > 0.5) == (y - np.floor(y) > 0.5)
        return np.where(same[..., None], a, b)
    colors = linear_colors(*picture(plugin))
    nearest = plugin.choice("filter_type", "bilinear", ("bilinear", "nearest")) == "nearest"
    wrap = plugin.choice("wrap_mode", "repeat", ("repeat", "mirror", "clamp"))
    plugin.ignore("format", "accel")
    plugin.done()
    height, width = colors.shape[:2]
    x, y = x * width, y * height
    if nearest:
        return colors[_wrapped(np.floor(y), height, wrap), _wrapped(np.floor(x), width, wrap)]
    left, top = np.floor(x - 0.5), np.floor(y - 0.5)
    across, down = (x - 0.5 - left)[..., None], (y - 0.5 - top)[..., None]
    columns = [_wrapped(left + k, width, wrap) for k in range(2)]
    rows = [_wrapped(top + k, height, wrap) for k in range(2)]
    above, below = (colors[row, columns[0]] * (1 - across) + colors[row, columns[1]] * across for row in rows)
    return np.asarray(above * (1 - down) + below * down)


def _wrapped(at: Any, count: int, wrap: str) -> NDArray[np.int64]:
    """Return which point of a row is at a place beyond its ends."""
    place = at.astype(np.int64)
    if wrap == "clamp":
        return np.asarray(np.clip(place, 0, count - 1))
    if wrap == "mirror":
        place = np.mod(place, 2 * count)
        return np.asarray(np.minimum(place, 2 * count - 1 - place))
    return np.asarray(np.mod(place, count))
