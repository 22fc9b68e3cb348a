"""Files of curves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .errors import SceneError
from .plugin import Plugin

Floats = NDArray[np.float64]


def read_curves(plugin: Plugin, least: int) -> list[Floats]:
    """Return the control points of a file's curves, each (N, 4), with the radius last.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    ValueError
        If a line is not four finite numbers, or a curve has fewer points than `least`.
    """
    path = plugin.path()
    curves: list[list[list[float]]] = [[]]
    text = path.read_text(encoding="utf-8", errors="replace")
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        if not words:
            curves.append([])
            continue
        try:
            point = [float(word) for word in words[:4]]
        except ValueError:
            point = []
        if len(point) != 4 or not np.isfinite(point).all() or point[3] < 0:
            raise SceneError(
                f"{path}, line {number}: must be x, y, z and a radius of at least 0, got {line[:60]!r}"
            )
        curves[-1].append(point)
    found = [np.array(curve) for curve in curves if curve]
    if not found:
        raise SceneError(f"{path} holds no curves")
    for curve in found:
        if len(curve) < least:
            raise SceneError(f"{path} has a curve of {len(curve)} points, and {least} are needed")
    return found
