"""The matrix of view factors with its errors, and its products."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import choice, real_array
from ..io.plots import plotted
from ..io.value_plots import COLORS
from ..query.tabular import Tabular
from .matrix_plot import draw_matrix

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Per: TypeAlias = Literal["face", "shape"]


@dataclass(frozen=True, eq=False, repr=False)
class ViewFactors(Tabular):
    """View factors: the share of the diffuse light leaving one surface that arrives at another.

    Attributes
    ----------
    matrix : (N, N) float64 array, or scipy.sparse.csr_array
        Row i, column j: from i to j, 0 to 1. Sparse where the scene has more than 10,000 faces and `per` is
        "face".
    areas : (N,) float64 array
        The area of each, in the square of the scene's unit; 0 for a face that coincides with one before it,
        which counts for both. Its row is that of the other face, and its column is 0.
    per : {"face", "shape"}
        "face" or "shape": the kind of a row. Faces are numbered shape after shape, and a shape that is no
        mesh is one face. An `Instance` is one shape, whose faces are those of all copies, one copy after the
        other, as `Instance.locate` numbers those of each.
    closed, hidden, sampled : int
        Number of pairs of faces that face each other: in closed form, fully hidden, and sampled by rays.
    rays : int
        Number of rays.
    dropped : int
        Number of faces without exchange of their own: without area, not finite, or coincident with another.

    See Also
    --------
    view_factors : Makes it.

    Examples
    --------
    >>> floor = rw.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> ceiling = rw.Mesh([[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]], [[0, 1, 2], [0, 2, 3]])
    >>> found = rw.view_factors([floor, ceiling], per="shape", progress=False)
    >>> found.matrix.round(6).tolist(), found.to_surroundings.round(6).tolist()
    ([[0.0, 0.199825], [0.199825, 0.0]], [0.800175, 0.800175])
    """

    matrix: NDArray[np.float64] | csr_array
    areas: NDArray[np.float64]
    per: Per
    closed: int
    hidden: int
    sampled: int
    rays: int
    dropped: int
    # Squared standard errors: rows, columns and values of non-zero entries, or a matrix of the same kind.
    _variance: Any
    # True for rows that were sampled and add up to one.
    _closed: NDArray[np.bool_]

    @cached_property
    def standard_error(self) -> NDArray[np.float64] | csr_array:
        """The standard error of each view factor, as `matrix`; 0 where it is in closed form.

        Sparse ones have no entry where no ray from either face has met the other: of n rays the factor is
        then below 3 / n in 19 of 20 cases.
        """
        if not isinstance(self._variance, tuple):
            return self._variance.sqrt()
        rows, columns, values = self._variance
        error = np.zeros(self.matrix.shape)
        error[rows, columns] = np.sqrt(values)
        return error

    @cached_property
    def to_surroundings(self) -> NDArray[np.float64]:
        """What comes to no front, (N,): 1 less the sum of each row."""
        return 1.0 - np.asarray(self.matrix.sum(axis=1))

    def plot(self, ax: Any = None, name: str = "matrix", cmap: Any = COLORS) -> Any:
        """Draw the matrix with matplotlib: a pixel for each entry, or for each block of a large matrix.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, str or path, optional
            Target: a new figure if not given, axes, or a file, .png, .svg or .pdf.
        name : {"matrix", "standard_error"}
            Name of the array. Zeros are gray.
        cmap : str or matplotlib.colors.Colormap
            The colors, from the least entry to the largest.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ImportError
            If matplotlib is not installed (``pip install 'raywright[plot]'``).
        ValueError
            If there is no such name, or a file has another suffix.
        TypeError
            If `ax` is something else.
        OSError
            If the file cannot be written.

        See Also
        --------
        RadiositySolution.plot : Draw the light.

        Examples
        --------
        >>> from matplotlib import pyplot as plt
        >>> _, axes = plt.subplots()
        >>> axes = rw.view_factors(rw.scenes.cornell_box()[0], rays=16, progress=False).plot(axes)
        >>> len(axes.get_images())
        1
        """
        choice("name", name, ("matrix", "standard_error"))
        label = "view factor" if name == "matrix" else "standard error"
        return plotted(ax, lambda ax: draw_matrix(ax, getattr(self, name), label, cmap))

    def matvec(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return ``matrix @ x``: irradiances from radiosities x, (N,) or (N, K).

        Parameters
        ----------
        x : (N,) or (N, K) array
            Radiosities, one per row of the matrix.

        Returns
        -------
        (N,) or (N, K) float64 array

        Raises
        ------
        ValueError
            If there is not one x for each row.
        TypeError
            If x does not hold real numbers.

        See Also
        --------
        ViewFactors.rmatvec : The transpose.

        Examples
        --------
        >>> floor = rw.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
        >>> ceiling = rw.Mesh([[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]], [[0, 1, 2], [0, 2, 3]])
        >>> found = rw.view_factors([floor, ceiling], per="shape", progress=False)
        >>> found.matvec([0.0, 100.0]).round(3).tolist()
        [19.982, 0.0]
        """
        return np.asarray(self.matrix @ self._checked(x))

    def matvec_error(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the standard error of ``matvec(x)``, as if the errors of view factors were independent.

        Errors within a row are negatively correlated, so the error is less if x is nearly constant and
        nothing escapes.

        Parameters
        ----------
        x : (N,) or (N, K) array
            Radiosities, one per row of the matrix.

        Returns
        -------
        (N,) or (N, K) float64 array

        Raises
        ------
        ValueError, TypeError
            As `matvec` does.

        See Also
        --------
        ViewFactors.matvec : The product.

        Examples
        --------
        >>> floor = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> found = rw.view_factors(floor, progress=False)
        >>> found.matvec_error([1.0]).tolist()
        [0.0]
        """
        squares = np.square(self._checked(x), dtype=np.float64)
        if not isinstance(self._variance, tuple):
            return np.asarray(np.sqrt(self._variance @ squares))
        rows, columns, values = self._variance
        found = np.zeros(squares.shape)
        np.add.at(found, rows, (values * squares[columns].T).T)
        return np.sqrt(found)

    def _centered(self, x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return (N, N) errors of x as each row weights it, and the covariance of rows and columns.

        Errors of a row that adds up to one cancel if x is the same everywhere, so x is taken relative to its
        mean over the surfaces that the row samples. The first is s_ij (x_j - c_i), with the standard error s.
        The exchange of two faces is one estimate: the second is the product of the first and its transpose.
        """
        spread = np.asarray(self.standard_error)
        weights = spread**2
        whole = weights.sum(axis=1)
        mean = np.divide(weights @ x, whole, out=np.zeros(len(x)), where=self._closed & (whole > 0))
        own = spread * (x[None, :] - mean[:, None])
        both = own * own.T
        np.fill_diagonal(both, 0.0)
        return own, both

    def rmatvec(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return ``matrix.T @ x``: arriving powers from leaving powers x, (N,) or (N, K).

        Parameters
        ----------
        x : (N,) or (N, K) array
            Powers, one per row of the matrix.

        Returns
        -------
        (N,) or (N, K) float64 array

        Raises
        ------
        ValueError, TypeError
            As `matvec` does.

        See Also
        --------
        ViewFactors.matvec : The product with the matrix itself.

        Examples
        --------
        >>> floor = rw.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
        >>> ceiling = rw.Mesh([[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]], [[0, 1, 2], [0, 2, 3]])
        >>> found = rw.view_factors([floor, ceiling], per="shape", progress=False)
        >>> found.rmatvec([0.0, 100.0]).round(3).tolist()
        [19.982, 0.0]
        """
        return np.asarray(self.matrix.T @ self._checked(x))

    def _checked(self, x: ArrayLike) -> NDArray[Any]:
        values = real_array("x", x)
        if values.ndim not in (1, 2) or len(values) != len(self.areas):
            raise ValueError(f"x must be ({len(self.areas)},) or ({len(self.areas)}, K), got {values.shape}")
        return values

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return flat arrays by name, an entry for each view factor that is not 0, row by row.

        ``from`` and ``to`` are row and column, ``factor`` and ``standard_error`` the entry.

        Returns
        -------
        dict
            An array for each column.

        Examples
        --------
        >>> floor = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> ceiling = rw.Mesh([[0, 0, 1], [0, 1, 1], [1, 0, 1]], [[0, 1, 2]])
        >>> columns = rw.view_factors([floor, ceiling], progress=False).to_dict()
        >>> columns["from"].tolist(), columns["to"].tolist()
        ([0, 1], [1, 0])
        """
        matrix: Any = self.matrix
        row, column = matrix.nonzero()
        order = np.lexsort((column, row))
        row, column = row[order].astype(np.int64), column[order].astype(np.int64)
        factor, error = (np.asarray(of[row, column]).reshape(-1) for of in (matrix, self.standard_error))
        return {"from": row, "to": column, "factor": factor, "standard_error": error}

    def __len__(self) -> int:
        return len(self.areas)

    def __repr__(self) -> str:
        kind = "" if isinstance(self.matrix, np.ndarray) else ", sparse"
        return (
            f"ViewFactors({len(self)} {self.per}s{kind}; pairs: {self.closed} closed, {self.hidden} hidden, "
            f"{self.sampled} sampled; {self.rays} rays; rest up to "
            f"{max(self.to_surroundings, default=0.0):.3g})"
        )
