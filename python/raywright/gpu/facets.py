"""What facets of GGX lose of light in one scattering, as tables."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

_ENTRIES = 64
_STEPS = 96


def _seen(alpha: float, cosines: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the share of light from some cosines that leaves white facets at once, (N,).

    By the mean of Smith's G2 over G1 over the facets that are seen (Dupuy and Benyoub, 2023, for how these
    are drawn), on a grid that is dense where they reflect along the surface.
    """
    middles = (np.arange(_STEPS) + 0.5) / _STEPS
    t, turn = (part.ravel() for part in np.meshgrid(middles, middles))
    u = 1 - t**4
    jacobian = 4 * t**3
    seen = np.empty(len(cosines))
    for i, z in enumerate(cosines):
        x = np.sqrt(max(1 - z * z, 0.0))
        length = np.sqrt(alpha**2 * x**2 + z**2)
        wx, wz = alpha * x / length, z / length
        depth = u * (1 + wz)
        radius = np.sqrt(np.maximum(depth * (2 - depth), 0))
        phi = 2 * np.pi * turn
        h = np.stack([alpha * (radius * np.cos(phi) + wx), alpha * radius * np.sin(phi), (1 - u) * (1 + wz)])
        h /= np.linalg.norm(h, axis=0)
        o = h[0] * x + h[2] * z
        wi = 2 * o * h - np.array([[x], [0.0], [z]])
        there = np.sqrt(alpha**2 * (wi[0] ** 2 + wi[1] ** 2) + wi[2] ** 2)
        up = wi[2] > 0
        ratio = wi[2] * (z + length) / np.where(up, length * wi[2] + there * z, 1)
        seen[i] = (jacobian * np.where(up, ratio, 0)).mean()
    return seen


@lru_cache(64)
def loss_table(alpha: float) -> NDArray[np.float64]:
    """Return what is lost of light from 64 cosines, evenly spaced in their roots from 0 to 1."""
    # Not from the plane itself, where nothing is defined.
    cosines = np.maximum(np.linspace(0, 1, _ENTRIES) ** 2, 1e-6)
    return np.clip(1 - _seen(alpha, cosines), 0, 1)


@lru_cache(64)
def average_loss(alpha: float) -> float:
    """Return what is lost of even light, by the table as it is interpolated."""
    roots = (np.arange(4096) + 0.5) / 4096
    loss = np.interp(roots, np.linspace(0, 1, _ENTRIES), loss_table(alpha))
    # With the cosine r^2, 2 c dc is 4 r^3 dr.
    return float((loss * 4 * roots**3).mean())
