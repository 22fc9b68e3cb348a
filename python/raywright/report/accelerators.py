"""Accelerators side by side, on the same rays."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..accelerators import Accelerator, every, name_of
from ..arrays import SeedLike, integer, seed_number, thread_limit
from ..scene.scene import Scene
from .contest import Measured, measured
from .per_build import COUNTS, RaysPerBuild, rays_per_build_of
from .ray_sets import Rays, ray_sets
from .table import Chart, Column, Table


@dataclass(frozen=True, repr=False)
class AcceleratorReport(Table[tuple[Any, ...]]):
    """A row for each accelerator: `accelerators` makes it.

    Attributes
    ----------
    measured : tuple of Measured
        All measurements, for each set of rays.

    See Also
    --------
    report.accelerators : Makes it.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=8)
    >>> choices = {"bvh": rw.BVH(), "grid": rw.accelerators.Grid()}
    >>> report = rw.report.accelerators(scene, camera, choices, repeats=1, check=20)
    >>> report.column("accelerator"), report.column("wrong")
    (('bvh', 'grid'), (0, 0))
    """

    measured: tuple[Measured, ...] = ()

    def by_rays(self) -> Table[Any]:
        """Return a row for each set of rays and each accelerator.

        Returns
        -------
        Table

        See Also
        --------
        report.typical_rays : The sets of rays.

        Examples
        --------
        >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
        >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=8)
        >>> choices = {"bvh": rw.BVH(), "grid": rw.accelerators.Grid()}
        >>> report = rw.report.accelerators(scene, camera, choices, repeats=1, check=20)
        >>> len(report.by_rays().rows)
        6
        """
        columns = (
            Column("rays", "rays"),
            Column("accelerator", "accelerator"),
            Column("nodes", "nodes/ray", ".2f"),
            Column("primitives", "tests/ray", ".2f"),
            Column("mrays", "Mrays/s", ".3f"),
            Column("timed", "timed", ",d"),
            Column("checked", "checked", ",d"),
            Column("wrong", "wrong", ",d"),
        )
        rows = [
            (
                name,
                one.name,
                one.nodes[name],
                one.primitives[name],
                1e-6 / one.seconds_per_ray[name],
                one.rays[name],
                one.checked[name],
                one.wrong[name],
            )
            for name in (self.measured[0].rays if self.measured else ())
            for one in self.measured
        ]
        chart = Chart("primitives", "mrays", "accelerator", "rays")
        return Table(self.title, columns, tuple(rows), self.notes, chart)

    def rays_per_build(self, counts: Sequence[float] = COUNTS) -> RaysPerBuild:
        """Rank the accelerators by rays a second, builds included, for some numbers of rays.

        Arguments and errors are those of `rays_per_build`; nothing is measured anew.

        Parameters
        ----------
        counts : sequence of numbers
            Numbers of rays traced after a build: whole numbers, at least 1.

        Returns
        -------
        RaysPerBuild

        Raises
        ------
        ValueError, TypeError
            As `raywright.report.rays_per_build` does.

        See Also
        --------
        report.rays_per_build : Measures first.

        Examples
        --------
        >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
        >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=8)
        >>> choices = {"bvh": rw.BVH(), "grid": rw.accelerators.Grid()}
        >>> report = rw.report.accelerators(scene, camera, choices, repeats=1, check=20)
        >>> len(report.rays_per_build([1000, 1e6]).rows)
        4
        """
        return rays_per_build_of(
            [
                (one.name, one.build_seconds, statistics.mean(one.seconds_per_ray.values()))
                for one in self.measured
            ],
            counts,
        )


def accelerators(
    scene: Scene,
    rays: Any = None,
    accelerators: Any = None,
    threads: int | None = 1,
    repeats: int = 5,
    check: int | None = None,
    seed: SeedLike = 0,
) -> AcceleratorReport:
    """Compare accelerators on the same rays: build time, memory, and time of rays.

    Every accelerator is built over the scene's shapes. They take turns on each set of rays, and each turn
    starts with a different one, so other load on the machine affects all equally; results are medians over
    the turns. All of them are in memory at once.

    Parameters
    ----------
    scene : Scene
        The scene; its own accelerator does not matter.
    rays : Camera, Rays, (origins, directions), or dict of these by names, optional
        Rays to trace. A camera stands for its primary, diffuse and shadow rays, as in `typical_rays`; by
        default a camera outside with all of the scene in view.
    accelerators : accelerator, list of them, or dict of them by names, optional
        Accelerators to compare. By default all, with default options and with each builder and traversal.
    threads : int or None
        Number of threads that trace rays; None is all cores. Builds take all cores in any case.
    repeats : int
        Number of turns of each accelerator, and of builds, within a second in all.
    check : int, optional
        Number of rays compared with brute force, of all sets together. If not given, the number that brute
        force traces in a second or two, but at least 300.
    seed : int, Generator or SeedSequence
        Seed of the directions of diffuse rays and of the points on lamps.

    Returns
    -------
    AcceleratorReport
        Columns: `accelerator`, its name; `kind`; `build_seconds`, the median; `bytes`; `nodes`; `depth`;
        `sah_cost`, None where there is no such cost; `nodes_per_ray` and `tests_per_ray`, nodes visited and
        primitives tested for a ray's closest hit, the mean over all sets of rays; then for each set the
        million rays a second, by its name; `checked`, the number of rays compared with brute force; `wrong`,
        the number of these that differ in hit, t, shape or primitive. ``plot()`` sets rays a second of the
        first set against time to build.

    Raises
    ------
    ValueError
        If the scene is empty and no rays are given, no primary ray hits, a set is empty, a number is out of
        its range, or an accelerator is given twice.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    report.rays_per_build : Builds included.
    report.heatmap : The cost of each pixel.

    Notes
    -----
    An accelerator that would take more than about a second for a set is timed on fewer rays of it, evenly
    spread, with a note on their number. A sparse set of an image's rays is less coherent, so each may take
    longer.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=8)
    >>> choices = {"bvh": rw.BVH(), "grid": rw.accelerators.Grid()}
    >>> report = rw.report.accelerators(scene, camera, choices, repeats=1, check=20)
    >>> report.column("checked"), report.column("wrong")
    ((18, 18), (0, 0))
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene must be a Scene, got {type(scene).__name__}")
    chosen = named_accelerators(accelerators)
    threads = thread_limit(threads)
    repeats = integer("repeats", repeats, 1, 10_000)
    check = None if check is None else integer("check", check, 1)
    sets = ray_sets(scene, rays, seed_number(seed))
    return _report(measured(scene, sets, chosen, threads, repeats, check), sets, threads, repeats)


def rays_per_build(
    scene: Scene,
    accelerators: Any = None,
    counts: Sequence[float] = COUNTS,
    rays: Any = None,
    threads: int | None = None,
    repeats: int = 5,
    seed: SeedLike = 0,
) -> RaysPerBuild:
    """Rank accelerators by rays a second, builds included.

    A changing scene is rebuilt again and again: with few rays in between, a good tree does not pay. Times to
    build and rays a second are measured as in `accelerators`; times for more rays are extrapolated.

    Parameters
    ----------
    scene, accelerators, rays, threads, repeats, seed
        As in `accelerators`; by default rays take all cores, as builds do.
    counts : sequence of numbers
        Numbers of rays traced after a build: whole numbers, at least 1.

    Returns
    -------
    RaysPerBuild
        For each count a row for each accelerator, the fastest first. ``best()`` has a row for each count;
        ``plot()`` sets rays a second against their number.

    Raises
    ------
    ValueError, TypeError
        As `accelerators`; also if a count is below 1 or not whole, or there is none.

    See Also
    --------
    report.accelerators : All measurements.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=8)
    >>> choices = {"bvh": rw.BVH(), "grid": rw.accelerators.Grid()}
    >>> report = rw.report.rays_per_build(scene, choices, [1e3, 1e6], camera, repeats=1)
    >>> [column.name for column in report.columns]
    ['rays', 'accelerator', 'seconds', 'mrays', 'build_share']
    """
    rays_per_build_of([], counts)
    report = _accelerators(scene, rays, accelerators, threads, repeats, None, seed)
    return report.rays_per_build(counts)


# `rays_per_build` has an argument of the same name.
_accelerators = accelerators


def named_accelerators(accelerators: Any) -> dict[str, Accelerator]:
    """Return accelerators by name, from the argument of a report; all that there are for None.

    Raises
    ------
    ValueError
        If one is there twice, or none.
    TypeError
        If something is not an accelerator.
    """
    if accelerators is None:
        return every()
    if isinstance(accelerators, Accelerator):
        accelerators = [accelerators]
    if not isinstance(accelerators, Mapping | Iterable) or isinstance(accelerators, str):
        raise TypeError(f"accelerators must be a list or a dict, got {type(accelerators).__name__}")
    if isinstance(accelerators, Mapping):
        found = {str(name): one for name, one in accelerators.items()}
        given = list(found.values())
    else:
        given = list(accelerators)
        found = {}
    for one in given:
        if not isinstance(one, Accelerator):
            raise TypeError(f"accelerators must be raywright accelerators, got {type(one).__name__}")
        if not isinstance(accelerators, Mapping):
            if name_of(one) in found:
                raise ValueError(f"accelerators must differ, got {name_of(one)} twice")
            found[name_of(one)] = one
    if not found:
        raise ValueError("accelerators must not be empty")
    return found


def _report(
    entries: list[Measured], sets: dict[str, Rays], threads: int | None, repeats: int
) -> AcceleratorReport:
    columns = (
        Column("accelerator", "accelerator"),
        Column("kind", "kind"),
        Column("build_seconds", "build s", ".4f"),
        Column("bytes", "bytes", ",d"),
        Column("nodes", "nodes", ",d"),
        Column("depth", "depth", "d"),
        Column("sah_cost", "SAH", ".4g"),
        Column("nodes_per_ray", "nodes/ray", ".1f"),
        Column("tests_per_ray", "tests/ray", ".1f"),
        *(Column(name, name, ".3f") for name in sets),
        Column("checked", "checked", ",d"),
        Column("wrong", "wrong", ",d"),
    )
    primitives = entries[0].info.primitives
    on = "all cores" if threads is None else f"{threads} thread{'s' if threads > 1 else ''}"
    notes = [
        f"{', '.join(sets)}: million rays a second on {on}, medians of {repeats} turns; "
        f"of {', '.join(f'{rays.count:,}' for rays in sets.values())} rays.",
        "wrong: of the rays checked, those that brute force answers otherwise.",
    ]
    fewer = []
    for one in entries:
        few = [f"{count:,} {key}" for key, count in one.rays.items() if count < sets[key].count]
        if few:
            fewer.append(f"{one.name} ({', '.join(few)})")
    if fewer:
        notes.append(f"Timed on fewer rays: {', '.join(fewer)}.")
    title = f"Accelerators over {primitives:,} primitives"
    rows = tuple(_row(one, sets) for one in entries)
    chart = Chart("build_seconds", next(iter(sets)), "accelerator", "accelerator")
    return AcceleratorReport(title, columns, rows, tuple(notes), chart, tuple(entries))


def _row(one: Measured, sets: dict[str, Rays]) -> tuple[Any, ...]:
    weights = [rays.count for rays in sets.values()]
    means = [float(np.average(list(per.values()), weights=weights)) for per in (one.nodes, one.primitives)]
    info = one.info
    return (
        one.name,
        type(one.accelerator).__name__,
        one.build_seconds,
        info.bytes,
        info.nodes,
        info.depth,
        info.sah_cost if np.isfinite(info.sah_cost) else None,
        *means,
        *(1e-6 / seconds for seconds in one.seconds_per_ray.values()),
        sum(one.checked.values()),
        sum(one.wrong.values()),
    )
