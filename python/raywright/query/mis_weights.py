"""Weights of multiple importance sampling."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .ray_batch import Floats, numbers


def power_heuristic(pdf: ArrayLike, other: ArrayLike) -> Floats:
    """Return the power heuristic's weight of a sample, from its densities by two techniques.

    The exponent is 2 (Veach and Guibas 1995); infinite densities get the weight 1, and 0 the weight 0.

    Parameters
    ----------
    pdf, other : float or arrays
        Densities in the same measure, at least 0.

    Returns
    -------
    float64 array
        Weights from 0 to 1; those of the two techniques add up to 1.

    See Also
    --------
    Interactions.light_pdf : The density of light sampling.

    Examples
    --------
    >>> rw.query.power_heuristic([3.0, np.inf, 0.0], 1.0).round(9).tolist()
    [0.9, 1.0, 0.0]
    """
    mine, others = np.broadcast_arrays(numbers("pdf", pdf), numbers("other", other))
    with np.errstate(over="ignore"):
        ratio = np.divide(others, mine, out=np.full(mine.shape, np.inf), where=mine > 0)
        return np.asarray(1.0 / (1.0 + ratio * ratio))
