"""Reciprocity of sampled view factors: the exchange of two faces is made one number."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Steps of Newton's method, and steps of conjugate gradients within each.
_STEPS, _INNER = 8, 24
# Relative tolerance for the sums of rows.
_ENOUGH = 1e-13
# Rows expanded at a time.
_TOGETHER = 4096


def reciprocal(matrix: Any, variance: Any, areas: Floats) -> tuple[Any, Any]:
    """Return view factors F with A_i F_ij = A_j F_ji, and their variances.

    Both rows estimate the exchange A F of two faces, with a variance of about A² F / n, so that the one of
    the smaller area counts more. Then rows and columns are scaled alike until each row adds up to the hit
    share of its own rays: to 1 in a closed room.

    Parameters
    ----------
    matrix, variance : scipy.sparse.csr_array
        Of rows that are independent. Both are used up.
    areas : (N,)
        Of the faces.
    """
    met = np.asarray(matrix.sum(axis=1)) * areas
    both = _halves(matrix, areas)
    exchanged = both + both.T.tocsr()
    del both
    # Variances scale with the square of each weight.
    spread = _halves(_halves(variance, areas), areas)
    spread = spread + spread.T.tocsr()
    _mend_diagonal(spread)
    scale = _scaled(exchanged, met)
    inverse = np.divide(1.0, areas, out=np.zeros_like(areas), where=areas > 0)
    _times(exchanged, scale * inverse, scale)
    _times(spread, (scale * inverse) ** 2, scale**2)
    return exchanged, spread


def _scaled(matrix: Any, wanted: Floats) -> Floats:
    """Return d such that d_i Σ_j M_ij d_j is the wanted sum of each row, by Newton's method.

    Its linear systems are symmetric, and take conjugate gradients (Knight and Ruiz, "A Fast Algorithm for
    Matrix Balancing", 2013). Where no d can do it, as between two plates whose rays disagree, it ends near.
    """
    scale = np.ones(len(wanted))
    for _ in range(_STEPS):
        sums = scale * (matrix @ scale)
        off = wanted - sums
        if np.abs(off).max(initial=0.0) <= _ENOUGH * wanted.max(initial=0.0):
            break
        share = np.divide(1.0, sums, out=np.zeros_like(sums), where=sums > 0)
        step, way = np.zeros_like(off), share * off
        along, length = way, float(off @ way)
        rest, least = off, 1e-28 * length
        for _ in range(_INNER):
            if length <= least:
                break
            turned = sums * along + scale * (matrix @ (scale * along))
            much = length / float(along @ turned)
            step, rest = step + much * along, rest - much * turned
            way = share * rest
            length, before = float(rest @ way), length
            along = way + along * (length / before)
        scale = scale * np.exp(np.clip(step, -1.0, 1.0))
    return scale


def _halves(matrix: Any, areas: Floats) -> Any:
    """Multiply each entry, in place, by the product of both areas over their sum."""
    for start in range(0, len(areas), _TOGETHER):
        rows, part = _part(matrix, start)
        one, other = areas[rows], areas[matrix.indices[part]]
        matrix.data[part] *= one * other / (one + other)
    return matrix


def _mend_diagonal(variance: Any) -> None:
    """Double, in place, estimates that were added to themselves, not to another."""
    for start in range(0, variance.shape[0], _TOGETHER):
        rows, part = _part(variance, start)
        variance.data[part][rows == variance.indices[part]] *= 2.0


def _times(matrix: Any, rows: Floats, columns: Floats) -> None:
    """Multiply each entry, in place, by a number of its row and one of its column."""
    for start in range(0, len(rows), _TOGETHER):
        here, part = _part(matrix, start)
        matrix.data[part] *= rows[here] * columns[matrix.indices[part]]


def _part(matrix: Any, start: int) -> tuple[NDArray[np.int64], slice]:
    """Return the row of each entry of some rows, and where these entries are."""
    starts = matrix.indptr[start : start + _TOGETHER + 1]
    rows = start + np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    return rows, slice(int(starts[0]), int(starts[-1]))
