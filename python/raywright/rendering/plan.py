"""What was chosen for a render, and why."""

from dataclasses import dataclass, replace

from ..html_tables import html_table
from ..integrators import Path
from .samplers import Sampler


@dataclass(frozen=True)
class Choice:
    """A line of a `RenderPlan`: what it is about, what was chosen, and why."""

    what: str
    chosen: str
    why: str


@dataclass(frozen=True, repr=False)
class RenderPlan:
    """How a picture was rendered where that could be one way or another. It prints as a table.

    What the user names is used as named, and has a row too.

    Attributes
    ----------
    rows : tuple of Choice
        What there was to choose, what it is, and why. None for a picture that was not rendered.
    sampler : Independent, Stratified, Halton, Sobol or Lattice, or None
        Where the random numbers came from. With this, and as many samples, the same seed gives the same
        picture, whatever ended it.
    path : Path or None
        The path tracer, with all that was chosen for it; None for other kinds of integrators.
    """

    rows: tuple[Choice, ...] = ()
    sampler: Sampler | None = None
    path: Path | None = None

    def __getitem__(self, what: str) -> Choice:
        """Return the row about something.

        Raises
        ------
        KeyError
            If there is none.
        """
        for row in self.rows:
            if row.what == what:
                return row
        raise KeyError(what)

    def explained(self, what: str, why: str) -> "RenderPlan":
        """Return the plan with one more reason in the row about something."""
        rows = (replace(row, why=f"{row.why}; {why}") if row.what == what else row for row in self.rows)
        return replace(self, rows=tuple(rows))

    def _repr_html_(self) -> str:
        rows = [(row.what, row.chosen, row.why) for row in self.rows]
        return html_table("How the picture was rendered", ("", "chosen", "why"), rows)

    def __repr__(self) -> str:
        lines = [("", "chosen", "why"), *((row.what, row.chosen, row.why) for row in self.rows)]
        widths = [max(len(line[i]) for line in lines) for i in (0, 1)]
        return "\n".join(f"{a:<{widths[0]}}  {b:<{widths[1]}}  {c}".rstrip() for a, b, c in lines)
