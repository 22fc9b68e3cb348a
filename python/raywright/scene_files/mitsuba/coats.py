"""Internal reflection of a clear coat to its base, in Mitsuba's plastics."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_STEPS = 64
_FINE = 96
# Slopes in units of alpha.
_GRID = (np.arange(64) + 0.5) / 8 - 4
_SLOPES = [part.reshape(-1) for part in np.meshgrid(_GRID, _GRID)]


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
def rough(eta: float, alpha: float, distribution: str) -> tuple[float, float]:
    """Return what facets reflect of even light from within, in one reflection each: in truth, and in Mitsuba.

    Mitsuba's sum over cosines counts both ends of 64 steps as much as the rest. It is 1 to 2 % too low, and
    pictures are to be the same.
    """
    facets = _FACETS[distribution]
    even = np.sqrt((np.arange(_FINE) + 0.5) / _FINE)
    truth = np.mean([facets(cosine, alpha).reflected(eta) for cosine in even])
    steps = np.maximum(np.linspace(0, 1, _STEPS), 1e-6)
    theirs = np.mean([2 * cosine * facets(cosine, alpha).reflected(eta) for cosine in steps])
    return float(truth), float(theirs)


class _Facets:
    """Facets as they are seen from a direction in the plane y = 0: (N, 3) normals, and of each its weight."""

    def __init__(self, cosine: float, alpha: float) -> None:
        self.alpha = alpha
        self.w = np.array([math.sqrt(max(1 - cosine * cosine, 0.0)), 0.0, cosine])
        self.normals, self.weights = self.seen()

    def seen(self) -> tuple[Floats, Floats]:
        raise NotImplementedError

    def masking(self, tangent: Floats) -> Floats:
        """Return the share that is seen, by the square of alpha times the tangent."""
        raise NotImplementedError

    def reflected(self, eta: float) -> float:
        """Return the share of the light from within that is reflected once."""
        cosines = self.normals @ self.w
        out = 2 * cosines * self.normals[:, 2] - self.w[2]
        up = (out > 0) & (cosines > 0)
        seen = self.masking(self.alpha**2 * (1 - out[up] ** 2) / out[up] ** 2)
        return float((self.weights[up] * _fresnel(cosines[up], 1 / eta) * seen).sum())


class _Ggx(_Facets):
    """Drawn as they are seen, on a grid (Heitz, "Sampling the GGX Distribution of Visible Normals", 2018)."""

    def seen(self) -> tuple[Floats, Floats]:
        grid = (np.arange(48) + 0.5) / 48
        u, v = (part.reshape(-1) for part in np.meshgrid(grid, grid))
        return _visible(self.w, self.alpha, u, v), np.full(len(u), 1 / len(u))

    def masking(self, tangent: Floats) -> Floats:
        return np.asarray(2 / (1 + np.sqrt(1 + tangent)))


class _Beckmann(_Facets):
    """By their slopes, which are normally distributed and counted as much as they are seen."""

    def seen(self) -> tuple[Floats, Floats]:
        x, y = _SLOPES
        facing = self.w[2] + self.alpha * self.w[0] * x
        weights = np.maximum(facing, 0.0) * np.exp(-x * x - y * y)
        normals = np.column_stack([self.alpha * x, self.alpha * y, np.ones_like(x)])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        return normals, weights / weights.sum()

    def masking(self, tangent: Floats) -> Floats:
        # A fit to 0.35 %, as in Mitsuba (Walter et al., 2007).
        a = 1 / np.sqrt(np.maximum(tangent, 1e-12))
        share = (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a)
        return np.where(a < 1.6, share, 1.0)


_FACETS: dict[str, type[_Facets]] = {"ggx": _Ggx, "beckmann": _Beckmann}


def _visible(w: Floats, alpha: float, u: Floats, v: Floats) -> Floats:
    """Return normals of facets as seen from a direction in the plane y = 0, (N, 3)."""
    stretched = w * (alpha, 1.0, 1.0)
    stretched /= np.linalg.norm(stretched)
    x, y = np.sqrt(u) * np.cos(2 * np.pi * v), np.sqrt(u) * np.sin(2 * np.pi * v)
    share = 0.5 * (1 + stretched[2])
    y = (1 - share) * np.sqrt(1 - x * x) + share * y
    z = np.sqrt(np.maximum(1 - x * x - y * y, 0.0))
    # Axes around the stretched direction: the surface's y, and the perpendicular of both.
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
