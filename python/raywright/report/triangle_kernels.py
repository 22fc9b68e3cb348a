"""Error against time of the ways to meet a triangle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._core import KernelContest
from ..arrays import SeedLike, integer, seed_number
from .exact import ExactHits, exact_hits
from .pairs import FAMILIES, Pairs, family
from .table import Chart, Column, Table

_TITLE = "Ray-triangle routines: error against time"
_COLUMNS = (
    Column("family", "pairs"),
    Column("routine", "routine"),
    Column("ns", "ns/test", ".1f"),
    Column("bytes", "bytes", "d"),
    Column("hits", "hits", ",d"),
    Column("missed", "missed", ",d"),
    Column("false_hits", "false", ",d"),
    Column("median_ulps", "median ulps", ".2g"),
    Column("max_ulps", "max ulps", ".2g"),
)


class KernelRow(NamedTuple):
    """Result of one routine on one family of pairs.

    Attributes
    ----------
    family : str
        Name of the family.
    routine : str
        Name of the routine.
    ns : float
        Nanoseconds per test, the median of several runs.
    bytes : int
        Bytes that the routine stores for a triangle.
    hits : int
        Number of pairs that hit, by exact arithmetic.
    missed, false_hits : int
        Wrong decisions: hits that the routine misses, and misses that it takes for hits.
    median_ulps, max_ulps : float or None
        Median and largest error of t where there is a hit and the routine finds it, in units in the last
        place of float32; None without such a hit.

    See Also
    --------
    report.KernelReport : The table of these rows.

    Examples
    --------
    >>> row = rw.report.kernels(pairs=10, repeats=1).rows[0]
    >>> row.family, row.wrong
    ('ordinary', 0)
    """

    family: str
    routine: str
    ns: float
    bytes: int
    hits: int
    missed: int
    false_hits: int
    median_ulps: float | None
    max_ulps: float | None

    @property
    def wrong(self) -> int:
        """Wrong decisions of either kind."""
        return self.missed + self.false_hits


@dataclass(frozen=True, repr=False)
class KernelReport(Table[KernelRow]):
    """Each routine on each family of pairs: `kernels` makes it.

    See Also
    --------
    report.kernels : Makes it.

    Examples
    --------
    >>> found = rw.report.kernels(pairs=10, repeats=1)
    >>> found.pairs, len(found.rows) % len(found.summary().rows)
    (10, 0)
    """

    pairs: int = 0

    def summary(self) -> Table[Any]:
        """Return one row for each routine: time and error on ordinary pairs, wrong decisions on all.

        Returns
        -------
        Table

        Examples
        --------
        >>> found = rw.report.kernels(pairs=10, repeats=1)
        >>> len(found.summary().rows) == len(set(found.column("routine")))
        True
        """
        families = list(dict.fromkeys(self.column("family")))
        columns = [
            Column("routine", "routine"),
            Column("ns", "ns/test", ".1f"),
            Column("bytes", "bytes", "d"),
        ]
        columns += [Column("max_ulps", "max ulps", ".2g")]
        columns += [Column(name, name, ",d") for name in families]
        rows = []
        for routine in dict.fromkeys(self.column("routine")):
            mine = self.where(routine=routine).rows
            rows.append((routine, mine[0].ns, mine[0].bytes, mine[0].max_ulps, *(row.wrong for row in mine)))
        notes = (
            f"Under the name of each family: wrong decisions, of {self.pairs:,} pairs.",
            f"ns and ulps: of {families[0]} pairs.",
        )
        return Table(_TITLE, tuple(columns), tuple(rows), notes, Chart("ns", "max_ulps", "routine"))


def kernels(pairs: int = 10_000, seed: SeedLike = 0, repeats: int = 15) -> KernelReport:
    """Measure error and time of every ray-triangle routine on pairs of a ray and a triangle.

    Families of pairs: ordinary; slivers of aspect 1e3 to 1e8; grazing rays at a sine of 1e-7 to 1e-3; origins
    1e3 to 1e8 sizes away; rays aimed at edges and vertices; scales of 1e-18 to 1e18. About half of the rays
    hit, in random order. All numbers are float32, and results are compared with exact integer arithmetic on
    these numbers. (A wrong decision need not be a leak: most routines agree with themselves on an edge that
    two triangles share.)

    The routines: Möller and Trumbore (1997) with edges stored and without; Badouel (1990); signed volumes
    (Segura and Feito 2001); Woop, Benthin and Wald (2013); and the edge form in float32, and in float64 with
    an exact fallback, which is the library's own. Each tests one triangle at a time on one thread; terms that
    depend only on the ray are computed beforehand, and not timed. (Scenes use the same float64 test, after a
    vectorized float32 test has rejected most triangles.)

    Parameters
    ----------
    pairs : int
        Pairs in each family, 1 to 100,000.
    seed : int, Generator or SeedSequence
        Seed of the pairs; the same seed gives the same pairs and errors.
    repeats : int
        Number of timings of each routine, 1 to 10,000; the result is the median. Routines take turns, so
        other load on the machine affects all equally.

    Returns
    -------
    KernelReport
        A row for each family and routine. ``print`` shows it, ``summary()`` has a row for each routine, and
        ``plot()`` sets error against time.

    Raises
    ------
    ValueError
        If a number is outside its range.
    TypeError
        If an argument is not an integer.

    See Also
    --------
    report.accelerators : Whole scenes.

    Examples
    --------
    >>> found = rw.report.kernels(pairs=10, repeats=1)
    >>> bool(min(found.column("ns")) > 0)
    True
    """
    pairs = integer("pairs", pairs, 1, 100_000)
    seed = seed_number(seed)
    repeats = integer("repeats", repeats, 1, 10_000)
    rows: list[KernelRow] = []
    for name in FAMILIES:
        rows += _rows(name, family(name, pairs, seed), repeats)
    notes = (
        f"{pairs:,} pairs of each kind, seed {seed}; ns/test: median of {repeats} runs.",
        "missed, false: hits not found and misses taken for hits, by exact arithmetic.",
        "ulps: the error of t, where a hit is found, in units in the last place of a float32.",
    )
    return KernelReport(
        _TITLE, _COLUMNS, tuple(rows), notes, Chart("ns", "max_ulps", "routine", "family"), pairs
    )


def _rows(name: str, pairs: Pairs, repeats: int) -> list[KernelRow]:
    contest = KernelContest(pairs.origins, pairs.directions, pairs.corners.reshape(-1, 9))
    rounds = [contest.round() for _ in range(repeats)]
    seconds = np.median(np.array(rounds), axis=0) / len(pairs)
    truth = exact_hits(pairs.origins, pairs.directions, pairs.corners)
    return [
        _row(name, routine, bytes_, float(seconds[i] * 1e9), contest.answers(i)[0], truth)
        for i, (routine, bytes_) in enumerate(contest.routines)
    ]


def _row(
    name: str, routine: str, bytes_: int, ns: float, t: NDArray[np.float64], truth: ExactHits
) -> KernelRow:
    found = np.isfinite(t)
    ulps = truth.ulps(t)
    return KernelRow(
        name,
        routine,
        ns,
        bytes_,
        hits=int(truth.hit.sum()),
        missed=int((truth.hit & ~found).sum()),
        false_hits=int((found & ~truth.hit).sum()),
        median_ulps=float(np.median(ulps)) if len(ulps) else None,
        max_ulps=float(ulps.max()) if len(ulps) else None,
    )
