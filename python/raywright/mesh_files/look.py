"""Appearance of a mesh, from a file or an object of trimesh."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..lights.emission import Emitted
from ..materials import Diffuse, Material
from ..textures import VertexColors


class Look(NamedTuple):
    """Appearance of a mesh; None where nothing is said of it."""

    material: Material | None = None
    emission: Emitted | None = None
    colors: NDArray[np.float64] | None = None


def shares_of(colors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return colors of a text, (N, 3), as shares from 0 to 1: some programs write integers up to 255."""
    shares = colors / 255 if (colors > 1).any() else colors
    return np.clip(np.nan_to_num(shares), 0, 1)


def colored(shares: NDArray[np.float64] | None) -> Look:
    """Return the look of vertices with these shares of sRGB, (N, 3): of one color if all have the same."""
    if shares is None or not len(shares):
        return Look()
    if (shares != shares[0]).any():
        return Look(Diffuse(VertexColors()), colors=linear(shares))
    red, green, blue = linear(shares[0]).tolist()
    return Look(Diffuse((red, green, blue)))


def linear(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return shares of sRGB as linear ones (IEC 61966-2-1)."""
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def color_look(colors: NDArray[Any]) -> Look:
    """Return the look of a mesh with sRGB colors of vertices: shares of 1, or integers of the full range."""
    if colors.dtype.kind == "u":
        colors = colors / np.iinfo(colors.dtype).max
    return colored(np.clip(np.nan_to_num(colors[:, :3].astype(np.float64)), 0, 1))
