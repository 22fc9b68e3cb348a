"""How a mesh looks, by what a file or an object of trimesh says of it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..lights.emission import Emitted
from ..materials import Material


class Look(NamedTuple):
    """How a mesh looks; None where nothing is said of it."""

    material: Material | None = None
    emission: Emitted | None = None
    colors: NDArray[np.float64] | None = None


def linear(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return shares of sRGB as linear ones (IEC 61966-2-1)."""
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
