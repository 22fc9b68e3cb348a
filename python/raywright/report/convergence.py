"""Error against run time: which way of rendering a scene gives how good a picture, how soon."""

from __future__ import annotations

import inspect
import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import SeedLike, integer, positive, real_array, seed_number
from ..cameras import AnyCamera
from ..rendering.image import Image
from ..rendering.render import render
from ..scene.scene import Scene
from .table import Chart, Column, Table

LEVELS = 6
"""Budgets: the longest, a half of it, a quarter, ..."""

_TAKEN = ("scene", "camera", "samples", "error", "seconds", "seed", "progress")
_REFERENCE_SEED = 2**63

# Seconds, samples, the estimated error, the true one, and whether the estimate is trusted.
_Run = tuple[float, float, float, float, bool]


@dataclass(frozen=True)
class Fit:
    """Convergence of one contender: a power law of its error.

    Attributes
    ----------
    contender : str
    slope : float or None
        relMSE falls as seconds to this power, by least squares over logarithms: -1 for independent samples
        without overheads. None with fewer than two budgets.
    level : float or None
        The fitted relMSE of one second.
    gain : float or None
        Efficiency over the first contender: ratio of relMSE x seconds, by geometric means over budgets.

    See Also
    --------
    ConvergenceReport : Lists them in `fits`.

    Examples
    --------
    >>> rw.report.Fit("path", slope=-1.0, level=0.01, gain=1.0).slope
    -1.0
    """

    contender: str
    slope: float | None
    level: float | None
    gain: float | None


@dataclass(frozen=True, repr=False)
class ConvergenceReport(Table[tuple[Any, ...]]):
    """A row for each contender and budget: `convergence` makes it.

    Its plot is of relMSE over seconds, both logarithmic, with a fitted line for each contender; plots of
    other columns have no lines.

    Attributes
    ----------
    fits : tuple of Fit
        Fitted convergence of each contender.

    See Also
    --------
    report.convergence : Makes it.

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere(), environment=1.0)
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> found = rw.report.convergence(scene, camera, {"path": rw.Path()}, seconds=0.1, seeds=1)
    >>> len(found.rows), found.fits[0].contender
    (6, 'path')
    """

    fits: tuple[Fit, ...] = ()

    def _draw(self, ax: Any, chart: Chart) -> None:
        super()._draw(ax, chart)
        if (chart.x, chart.y) != ("seconds", "relmse"):
            return
        for i, fit in enumerate(self.fits):
            if fit.slope is not None and fit.level is not None:
                seconds = np.array(self.where(contender=fit.contender).column("seconds"))
                ends = np.array([seconds.min(), seconds.max()])
                ax.plot(ends, fit.level * ends**fit.slope, color=f"C{i}", linestyle="--", linewidth=1)
        handles, labels = ax.get_legend_handles_labels()
        slopes = {fit.contender: fit.slope for fit in self.fits if fit.slope is not None}
        told = [f"{name} (slope {slopes[name]:.2f})" if name in slopes else name for name in labels]
        ax.legend(handles, told, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def convergence(
    scene: Scene,
    camera: AnyCamera,
    contenders: Mapping[str, Any] | None = None,
    seconds: float = 4.0,
    reference: Image | ArrayLike | float | None = None,
    seeds: int | Sequence[SeedLike] = 3,
    threads: int | None = None,
) -> ConvergenceReport:
    """Compare integrators or options on a scene: relMSE over run time, and its rate of convergence.

    Each contender renders for `seconds`, a half of that, a quarter, and so on, six budgets in all, with each
    seed. They take turns, so other load on the machine affects all equally.

    Parameters
    ----------
    scene : Scene
        The scene.
    camera : Camera
        Camera of the picture.
    contenders : dict of str to integrator or dict, optional
        An integrator, or arguments of `render` by name, such as ``{"integrator": ..., "adaptive": True}``. If
        not given: path tracing with as many samples everywhere, and with adaptive sampling.
    seconds : float
        Longest budget of one render. In total the renders take twice as long, times contenders and seeds.
    reference : Image, (H, W, 3) array, or float, optional
        Reference picture, or seconds for rendering one with the first contender. If not given, errors are the
        renders' own estimates.
    seeds : int or sequence of int, Generator or SeedSequence
        Number of seeds, or the seeds.
    threads : int, optional
        Number of threads of each render, unless a contender gives its own; all cores if not given.

    Returns
    -------
    ConvergenceReport
        Columns: `contender`; `budget`, in seconds; `seconds`, the run time, median over seeds; `samples` per
        pixel, the median; `relmse`, the mean over seeds; `ratio` of the mean estimate to the mean true
        relMSE, None without a reference; `error_seconds`, relMSE times seconds, less being better; `trusted`,
        the share of seeds whose renders trust their own estimates. If the reference is an Image, or was
        rendered, its own estimated relMSE is subtracted.

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If there is no contender; if one has an argument that `render` does not take, or that the report sets;
        if a number is out of its range, or the reference has another size than the picture.

    See Also
    --------
    Image.table : The error of one render against time.

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere(), environment=1.0)
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> ways = {"path": rw.Path(), "direct": rw.Direct()}
    >>> found = rw.report.convergence(scene, camera, ways, seconds=0.1, seeds=1)
    >>> len(found.where(contender="direct").rows)
    6
    """
    ways = _contenders(contenders, threads)
    seconds = positive("seconds", seconds)
    numbers = _seeds(seeds)
    truth, doubt = _reference(scene, camera, reference, next(iter(ways.values())))
    runs: dict[tuple[str, int], list[_Run]] = {}
    for level in reversed(range(LEVELS)):
        for turn, seed in enumerate(numbers):
            for name in _rotated(list(ways), turn):
                image = render(
                    scene, camera, **ways[name], seconds=seconds / 2**level, seed=seed, progress=False
                )
                true = math.nan if truth is None else _relmse(image.rgb, truth) - doubt
                run = (image.seconds, image.samples, float(image.error), true, image.error.trusted)
                runs.setdefault((name, level), []).append(run)
    rows = [
        _row(name, seconds / 2**level, runs[name, level], truth is not None)
        for name in ways
        for level in reversed(range(LEVELS))
    ]
    return _report(camera, rows, list(ways), len(numbers), truth is not None, doubt)


def _contenders(contenders: Mapping[str, Any] | None, threads: int | None) -> dict[str, dict[str, Any]]:
    if contenders is None:
        contenders = {"path": {}, "path, adaptive": {"adaptive": True}}
    if not isinstance(contenders, Mapping):
        raise TypeError(f"contenders must be a dict, got {type(contenders).__name__}")
    if not contenders:
        raise ValueError("contenders must not be empty")
    known = [name for name in inspect.signature(render).parameters if name not in _TAKEN]
    ways = {}
    for name, one in contenders.items():
        arguments = dict(one) if isinstance(one, Mapping) else {"integrator": one}
        for argument in arguments:
            if argument not in known:
                raise ValueError(
                    f"contenders[{name!r}] has {argument!r}; expected some of {', '.join(known)}"
                )
        ways[name] = {"threads": threads, **arguments}
    return ways


def _seeds(seeds: int | Sequence[SeedLike]) -> list[int]:
    if isinstance(seeds, Sequence) and not isinstance(seeds, str):
        if not seeds:
            raise ValueError("seeds must not be empty")
        return [seed_number(seed, name="seeds") for seed in seeds]
    return list(range(integer("seeds", seeds, 1, 10_000)))


def _rotated(names: list[str], turn: int) -> list[str]:
    at = turn % len(names)
    return names[at:] + names[:at]


def _reference(
    scene: Scene, camera: AnyCamera, reference: Any, way: dict[str, Any]
) -> tuple[NDArray[np.float64] | None, float]:
    """Return the right picture, and its own relMSE as far as that is known."""
    if reference is None:
        return None, 0.0
    if isinstance(reference, (int, float)):
        limit = positive("reference", reference)
        reference = render(scene, camera, **way, seconds=limit, seed=_REFERENCE_SEED, progress=False)
    doubt = 0.0
    if isinstance(reference, Image):
        doubt = 0.0 if math.isnan(reference.error.estimate) else reference.error.estimate
        reference = reference.rgb
    picture = real_array("reference", reference).astype(np.float64, copy=False)
    wanted = (camera.height, camera.width, 3)
    if picture.shape != wanted:
        raise ValueError(f"reference must have shape {wanted} as the picture has, got {picture.shape}")
    if not np.isfinite(picture).all():
        raise ValueError("reference must be finite")
    return picture, doubt


def _relmse(picture: NDArray[np.float32], truth: NDArray[np.float64]) -> float:
    return float(np.mean(np.square(picture - truth) / (np.square(truth) + 0.01)))


def _row(name: str, budget: float, runs: list[_Run], against: bool) -> tuple[Any, ...]:
    seconds, samples, told, true, trusted = (list(values) for values in zip(*runs, strict=True))
    spent = statistics.median(seconds)
    estimate = _positive(statistics.fmean(told))
    error = _positive(statistics.fmean(true)) if against else estimate
    ratio = estimate / error if against and estimate is not None and error is not None else None
    product = None if error is None else error * spent
    share = statistics.fmean(trusted)
    return name, budget, spent, statistics.median(samples), error, ratio, product, share


def _positive(value: float) -> float | None:
    """Return what has a logarithm: less than nothing may be left of an error below that of its reference."""
    return value if 0 < value < math.inf else None


def _fitted(report: Table[Any], name: str, first: float | None) -> Fit:
    mine = report.where(contender=name)
    points = [(s, e) for s, e in zip(mine.column("seconds"), mine.column("relmse"), strict=True) if e]
    cost = _cost(mine)
    gain = None if cost is None or first is None else first / cost
    if len({s for s, _ in points}) < 2:
        return Fit(name, None, None, gain)
    line = np.polyfit([math.log(s) for s, _ in points], [math.log(e) for _, e in points], 1)
    return Fit(name, float(line[0]), math.exp(float(line[1])), gain)


def _cost(mine: Table[Any]) -> float | None:
    """Geometric mean of relMSE times seconds."""
    products = [value for value in mine.column("error_seconds") if value]
    return statistics.geometric_mean(products) if products else None


def _report(
    camera: AnyCamera, rows: list[tuple[Any, ...]], names: list[str], seeds: int, against: bool, doubt: float
) -> ConvergenceReport:
    columns = (
        Column("contender", "contender"),
        Column("budget", "budget s", ".3g"),
        Column("seconds", "seconds", ".3g"),
        Column("samples", "samples", "g"),
        Column("relmse", "relMSE", ".3g"),
        Column("ratio", "estimate / true", ".2f"),
        Column("error_seconds", "relMSE x s", ".3g"),
        Column("trusted", "trusted", ".0%"),
    )
    title = f"Error against run time, {camera.width} x {camera.height} pixels"
    chart = Chart("seconds", "relmse", "contender", "contender")
    table: Table[Any] = Table(title, columns, tuple(rows))
    first = _cost(table.where(contender=names[0]))
    fits = tuple(_fitted(table, name, first) for name in names)
    many = "one seed" if seeds == 1 else f"{seeds} seeds"
    if against:
        notes = [f"relMSE: against a reference, the mean over {many}."]
        if doubt > 0:
            notes.append(f"The reference's own relMSE of about {doubt:.2g} is taken off.")
    else:
        notes = [f"relMSE: as estimated by the renders themselves, the mean over {many}."]
    if any(row[-1] < 1 for row in rows):
        notes.append("Renders that are not trusted have found light too rarely to know their error.")
    for fit in fits:
        told = [] if fit.slope is None else [f"relMSE falls as seconds to the power of {fit.slope:.2f}"]
        if fit.gain is not None and fit is not fits[0]:
            told.append(f"{fit.gain:.2f} times less relMSE x seconds than {names[0]}")
        if told:
            notes.append(f"{fit.contender}: {', '.join(told)}.")
    return ConvergenceReport(title, columns, tuple(rows), tuple(notes), chart, fits)
