"""Where samples lie that are drawn by a filter: by tables, as devices take them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .filters import BlackmanHarrisFilter, BoxFilter, Filter, GaussianFilter, TriangleFilter

ENTRIES = 1025
_STEPS = 20_000


def quantiles(filter: Filter) -> NDArray[np.float64] | None:
    """Return the quantiles of a filter along one axis, in pixels from a pixel's center.

    Parameters
    ----------
    filter : Filter
        The filter: the product of one along either axis.

    Returns
    -------
    (1025,) float64 or None
        Of evenly spaced probabilities from 0 to 1; None for filters with negative lobes, which have none.
    """
    if not isinstance(filter, BoxFilter | TriangleFilter | GaussianFilter | BlackmanHarrisFilter):
        return None
    radius = filter.radius
    if isinstance(filter, GaussianFilter):
        # The tail beyond nine standard deviations is negligible.
        radius = min(radius, 9 * filter.sigma)
    x = np.linspace(-1, 1, 2 * _STEPS + 1)
    if isinstance(filter, BoxFilter):
        density = np.ones_like(x)
    elif isinstance(filter, TriangleFilter):
        density = 1 - np.abs(x)
    elif isinstance(filter, GaussianFilter):
        end = np.exp(-0.5 * (filter.radius / filter.sigma) ** 2)
        density = np.exp(-0.5 * (x * radius / filter.sigma) ** 2) - end
    else:
        turn = np.pi * (x + 1)
        density = 0.35875 - 0.48829 * np.cos(turn) + 0.14128 * np.cos(2 * turn) - 0.01168 * np.cos(3 * turn)
    density = np.maximum(density, 0)
    up_to = np.concatenate([[0.0], np.cumsum(density[:-1] + density[1:])])
    return np.asarray(radius * np.interp(np.linspace(0, 1, ENTRIES), up_to / up_to[-1], x))
