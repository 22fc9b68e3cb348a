"""What a scene needs, and what is left out."""

from dataclasses import dataclass

from ..html_tables import html_table


@dataclass(frozen=True)
class PlanRow:
    """A line of a `Plan`: what it is about, whether the scene has it, and what follows."""

    what: str
    needed: bool
    meaning: str


@dataclass(frozen=True, repr=False)
class Plan:
    """What a scene needs of those who render it, and which kernel does. It prints as a table.

    Attributes
    ----------
    kernel : str
        The loop that paths are traced by: ``"plain"`` (one diffuse colour a shape), ``"open"`` (any material)
        or ``"general"`` (masks, media in one another, filtered textures too). All give the same picture, bit
        for bit, where they can.
    rows : tuple of PlanRow
        What there may be in a scene, whether this one has it, and what that means.
    """

    kernel: str
    rows: tuple[PlanRow, ...]

    @property
    def needed(self) -> tuple[str, ...]:
        """What the scene needs."""
        return tuple(row.what for row in self.rows if row.needed)

    @property
    def left_out(self) -> tuple[str, ...]:
        """What it does without."""
        return tuple(row.what for row in self.rows if not row.needed)

    def _repr_html_(self) -> str:
        rows = [(row.what, "yes" if row.needed else "no", row.meaning) for row in self.rows]
        return html_table(f"kernel: {self.kernel}", ("", "needed", ""), rows)

    def __repr__(self) -> str:
        lines = [("", "needed", f"kernel: {self.kernel}")]
        lines += [(row.what, "yes" if row.needed else "no", row.meaning) for row in self.rows]
        widths = [max(len(line[i]) for line in lines) for i in (0, 1)]
        return "\n".join(f"{a:<{widths[0]}}  {b:<{widths[1]}}  {c}".rstrip() for a, b, c in lines)
