"""Simulated laser scans."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import SeedLike, choice, number, positive, seed_number
from ..io.value_plots import COLORS, Axis
from ..query.hits import Hits
from ..query.tabular import Tabular
from ..scene.progress import BuildProgress, check_progress, watcher
from ..scene.scene import Scene, SceneLike
from .noise import beams_of, normal, uniform
from .places import Floats, scene_of, touching
from .plots import plot
from .scanners import RasterLidar, SpinningLidar
from .waveforms import peaks

Lidar: TypeAlias = SpinningLidar | RasterLidar
Returns: TypeAlias = Literal["all", "first", "last", "strongest"]
# Rays per batch.
_TOGETHER = 1 << 19
# The largest incidence in degrees that counts: ranges vary by 10,000 times the width of the beam there.
_GRAZING = 89.995


@dataclass(frozen=True, eq=False, repr=False)
class LidarScan(Tabular):
    """A laser scan: K returns in all, by beam and then by range.

    Attributes
    ----------
    beam : (K,) int64
        Index of the beam of each return, along `shape` in C order.
    number : (K,) int32
        Number of the return within its beam, from 0 on, before any were left out.
    range : (K,) float64
        Measured range: with its noise, from the scanner's `min_range` to its `max_range`.
    position : (K, 3) float64
        Measured position: on the axis of the beam, at the range.
    incidence : (K,) float64
        Angle between the beam and the normal of the surface, in degrees, 0 to 90; the mean over the
        footprint.
    strength : (K,) float64
        Share of the beam that reached the surface there, 0 to 1.
    shape_id, primitive_id : (K,) int32
        First shape and primitive of the return, as in `Hits`.
    shape : tuple of int
        Shape of the beams: rows and columns.

    See Also
    --------
    measure.lidar : Makes it.

    Examples
    --------
    >>> scanner = rw.measure.SpinningLidar(elevations=[-45, 0], columns=4, position=(0, 1, 0))
    >>> scan = rw.measure.lidar(rw.Plane(normal=(0, 1, 0)), scanner)
    >>> scan.count.tolist(), scan.range.round(4).tolist()
    ([[1, 1, 1, 1], [0, 0, 0, 0]], [1.4142, 1.4142, 1.4142, 1.4142])
    """

    beam: NDArray[np.int64]
    number: NDArray[np.int32]
    range: Floats
    position: Floats
    incidence: Floats
    strength: Floats
    shape_id: NDArray[np.int32]
    primitive_id: NDArray[np.int32]
    shape: tuple[int, ...] = field(default=())

    @property
    def count(self) -> NDArray[np.int64]:
        """Number of returns of each beam: int64 of the scanner's shape."""
        return np.bincount(self.beam, minlength=math.prod(self.shape)).reshape(self.shape)

    def image(self, name: str = "range", fill: float = np.nan) -> Floats:
        """Return the first return of each beam as an array of the scanner's shape.

        Parameters
        ----------
        name : {"range", "incidence", "strength"}
            Quantity of the returns.
        fill : float
            Value of beams without a return.

        Returns
        -------
        (rows, columns) float64 array

        Raises
        ------
        ValueError
            If there is no such name.

        See Also
        --------
        LidarScan.count : The number of returns of each beam.

        Examples
        --------
        >>> scanner = rw.measure.SpinningLidar(elevations=[-30, 0], columns=2, position=(0, 1, 0))
        >>> scan = rw.measure.lidar(rw.Plane(normal=(0, 1, 0)), scanner)
        >>> scan.image(fill=0).round(6).tolist(), scan.image("incidence", fill=0).round(6).tolist()
        ([[2.0, 2.0], [0.0, 0.0]], [[60.0, 60.0], [0.0, 0.0]])
        """
        choice("name", name, ("range", "incidence", "strength"))
        whole = np.full(math.prod(self.shape), fill, np.float64)
        first = np.flatnonzero(np.diff(self.beam, prepend=-1))
        whole[self.beam[first]] = getattr(self, name)[first]
        return whole.reshape(self.shape)

    def plot(self, ax: Any = None, name: str = "range", up: Axis = "y", cmap: Any = COLORS) -> Any:
        """Draw the returns in space with matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, str or path, optional
            Target: a new figure if not given, axes with three dimensions, or a file, .png, .svg or .pdf.
        name : {"range", "incidence", "strength"}
            Values that are colored.
        up : {"x", "y", "z"}
            The axis that points up.
        cmap : str or matplotlib.colors.Colormap
            The colors, from the least value to the largest.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ImportError, ValueError, TypeError, OSError
            As `raywright.measure.plot` does, and if there is no such name.

        See Also
        --------
        measure.plot : Draw values on meshes.

        Examples
        --------
        >>> from matplotlib import pyplot as plt
        >>> scanner = rw.measure.SpinningLidar(elevations=[-30], columns=8, position=(0, 1, 0))
        >>> scan = rw.measure.lidar(rw.Plane(normal=(0, 1, 0)), scanner)
        >>> axes = scan.plot(plt.figure().add_subplot(projection="3d"))
        >>> len(axes.collections)
        1
        """
        choice("name", name, ("range", "incidence", "strength"))
        return plot((), getattr(self, name), self.position, ax, name, up, cmap)

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return flat arrays by name, an entry for each return, with its position as x, y and z.

        Returns
        -------
        dict
            An array for each column.

        Examples
        --------
        >>> scanner = rw.measure.SpinningLidar(elevations=[-30], columns=2, position=(0, 1, 0))
        >>> scan = rw.measure.lidar(rw.Plane(normal=(0, 1, 0)), scanner)
        >>> scan.to_dict()["y"].round(9).tolist()
        [0.0, 0.0]
        """
        names = ("beam", "number", "range", "incidence", "strength", "shape_id", "primitive_id")
        columns = {name: getattr(self, name) for name in names}
        return columns | dict(zip("xyz", self.position.T, strict=True))

    def __len__(self) -> int:
        return len(self.beam)

    def __repr__(self) -> str:
        return f"LidarScan(shape={self.shape}, {len(self)} returns of {math.prod(self.shape)} beams)"


def lidar(
    scene: SceneLike,
    scanner: Lidar,
    returns: Returns = "all",
    range_sigma: float = 0.0,
    range_sigma_share: float = 0.0,
    dropout: float = 0.0,
    fading_range: float | None = None,
    incidence_power: float = 0.0,
    seed: SeedLike = 0,
    progress: BuildProgress | None = None,
    threads: int | None = None,
) -> LidarScan:
    """Scan a scene with a laser scanner that stands still.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that Scene takes
        The scanned scene.
    scanner : SpinningLidar or RasterLidar
        Scanner with its position and beams.
    returns : {"all", "first", "last", "strongest"}
        Returns of a beam to keep. A beam without divergence has at most one.
    range_sigma, range_sigma_share : float
        Absolute and relative standard deviation of the range; they add in quadrature.
    dropout : float
        Share of returns that are lost at any range, 0 to 1.
    fading_range : float, optional
        Returns are kept with the probability exp(-(range / fading_range)^2); all if not given.
    incidence_power : float
        Returns are kept with the probability cos(incidence)^`incidence_power`; 0 keeps all.
    seed : int, Generator or SeedSequence
        Seed of the random numbers, 0 to 2**64 - 1.
    progress : bool or callable, optional
        As for `sky_view`.
    threads : int, optional
        Number of threads; all cores if not given. The answer does not depend on it.

    Returns
    -------
    LidarScan
        By beam, then by range.

    Raises
    ------
    ValueError
        If a number is out of its range or not finite, or `returns` is none of these.
    TypeError
        If `scanner` is not a scanner, or something else is of the wrong type.

    See Also
    --------
    measure.line_of_sight : Pairs of points.
    Scene.intersect : Rays without a scanner.

    Notes
    -----
    A beam with a divergence is many rays, spread evenly over its disk, each for the part of the disk around
    it. The beam returns a waveform: the sum of a normal distribution for each ray, as wide as the scanner's
    pulse, with a full width at half maximum of `resolution`, plus the variation of the range over the ray's
    part of the surface. Each peak is a return if the waveform falls by at least 5 % before the next one
    (Wagner, Ullrich, Ducic, Melzer and Studnicka, "Gaussian Decomposition and Calibration of a Novel
    Small-Footprint Full-Waveform Digitising Airborne Laser Scanner", 2006); its range is the mean over the
    contributing rays. Thus ground at a grazing angle returns once, even over many resolutions.

    Losses depend on true ranges, before noise. Noisy ranges are clamped to the scanner's limits. Random
    numbers depend on beam and return only, so a scan does not depend on batches, and one kind of noise does
    not change another.

    Examples
    --------
    >>> scanner = rw.measure.RasterLidar(horizontal=0, vertical=0, columns=1, rows=1)
    >>> scan = rw.measure.lidar(rw.Sphere((5, 0, 0)), scanner)
    >>> scan.range.tolist(), scan.position.tolist()
    ([4.0], [[4.0, 0.0, 0.0]])
    >>> noisy = rw.measure.lidar(rw.Sphere((5, 0, 0)), scanner, range_sigma=0.01, seed=3)
    >>> bool(abs(noisy.range[0] - 4) < 0.06)
    True
    """
    if not isinstance(scanner, SpinningLidar | RasterLidar):
        raise TypeError(f"scanner must be a SpinningLidar or a RasterLidar, got {type(scanner).__name__}")
    choice("returns", returns, get_args(Returns))
    sigmas = _at_least_0("range_sigma", range_sigma), _at_least_0("range_sigma_share", range_sigma_share)
    lost = number("dropout", dropout)
    if not 0 <= lost <= 1:
        raise ValueError(f"dropout must be between 0 and 1, got {dropout}")
    fading = math.inf if fading_range is None else positive("fading_range", fading_range)
    power = _at_least_0("incidence_power", incidence_power)
    seed = seed_number(seed)
    if progress is not None:
        check_progress(progress)
    scene = scene_of(scene)
    middles = scanner.directions().reshape(-1, 3)
    step = max(_TOGETHER // scanner.rays, 1)
    parts = []
    with watcher(progress, "lidar") as report:
        for start in range(0, len(middles), step):
            beams = np.arange(start, min(start + step, len(middles)))
            parts.append(_scanned(scene, scanner, middles, beams, seed, threads))
            if report is not None:
                report((beams[-1] + 1) / len(middles))
    found = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    beam, which, true = found["beam"], found["number"], found["range"]
    kept = np.full(len(beam), 1.0 - lost) * np.exp(-((true / fading) ** 2))
    kept *= np.cos(np.radians(found["incidence"])) ** power
    chosen = (uniform(seed, beam, which, 1) < kept) & _chosen(returns, beam, which, found["strength"])
    spread = np.sqrt(sigmas[0] ** 2 + (sigmas[1] * true) ** 2)
    measured = true + spread * normal(seed, beam, which, 2)
    found["range"] = np.clip(measured, scanner.min_range, scanner.max_range)
    found["position"] = np.asarray(scanner.position) + found["range"][:, None] * middles[beam]
    return LidarScan(**{k: v[chosen] for k, v in found.items()}, shape=scanner.shape)


def _at_least_0(name: str, value: float) -> float:
    result = number(name, value)
    if result < 0:
        raise ValueError(f"{name} must be at least 0, got {value}")
    return result


def _scanned(
    scene: Scene,
    scanner: Lidar,
    middles: Floats,
    beams: NDArray[np.int64],
    seed: int,
    threads: int | None,
) -> dict[str, NDArray[Any]]:
    """Return the returns of some beams, without noise."""
    ways = beams_of(middles[beams], beams, scanner.divergence, scanner.rays, seed)
    place = np.asarray(scanner.position)
    at = touching(scene, place, threads)
    starts = place if at.error == 0 else at.spread((1, 1), ways.shape[:-1]).beside(place, ways)
    hits = scene.intersect(starts, ways, at.slack()[0], scanner.max_range, threads)
    # A target below the least range is not measured, but still hides all targets behind it.
    far = np.where(hits.t >= scanner.min_range, hits.t, np.inf)
    order = np.argsort(far, axis=1, kind="stable")
    t = np.take_along_axis(far, order, axis=1)
    angle = np.take_along_axis(_incidence(hits, ways), order, axis=1)
    is_met = np.isfinite(t)
    peak = peaks(t, _width(scanner, t, angle), scanner.resolution)
    is_new = is_met & (np.diff(peak, axis=1, prepend=-1) > 0)
    number = np.cumsum(is_new, axis=1) - 1
    # Returns of all beams in a row, and the return of each ray.
    group = (np.cumsum(is_new.reshape(-1)) - 1)[is_met.reshape(-1)]
    first = is_new.reshape(-1)
    total = int(first.sum())
    members = np.bincount(group, minlength=total)

    def mean(values: Floats) -> Floats:
        means: Floats = np.bincount(group, values.reshape(-1)[is_met.reshape(-1)], total) / members
        return means

    def of_first(values: ArrayLike) -> NDArray[Any]:
        chosen: NDArray[Any] = np.take_along_axis(np.asarray(values), order, axis=1).reshape(-1)[first]
        return chosen

    return {
        "beam": np.repeat(beams, t.shape[1])[first],
        "number": number.reshape(-1)[first].astype(np.int32),
        "range": mean(t),
        "incidence": mean(angle),
        "strength": members / scanner.rays,
        "shape_id": of_first(hits.shape_id),
        "primitive_id": of_first(hits.primitive_id),
    }


def _width(scanner: Lidar, t: Floats, angle: Floats) -> Floats:
    """Return the spread of ranges within the part of the beam of each ray."""
    apart = math.tan(math.radians(scanner.divergence) / 2.0) / math.sqrt(scanner.rays)
    with np.errstate(invalid="ignore"):
        width: Floats = t * apart * np.tan(np.radians(np.minimum(angle, _GRAZING)))
    return width


def _incidence(hits: Hits, ways: Floats) -> Floats:
    """Return the angle between rays and normals, in degrees from 0 to 90; NaN for misses."""
    cosine = np.abs((hits.normal * ways).sum(axis=-1))
    angles: Floats = np.degrees(np.arccos(np.minimum(cosine, 1.0)))
    return angles


def _chosen(
    returns: Returns, beam: NDArray[np.int64], which: NDArray[np.int32], strength: Floats
) -> NDArray[np.bool_]:
    if returns == "all" or not len(beam):
        return np.ones(len(beam), np.bool_)
    if returns == "first":
        return np.asarray(which == 0)
    last = np.append(beam[1:] != beam[:-1], True)
    if returns == "last":
        return last
    # The nearest among equally strong ones: the last of each beam in the order of strength.
    order = np.lexsort((-which, strength, beam))
    strongest = np.zeros(len(beam), np.bool_)
    strongest[order[last]] = True
    return strongest
