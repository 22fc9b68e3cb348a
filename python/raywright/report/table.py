"""The table that every report is: printed, written as Markdown or CSV, or plotted."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from ..html_tables import html_table
from ..io.plots import plotted
from ..query.rows import frame

if TYPE_CHECKING:
    from typing_extensions import Self

Row = TypeVar("Row", bound=tuple[Any, ...])


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Parameters
    ----------
    name : str
        Name in code.
    heading : str
        Heading with the unit.
    form : str
        Format specification of numbers, as for `format`; text is not formatted, and None is ``-``.

    See Also
    --------
    report.Table : Has columns.

    Examples
    --------
    >>> rw.report.Column("length", "length (m)", ".2f").heading
    'length (m)'
    """

    name: str
    heading: str
    form: str = ""

    def text(self, value: Any) -> str:
        """Return a value of this column as text.

        Parameters
        ----------
        value : object
            Entry of the column.

        Returns
        -------
        str

        Examples
        --------
        >>> rw.report.Column("length", "length (m)", ".2f").text(1.5)
        '1.50'
        """
        if value is None:
            return "-"
        return value if isinstance(value, str) else format(value, self.form)


@dataclass(frozen=True)
class Chart:
    """Axes and groups of a plot: the names of columns.

    Parameters
    ----------
    x, y : str
        Columns of numbers, each on a logarithmic axis.
    color : str
        Column that determines the color.
    marker : str, optional
        Column that determines the marker.
    lines : bool
        True to connect rows of equal color and marker, in order.

    See Also
    --------
    report.Table : Takes it.

    Examples
    --------
    >>> rw.report.Chart("seconds", "relmse", color="contender", lines=True).x
    'seconds'
    """

    x: str
    y: str
    color: str
    marker: str | None = None
    lines: bool = False


@dataclass(frozen=True, repr=False)
class Table(Generic[Row]):
    """Rows of named columns.

    ``print(table)`` shows it, a notebook shows it as Markdown.

    Parameters
    ----------
    title : str
        Title, one line.
    columns : sequence of Column
        Columns of each row.
    rows : sequence of tuples
        Text, numbers, or None for missing entries.
    notes : sequence of str
        Notes for the reader.
    chart : Chart, optional
        Default plot.

    Raises
    ------
    ValueError
        If a row has more entries, or fewer, than there are columns.

    See Also
    --------
    report.accelerators, report.convergence, report.kernels

    Examples
    --------
    >>> columns = [rw.report.Column("name", "name"), rw.report.Column("value", "value (m)", ".2f")]
    >>> table = rw.report.Table("Lengths", columns, [("a", 1.0), ("b", 2.5)])
    >>> print(table.markdown())
    | name | value (m) |
    | ---- | --------: |
    | a    |      1.00 |
    | b    |      2.50 |
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()
    chart: Chart | None = None

    def __post_init__(self) -> None:
        for name in ("columns", "rows", "notes"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        for i, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                raise ValueError(f"row {i} has {len(row)} entries, but there are {len(self.columns)} columns")

    def column(self, name: str) -> tuple[Any, ...]:
        """Return the entries of a column, from the first row to the last.

        Parameters
        ----------
        name : str
            Name of the column.

        Returns
        -------
        tuple

        Raises
        ------
        ValueError
            If there is no such column.

        Examples
        --------
        >>> columns = [rw.report.Column("name", "name"), rw.report.Column("value", "value (m)", ".2f")]
        >>> table = rw.report.Table("Lengths", columns, [("a", 1.0), ("b", 2.5)])
        >>> table.column("value")
        (1.0, 2.5)
        """
        at = self._at(name)
        return tuple(row[at] for row in self.rows)

    def where(self, **wanted: Any) -> Self:
        """Return a table of the rows with the given entries.

        Parameters
        ----------
        **wanted
            Entries, by the names of columns.

        Returns
        -------
        Table
            Of the same class, without other rows.

        Raises
        ------
        ValueError
            If there is no such column.

        Examples
        --------
        >>> columns = [rw.report.Column("name", "name"), rw.report.Column("value", "value (m)", ".2f")]
        >>> table = rw.report.Table("Lengths", columns, [("a", 1.0), ("b", 2.5)])
        >>> table.where(name="b").rows
        (('b', 2.5),)
        """
        picked = [(self._at(name), value) for name, value in wanted.items()]
        return replace(self, rows=tuple(row for row in self.rows if all(row[i] == v for i, v in picked)))

    def markdown(self) -> str:
        """Return the table as Markdown, without title and notes.

        Returns
        -------
        str

        See Also
        --------
        Table.csv : With all digits.

        Examples
        --------
        >>> columns = [rw.report.Column("name", "name"), rw.report.Column("value", "value (m)", ".2f")]
        >>> table = rw.report.Table("Lengths", columns, [("a", 1.0), ("b", 2.5)])
        >>> print(table.markdown())
        | name | value (m) |
        | ---- | --------: |
        | a    |      1.00 |
        | b    |      2.50 |
        """
        texts = [[cell.replace("|", "\\|") for cell in line] for line in self._texts()]
        widths = [max(3, *map(len, cells)) for cells in zip(*texts, strict=True)]
        left = self._left()
        rule = ["-" * w if is_left else "-" * (w - 1) + ":" for w, is_left in zip(widths, left, strict=True)]
        lines = [_aligned(line, widths, left) for line in texts]
        return "\n".join(f"| {' | '.join(line)} |" for line in (lines[0], rule, *lines[1:]))

    def to_dataframe(self) -> Any:
        """Return the table as a pandas DataFrame with the same column names.

        Returns
        -------
        pandas.DataFrame

        Raises
        ------
        ImportError
            If pandas is not installed.

        Examples
        --------
        >>> import pandas
        >>> columns = [rw.report.Column("name", "name"), rw.report.Column("value", "value (m)", ".2f")]
        >>> table = rw.report.Table("Lengths", columns, [("a", 1.0), ("b", 2.5)])
        >>> table.to_dataframe()["value"].sum().item()
        3.5
        """
        return frame({column.name: list(self.column(column.name)) for column in self.columns})

    def csv(self) -> str:
        """Return the table as CSV: names of columns, then rows with all digits; None is empty.

        Returns
        -------
        str

        See Also
        --------
        Table.markdown : For reading.

        Examples
        --------
        >>> columns = [rw.report.Column("name", "name"), rw.report.Column("value", "value (m)", ".2f")]
        >>> table = rw.report.Table("Lengths", columns, [("a", 1.0), ("b", 2.5)])
        >>> table.csv().splitlines()
        ['name,value', 'a,1.0', 'b,2.5']
        """
        import csv
        import io

        file = io.StringIO()
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(column.name for column in self.columns)
        writer.writerows(self.rows)
        return file.getvalue()

    def plot(self, ax: Any = None, x: str | None = None, y: str | None = None) -> Any:
        """Plot one column against another on logarithmic axes.

        Zeros, which have no logarithm, are drawn at half of the least positive number of the column; rows
        without a number are left out.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, str or path, optional
            Target: a new figure if not given, axes, or a file, .png, .svg or .pdf.
        x, y : str, optional
            Columns other than those of `chart`.

        Returns
        -------
        matplotlib.axes.Axes
            With a legend.

        Raises
        ------
        ImportError
            If matplotlib is not installed (``pip install 'raywright[plot]'``).
        ValueError
            If the table has no chart, there is no such column, or a file has another suffix.
        OSError
            If the file cannot be written.
        TypeError
            If `ax` is something else.

        See Also
        --------
        report.Chart : The default columns.

        Examples
        --------
        >>> from matplotlib import pyplot as plt
        >>> columns = [rw.report.Column(name, name, ".2f") for name in ("x", "y", "kind")]
        >>> chart = rw.report.Chart("x", "y", color="kind")
        >>> table = rw.report.Table("Squares", columns, [(1.0, 1.0, "a"), (2.0, 4.0, "a")], chart=chart)
        >>> _, axes = plt.subplots()
        >>> axes = table.plot(axes)
        >>> axes.get_xscale()
        'log'
        """
        if self.chart is None:
            raise ValueError("this table has no chart")
        chart = replace(self.chart, x=x or self.chart.x, y=y or self.chart.y)
        for name in (chart.x, chart.y):
            self._at(name)
        return plotted(ax, lambda ax: self._draw(ax, chart), figsize=(9, 5.5))

    def _draw(self, ax: Any, chart: Chart) -> None:
        across, up = self.columns[self._at(chart.x)], self.columns[self._at(chart.y)]
        xs, ys = (_drawable(self.column(column.name)) for column in (across, up))
        colors = self.column(chart.color)
        markers = self.column(chart.marker) if chart.marker else ("",) * len(self.rows)
        shapes = dict(zip(dict.fromkeys(markers), "osD^vP*Xhp<>" * (len(self.rows) // 12 + 1), strict=False))
        shades = {name: f"C{i}" for i, name in enumerate(dict.fromkeys(colors))}
        style = "-" if chart.lines else ""
        for color, marker in dict.fromkeys(zip(colors, markers, strict=True)):
            mine = [i for i, key in enumerate(zip(colors, markers, strict=True)) if key == (color, marker)]
            points = [(xs[i], ys[i]) for i in mine if xs[i] is not None and ys[i] is not None]
            ax.plot(
                [p[0] for p in points],
                [p[1] for p in points],
                color=shades[color],
                marker=shapes[marker],
                linestyle=style,
            )
        ax.set(xscale="log", yscale="log", xlabel=across.heading, ylabel=up.heading, title=self.title)
        ax.grid(True, which="major", alpha=0.3)
        # Separate legend entries: one for each color, one for each marker, or one for both.
        both = chart.marker == chart.color
        for name, shade in shades.items():
            key = {"marker": shapes[name], "linestyle": style} if both else {"linewidth": 5}
            ax.plot([], [], color=shade, label=name, **key)
        if chart.marker and not both:
            for name, shape in shapes.items():
                ax.plot([], [], color="0.3", marker=shape, linestyle="", label=name)
        ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)

    def _at(self, name: str) -> int:
        names = [column.name for column in self.columns]
        if name not in names:
            raise ValueError(f"no column is named {name!r}; there are {', '.join(names)}")
        return names.index(name)

    def _texts(self) -> list[list[str]]:
        """Headings, then rows."""
        headings = [column.heading for column in self.columns]
        return [headings] + [
            [column.text(value) for column, value in zip(self.columns, row, strict=True)] for row in self.rows
        ]

    def _left(self) -> list[bool]:
        """Return whether each column is of text, which starts at the left; numbers end at the right."""
        return [any(isinstance(row[i], str) for row in self.rows) for i in range(len(self.columns))]

    def __str__(self) -> str:
        texts, left = self._texts(), self._left()
        widths = [max(map(len, cells)) for cells in zip(*texts, strict=True)]
        lines = ["  ".join(_aligned(line, widths, left)).rstrip() for line in texts]
        rule = "  ".join("-" * width for width in widths)
        body: list[str] = []
        for i, line in enumerate(lines[1:]):
            # An empty line separates groups: consecutive rows with the same first word.
            if i and self._grouped() and self.rows[i][0] != self.rows[i - 1][0]:
                body.append("")
            body.append(line)
        return "\n".join([self.title, "", lines[0], rule, *body, *([""] if self.notes else []), *self.notes])

    def _grouped(self) -> bool:
        first = [row[0] for row in self.rows]
        return len(set(first)) < len(first)

    def _repr_html_(self) -> str:
        headings, *rows = self._texts()
        return html_table(self.title, headings, rows, self.notes)

    def _repr_markdown_(self) -> str:
        parts = [f"**{self.title}**", self.markdown(), *self.notes]
        return "\n\n".join(parts)

    def __repr__(self) -> str:
        names = ", ".join(column.name for column in self.columns)
        return f"{type(self).__name__}({len(self.rows)} rows of {names})"


def _aligned(line: Sequence[str], widths: Iterable[int], left: Iterable[bool]) -> list[str]:
    return [
        cell.ljust(width) if is_left else cell.rjust(width)
        for cell, width, is_left in zip(line, widths, left, strict=True)
    ]


def _drawable(values: Sequence[Any]) -> list[float | None]:
    """Numbers that have a logarithm; zero becomes half the least of them."""
    least = min((v for v in values if v is not None and 0 < v < math.inf), default=1.0)
    return [None if v is None or not 0 <= v < math.inf else float(v) if v > 0 else least / 2 for v in values]
