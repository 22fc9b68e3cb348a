"""Results as columns of a table, for pandas and for notebooks."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from ..html_tables import FEW, html_columns
from .rows import frame


class Tabular:
    """Results that convert to columns of a table."""

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return the results as flat arrays by name, an entry for each row.

        Returns
        -------
        dict
            An array for each column, all of the same length.

        See Also
        --------
        Hits.to_dataframe : The same as a table of pandas.

        Examples
        --------
        >>> hits = rw.Scene(rw.Sphere()).intersect([[0, 0, 5], [9, 0, 5]], [0, 0, -1])
        >>> columns = hits.to_dict()
        >>> columns["t"].tolist(), columns["shape_id"].tolist()
        ([4.0, inf], [0, -1])
        """
        raise NotImplementedError

    def to_dataframe(self) -> Any:
        """Return the arrays of `to_dict` as a ``pandas.DataFrame``.

        Returns
        -------
        pandas.DataFrame

        Raises
        ------
        ImportError
            If pandas is not installed.

        See Also
        --------
        Hits.to_dict : The same as a dict of arrays.

        Examples
        --------
        >>> hits = rw.Scene(rw.Sphere()).intersect([[0, 0, 5], [9, 0, 5]], [0, 0, -1])
        >>> import pandas
        >>> hits.to_dataframe()[["t", "shape_id"]].shape
        (2, 2)
        """
        return frame(self.to_dict())

    def _first_rows(self, count: int) -> tuple[int, dict[str, NDArray[Any]]]:
        """Return how many rows there are, and the columns of the first of them."""
        columns = self.to_dict()
        size = len(next(iter(columns.values())))
        return size, {name: column[:count] for name, column in columns.items()}

    def _repr_html_(self) -> str:
        size, columns = self._first_rows(FEW)
        return html_columns(repr(self), columns, size)
