"""The plan of a scene: the features it needs, and those left out."""

from __future__ import annotations

from dataclasses import dataclass

from ..html_tables import html_table


@dataclass(frozen=True)
class PlanRow:
    """A row of a `Plan`: a feature, whether the scene has it, and the consequence.

    See Also
    --------
    Plan : The table of these rows.

    Examples
    --------
    >>> row = rw.Scene(rw.Sphere()).plan().rows[0]
    >>> row.what, row.needed
    ('light', False)
    """

    what: str
    needed: bool
    meaning: str


@dataclass(frozen=True, repr=False)
class Plan:
    """The features that rendering a scene needs, and those that are left out. It prints as a table.

    Attributes
    ----------
    rows : tuple of PlanRow
        Every feature, whether this scene has it, and the consequence.

    See Also
    --------
    Scene.plan : Makes it.

    Examples
    --------
    >>> plan = rw.Scene(rw.Sphere()).plan()
    >>> plan.needed
    ('shapes',)
    """

    rows: tuple[PlanRow, ...]

    @property
    def needed(self) -> tuple[str, ...]:
        """Features that the scene needs."""
        return tuple(row.what for row in self.rows if row.needed)

    @property
    def left_out(self) -> tuple[str, ...]:
        """Features that are left out."""
        return tuple(row.what for row in self.rows if not row.needed)

    def _repr_html_(self) -> str:
        rows = [(row.what, "yes" if row.needed else "no", row.meaning) for row in self.rows]
        return html_table("What the scene needs", ("", "needed", ""), rows)

    def __repr__(self) -> str:
        lines = [("", "needed", "")]
        lines += [(row.what, "yes" if row.needed else "no", row.meaning) for row in self.rows]
        widths = [max(len(line[i]) for line in lines) for i in (0, 1)]
        return "\n".join(f"{a:<{widths[0]}}  {b:<{widths[1]}}  {c}".rstrip() for a, b, c in lines)
