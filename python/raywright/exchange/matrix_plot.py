"""A matrix of view factors as a picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

# Most rows and columns of the picture; beyond, each pixel is the mean of a block.
_MOST = 1024


def block_means(matrix: Any, most: int = _MOST) -> NDArray[np.float64]:
    """Return the means of blocks of a square matrix, an array or a sparse one, of `most` rows at most."""
    count = matrix.shape[0]
    step = max(-(-count // most), 1)
    if not isinstance(matrix, np.ndarray):
        entries = matrix.tocoo()
        rows, columns = (np.asarray(place, np.int64) // step for place in (entries.row, entries.col))
        size = -(-count // step)
        sums = np.bincount(rows * size + columns, entries.data, size * size).reshape(size, size)
    elif step == 1:
        return np.asarray(matrix, np.float64)
    else:
        starts = np.arange(0, count, step)
        sums = np.add.reduceat(np.add.reduceat(matrix, starts, axis=0), starts, axis=1)
    members = np.diff(np.append(np.arange(0, count, step), count))
    return np.asarray(sums / np.multiply.outer(members, members), np.float64)


def draw_matrix(ax: Any, matrix: Any, label: str, cmap: Any) -> None:
    """Draw a matrix on axes, with a color bar; zeros, of pairs that do not see each other, are gray."""
    from ..io.value_plots import draw_picture

    means = block_means(matrix)
    draw_picture(ax, np.where(means > 0, means, np.nan), label, cmap)
    count = matrix.shape[0]
    # Axes count rows of the matrix.
    ax.images[-1].set_extent((-0.5, count - 0.5, count - 0.5, -0.5))
    ax.set_xlabel("to")
    ax.set_ylabel("from")
