"""Tables of the energy that GGX facets lose in one scattering."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

ENTRIES = 64
_STEPS = 96


def fresnel(cosine: Floats, eta: float) -> Floats:
    """Return the share of light that a dielectric of relative index `eta` reflects (Fresnel, 1823)."""
    g2 = eta**2 - 1 + cosine**2
    g = np.sqrt(np.maximum(g2, 0))
    s = ((cosine - g) / np.maximum(cosine + g, 1e-300)) ** 2
    p = ((eta**2 * cosine - g) / np.maximum(eta**2 * cosine + g, 1e-300)) ** 2
    return np.where(g2 <= 0, 1.0, (s + p) / 2)


def mean_fresnel(eta: float) -> float:
    """Return the share of even light that a dielectric reflects."""
    # Samples are denser near the onset of partial reflection.
    least = np.sqrt(max(1 - eta**2, 0.0))
    t = (np.arange(4096) + 0.5) / 4096
    cosine = least + (1 - least) * t**2
    return float(least**2 + (2 * cosine * fresnel(cosine, eta) * 2 * t * (1 - least)).mean())


def _out(alpha: float, eta: float | None, z: float) -> tuple[float, float]:
    """Return the shares of light from a cosine that leave white facets, or a dielectric's, on either side.

    In one scattering, by the mean of Smith's G2 over G1 over the facets that are seen (Dupuy and Benyoub,
    2023, for how these are drawn), on a grid that is dense where they reflect along the surface.
    """
    middles = (np.arange(_STEPS) + 0.5) / _STEPS
    t, turn = (part.ravel() for part in np.meshgrid(middles, middles))
    u = 1 - t**4
    x = np.sqrt(max(1 - z * z, 0.0))
    length = np.sqrt(alpha**2 * x**2 + z**2)
    wx, wz = alpha * x / length, z / length
    depth, phi = u * (1 + wz), 2 * np.pi * turn
    radius = np.sqrt(np.maximum(depth * (2 - depth), 0))
    h = np.stack([alpha * (radius * np.cos(phi) + wx), alpha * radius * np.sin(phi), (1 - u) * (1 + wz)])
    h /= np.linalg.norm(h, axis=0)
    o = h[0] * x + h[2] * z
    wo = np.array([[x], [0.0], [z]])

    def stretch(w: Floats) -> Floats:
        return np.asarray(np.sqrt(alpha**2 * (w[0] ** 2 + w[1] ** 2) + w[2] ** 2))

    wi = 2 * o * h - wo
    up = wi[2] > 0
    seen = np.where(up, wi[2] * (z + length) / np.where(up, length * wi[2] + stretch(wi) * z, 1), 0)
    if eta is None:
        return float((4 * t**3 * seen).mean()), 0.0
    share = fresnel(o, eta)
    square = eta**2 - 1 + o**2
    wi = -(wo + h * ((eta**2 - 1) / (o + np.sqrt(np.maximum(square, 0))))) / eta
    down = (wi[2] < 0) & (square > 0)
    low = np.where(down, -wi[2], 1.0)
    through = np.minimum(1, low * (z + length) / (z * (low + stretch(wi))))
    beyond = (1 - share) * np.where(down, through, 0)
    return float((4 * t**3 * share * seen).mean()), float((4 * t**3 * beyond).mean())


# Never exactly grazing, where the loss is undefined.
_COSINES: list[float] = np.maximum(np.linspace(0, 1, ENTRIES) ** 2, 1e-6).tolist()


@lru_cache(64)
def loss_table(alpha: float, eta: float | None = None) -> Floats:
    """Return the lost share of light from 64 cosines, evenly spaced in their roots from 0 to 1.

    Of mirrors, or of a dielectric whose index on the other side is `eta` times that before it.
    """
    return np.clip([1 - sum(_out(alpha, eta, z)) for z in _COSINES], 0, 1)


@lru_cache(64)
def coat_table(alpha: float, eta: float) -> Floats:
    """Return the reflectance of a rough dielectric for light from such cosines, in one scattering."""
    return np.clip([_out(alpha, eta, z)[0] for z in _COSINES], 0, 1)


def mean_of(table: Floats) -> float:
    """Return the lost, or reflected, share of uniform light, by interpolation in a table."""
    roots = (np.arange(4096) + 0.5) / 4096
    loss = np.interp(roots, np.linspace(0, 1, ENTRIES), table)
    # With the cosine r², 2 c dc is 4 r³ dr.
    return float((loss * 4 * roots**3).mean())
