"""What a clear coat reflects back to the base under it, in Mitsuba's plastics."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_STEPS = 64


def smooth(eta: float) -> float:
    """Return what a smooth surface reflects of even light from within, of index `eta` ≥ 1 over that outside.

    The closed form from outside is Walsh's (1926), as Duntley (1942) has it; radiance grows by η² within.
    """
    if eta < 1 + 1e-4:
        return 0.0
    n, square = eta, eta * eta
    outside = (
        0.5
        + (n - 1) * (3 * n + 1) / (6 * (n + 1) ** 2)
        + square * (square - 1) ** 2 / (square + 1) ** 3 * math.log((n - 1) / (n + 1))
        - 2 * n**3 * (square + 2 * n - 1) / ((square + 1) * (n**4 - 1))
        + 8 * n**4 * (n**4 + 1) / ((square + 1) * (n**4 - 1) ** 2) * math.log(n)
    )
    return 1 - (1 - outside) / square


@lru_cache(maxsize=256)
def rough(eta: float, alpha: float) -> float:
    """Return what facets of a GGX distribution reflect of even light from within, in one reflection each.

    By facets drawn as they are seen (Heitz, "Sampling the GGX Distribution of Visible Normals", 2018), on a
    grid. The integral over cosines is Mitsuba's sum, which counts both ends of 64 steps as much as the rest:
    it is 1 to 2 % too low, and pictures are to be the same.
    """
    grid = (np.arange(48) + 0.5) / 48
    u, v = (part.reshape(-1) for part in np.meshgrid(grid, grid))
    total = 0.0
    for cosine in np.maximum(np.linspace(0, 1, _STEPS), 1e-6):
        w = np.array([math.sqrt(max(1 - cosine * cosine, 0.0)), 0.0, cosine])
        facets = _visible(w, alpha, u, v)
        cosines = facets @ w
        out = 2 * cosines * facets[:, 2] - cosine
        up = out > 0
        tangent = (1 - out[up] ** 2) / out[up] ** 2
        seen = 2 / (1 + np.sqrt(1 + alpha * alpha * tangent))
        total += 2 * cosine * float((_fresnel(cosines[up], 1 / eta) * seen).sum()) / len(u)
    return float(total / _STEPS)


def _visible(w: Floats, alpha: float, u: Floats, v: Floats) -> Floats:
    """Return normals of facets as seen from a direction in the plane y = 0, (N, 3)."""
    stretched = w * (alpha, 1.0, 1.0)
    stretched /= np.linalg.norm(stretched)
    x, y = np.sqrt(u) * np.cos(2 * np.pi * v), np.sqrt(u) * np.sin(2 * np.pi * v)
    share = 0.5 * (1 + stretched[2])
    y = (1 - share) * np.sqrt(1 - x * x) + share * y
    z = np.sqrt(np.maximum(1 - x * x - y * y, 0.0))
    # The frame of the stretched direction: y of the surface, and what is at right angles to both.
    across = np.array([-stretched[2], 0.0, stretched[0]])
    facets = x[:, None] * (0.0, 1.0, 0.0) + y[:, None] * across + z[:, None] * stretched
    facets *= (alpha, alpha, 1.0)
    return np.asarray(facets / np.linalg.norm(facets, axis=1, keepdims=True))


def _fresnel(cosine: Floats, eta: float) -> Floats:
    through = 1 - (1 - cosine * cosine) / (eta * eta)
    refracted = np.sqrt(np.maximum(through, 0.0))
    s = (cosine - eta * refracted) / (cosine + eta * refracted)
    p = (eta * cosine - refracted) / (eta * cosine + refracted)
    return np.where(through <= 0, 1.0, 0.5 * (s * s + p * p))
