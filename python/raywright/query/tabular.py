"""Results as columns of a table, for pandas and for notebooks."""

from typing import Any

from numpy.typing import NDArray

from ..html_tables import FEW, html_columns
from .rows import frame


class Tabular:
    """What can be told as columns of a table."""

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return what is known as flat arrays by name, an entry for each row."""
        raise NotImplementedError

    def to_dataframe(self) -> Any:
        """Return what `to_dict` does as a ``pandas.DataFrame``.

        Raises
        ------
        ImportError
            If pandas is not installed.
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
