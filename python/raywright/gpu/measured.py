"""Reflectances of metals as tables: measured from the core, at a plate of each."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..materials import Conductor, metal_index
from ..query.interactions import Interactions
from ..query.ray_batch import Rays
from ..scene.scene import Scene
from ..shapes.mesh import Mesh

# Steps of the cosine in a table of reflectances.
STEPS = 256
# Wavelengths where the eye is sensitive, nm.
_SEEN = np.arange(400.0, 701.0, 5.0)


def _met(metal: Conductor, cosines: NDArray[np.float64]) -> Interactions:
    """Return the scattering of rays at a plate, at some cosines."""
    plate = Mesh([(-2.0, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], [(0, 1, 2), (0, 2, 3)], material=metal)
    ways = np.stack([-np.sqrt(1 - cosines**2), np.zeros_like(cosines), -cosines], axis=1)
    rays = Rays(np.array([0.1, 0.2, 0.0]) - ways, ways, np.zeros(len(ways)))
    return Scene(plate).interactions(rays)


@lru_cache(64)
def reflectances(name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the reflectance of a smooth metal by name, and the share that is left at a second reflection.

    Returns
    -------
    reflectances : (STEPS + 1, 3)
        At cosines from 0 to 1.
    again : (3,)
        Factors of light that such a metal has reflected before.
    """
    # Never exactly grazing.
    cosines = np.maximum(np.linspace(0.0, 1.0, STEPS + 1), 1e-6)
    table = np.array(_met(Conductor(name), cosines).reflected().weight)
    index = metal_index(name)
    eta, k = (np.interp(_SEEN, index.wavelengths, part) for part in (index.eta, index.k))
    best = (((eta - 1) ** 2 + k**2) / ((eta + 1) ** 2 + k**2)).max()
    most = table.max(axis=0)
    return table, np.where(most > 1 + 1e-6, best / most, 1.0)


def made_up(metal: Conductor, loss: float) -> NDArray[np.float64]:
    """Return the multiple scattering for each unit lost, over π and the mean loss: (3,).

    From the total scattering of a plate, rough and smooth.
    """
    straight = np.ones(1)
    smooth = Conductor(metal.metal) if metal.metal else Conductor(eta=metal.eta, k=metal.k)
    whole, once = (np.array(_met(one, straight).albedo[0]) for one in (metal, smooth))
    return np.asarray(np.maximum(whole - once * (1 - loss), 0) / (np.pi * loss**2))
