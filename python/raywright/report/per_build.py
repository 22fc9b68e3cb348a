"""Rays per build: which accelerator is done first with building itself and tracing so many rays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from ..arrays import real_array
from .table import Chart, Column, Table

COUNTS = (1e4, 1e5, 1e6, 1e7, 1e8, 1e9)
"""How many rays are traced after a build, if nobody says."""

_TITLE = "Rays per build: rays a second, with the build counted in"


class BuildRow(NamedTuple):
    """Time of one accelerator for a build and a number of rays.

    Attributes
    ----------
    rays : int
        Number of rays traced after the build.
    accelerator : str
        Name of the accelerator.
    seconds : float
        Build and rays together.
    mrays : float
        Million rays a second in all.
    build_share : float
        Part of the time that the build takes, 0 to 1.

    See Also
    --------
    report.RaysPerBuild : The table of these rows.

    Examples
    --------
    >>> rw.report.BuildRow(1000, "BVH", seconds=0.5, mrays=0.002, build_share=0.9).accelerator
    'BVH'
    """

    rays: int
    accelerator: str
    seconds: float
    mrays: float
    build_share: float


@dataclass(frozen=True, repr=False)
class RaysPerBuild(Table[BuildRow]):
    """For each number of rays a row for each accelerator, the fastest first: `rays_per_build` makes it.

    See Also
    --------
    report.rays_per_build : Makes it.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=8)
    >>> choices = {"bvh": rw.BVH(), "grid": rw.accelerators.Grid()}
    >>> report = rw.report.accelerators(scene, camera, choices, repeats=1, check=20)
    >>> table = report.rays_per_build([1000])
    >>> sorted(table.column("accelerator"))
    ['bvh', 'grid']
    """

    def best(self) -> Table[Any]:
        """Return a row for each number of rays: the fastest accelerator, the second, and their ratio.

        `ratio` is how many times as long the second takes.

        Returns
        -------
        Table

        Examples
        --------
        >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
        >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=8)
        >>> choices = {"bvh": rw.BVH(), "grid": rw.accelerators.Grid()}
        >>> report = rw.report.accelerators(scene, camera, choices, repeats=1, check=20)
        >>> len(report.rays_per_build([1000, 10000]).best().rows)
        2
        """
        columns = (
            Column("rays", "rays", ",d"),
            Column("accelerator", "fastest"),
            Column("mrays", "Mrays/s in all", ".3f"),
            Column("build_share", "of it build", ".1%"),
            Column("second", "second"),
            Column("ratio", "takes", ".2f"),
        )
        rows: list[tuple[Any, ...]] = []
        for rays in dict.fromkeys(self.column("rays")):
            first, *others = self.where(rays=rays).rows
            second = (others[0].accelerator, others[0].seconds / first.seconds) if others else (None, None)
            rows.append((rays, first.accelerator, first.mrays, first.build_share, *second))
        notes = ("takes: time of the second, in times of the fastest.",)
        return Table(self.title, columns, tuple(rows), notes, Chart("rays", "mrays", "accelerator"))


def rays_per_build_of(
    costs: Iterable[tuple[str, float, float]], counts: Sequence[float] = COUNTS
) -> RaysPerBuild:
    """Return the report for accelerators of known costs.

    Parameters
    ----------
    costs : iterable of (str, float, float)
        Name, seconds to build, and seconds a ray.
    counts : sequence of numbers
        Numbers of rays traced after a build: whole numbers, at least 1.

    Raises
    ------
    ValueError
        If a count is below 1 or not whole, or there is none.
    TypeError
        If counts are not numbers.
    """
    numbers = real_array("counts", counts)
    if numbers.ndim != 1 or not numbers.size:
        raise ValueError(f"counts must be a list of numbers, got shape {numbers.shape}")
    for count in numbers.tolist():
        if not (count >= 1 and count == count // 1):
            raise ValueError(f"counts must be whole and at least 1, got {count:g}")
    costs = list(costs)
    rows: list[BuildRow] = []
    for count in sorted({int(number) for number in numbers}):
        some = [_row(name, build, each, count) for name, build, each in costs]
        rows += sorted(some, key=lambda row: row.seconds)
    columns = (
        Column("rays", "rays", ",d"),
        Column("accelerator", "accelerator"),
        Column("seconds", "seconds", ".4g"),
        Column("mrays", "Mrays/s in all", ".3f"),
        Column("build_share", "of it build", ".1%"),
    )
    notes = ("From measured times to build and measured rays a second, the mean over all sets of rays.",)
    return RaysPerBuild(
        _TITLE, columns, tuple(rows), notes, Chart("rays", "mrays", "accelerator", "accelerator", lines=True)
    )


def _row(name: str, build: float, each: float, count: int) -> BuildRow:
    seconds = build + count * each
    return BuildRow(count, name, seconds, 1e-6 * count / seconds, build / seconds)
