"""Options that a render has chosen, with reasons."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..html_tables import html_table
from ..integrators import Path
from .samplers import Sampler


@dataclass(frozen=True)
class Choice:
    """A row of a `RenderPlan`: an option, its value, and the reason.

    See Also
    --------
    RenderPlan : The table of these rows.

    Examples
    --------
    >>> rw.rendering.Choice("sampler", "Sobol", "batches are small")
    Choice(what='sampler', chosen='Sobol', why='batches are small')
    """

    what: str
    chosen: str
    why: str


@dataclass(frozen=True, repr=False)
class RenderPlan:
    """Options that were chosen automatically, with reasons. It prints as a table.

    Options that the user named are rows too.

    Attributes
    ----------
    rows : tuple of Choice
        Each option with its value and the reason. None for a picture that was not rendered.
    sampler : Independent, Stratified, Halton, Sobol or Lattice, or None
        Sampler of the random numbers. With this sampler and the same number of samples, the same seed gives
        the same picture, for any limit.
    path : Path or None
        The path tracer with the chosen options; None for other integrators.

    See Also
    --------
    Scene.plan : The features that a scene needs.

    Examples
    --------
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> image = rw.render(rw.Scene(rw.Sphere(emission=1.0)), camera, samples=4, seed=1, progress=False)
    >>> [row.what for row in image.plan.rows]
    ['sampler', 'batch', 'reuse', 'guiding']
    >>> image.plan.sampler
    Independent()
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

    def explained(self, what: str, why: str) -> RenderPlan:
        """Return the plan with a reason appended to the row of an option.

        Parameters
        ----------
        what : str
            Option of the row.
        why : str
            Reason to append.

        Returns
        -------
        RenderPlan

        Examples
        --------
        >>> plan = rw.rendering.RenderPlan((rw.rendering.Choice("sampler", "Sobol", "it is named"),))
        >>> plan.explained("sampler", "batches are small").rows[0].why
        'it is named; batches are small'
        """
        rows = (replace(row, why=f"{row.why}; {why}") if row.what == what else row for row in self.rows)
        return replace(self, rows=tuple(rows))

    def _repr_html_(self) -> str:
        rows = [(row.what, row.chosen, row.why) for row in self.rows]
        return html_table("How the picture was rendered", ("", "chosen", "why"), rows)

    def __repr__(self) -> str:
        lines = [("", "chosen", "why"), *((row.what, row.chosen, row.why) for row in self.rows)]
        widths = [max(len(line[i]) for line in lines) for i in (0, 1)]
        return "\n".join(f"{a:<{widths[0]}}  {b:<{widths[1]}}  {c}".rstrip() for a, b, c in lines)
