"""Sky view factors and ambient visibility: unobstructed shares of the hemisphere."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..arrays import SeedLike, integer, positive, seed_number
from ..query.surface_points import SurfacePoints
from ..scene.progress import BuildProgress, check_progress, watcher
from ..scene.scene import Scene, SceneLike
from .places import Floats, Places, frames, places, scene_of, unit
from .plots import Plotted

# Rays per batch: their arrays take some ten megabytes.
_TOGETHER = 1 << 19
# Independent batches of directions; their spread is the error.
_BATCHES = 16
_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


@dataclass(frozen=True, eq=False, repr=False)
class Estimate(Plotted):
    """Sampled values with standard errors; arrays have the leading shape of the points.

    Attributes
    ----------
    value : (...) float64
        The estimate; NaN where there is no point.
    standard_error : (...) float64
        Standard error from 16 independent batches of rays, widened by 15 / 13 (the variance of Student's t
        with 15 degrees of freedom) and by one ray. If all rays agree, it is 3 / `rays`: if this share of rays
        differed, all would agree in 5 % of cases (Hanley and Lippman-Hand, "If Nothing Goes Wrong, Is
        Everything All Right?", 1983).
    rays : int
        Number of rays from each point.

    See Also
    --------
    measure.sky_view, measure.ambient_visibility

    Examples
    --------
    >>> plain = rw.Mesh([[-9, 0, 9], [9, 0, 9], [0, 0, -9]], [[0, 1, 2]])
    >>> found = rw.measure.sky_view(plain)
    >>> found.value.tolist(), found.rays
    ([1.0], 256)
    """

    value: Floats
    standard_error: Floats
    rays: int
    _drawn = ("value", "standard_error")

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return flat arrays by name, an entry for each point, in C order.

        Returns
        -------
        dict
            An array for each column.

        Examples
        --------
        >>> plain = rw.Mesh([[-9, 0, 9], [9, 0, 9], [0, 0, -9]], [[0, 1, 2]])
        >>> rw.measure.sky_view(plain).to_dict()["value"].tolist()
        [1.0]
        """
        return {"value": self.value.reshape(-1), "standard_error": self.standard_error.reshape(-1)}

    def __repr__(self) -> str:
        return f"Estimate(shape={self.value.shape}, {self.rays} rays a point)"


def sky_view(
    scene: SceneLike,
    points: SurfacePoints | ArrayLike | None = None,
    normals: ArrayLike | None = None,
    rays: int = 256,
    up: ArrayLike | None = None,
    offset: float | None = None,
    seed: SeedLike = 0,
    progress: BuildProgress | None = None,
    threads: int | None = None,
) -> Estimate:
    """Find the sky view factor of points on surfaces: the share of a uniform sky's light that reaches them.

    It is the cosine-weighted share of unobstructed directions of the hemisphere; 1 for a plain under an open
    sky.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that Scene takes
        Obstructions.
    points : Hits, ClosestPoints or (..., 3) array, optional
        Points on surfaces. Rays leave hits exactly as in `Hits.spawn_rays`, and plain points by `offset`. By
        default the centers of all faces; the scene must then consist of meshes.
    normals : (..., 3) array, optional
        Normals of any length; those of the surfaces if not given, for hits only.
    rays : int
        Directions for each point, at least 16; rounded up to a multiple of 16.
    up : 3 floats, optional
        The zenith, for points on slopes and walls: below its horizon there is no sky. If not given, all
        unobstructed directions are sky.
    offset : float, optional
        Distance along the normal from plain points to the rays' origins. If not given, rays from points that
        lie on a surface to within rounding start beyond the error bound, as for hits; other rays start at the
        point. Rounding is 2**-40 of the largest coordinate of the face, or 2**-22 if points or vertices were
        rounded to float32.
    seed : int, Generator or SeedSequence
        Seed of the random numbers, 0 to 2**64 - 1.
    progress : bool or callable, optional
        True for a progress bar on stderr after two seconds (the default at a terminal); or a function that
        gets the completed share.
    threads : int, optional
        Number of threads; all cores if not given. The answer does not depend on it.

    Returns
    -------
    Estimate
        With the leading shape of the points, or (F,) for all faces of all shapes in order.

    Raises
    ------
    ValueError
        If shapes do not broadcast, a number is out of its range or not finite, a vector has no length, or
        normals are missing.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    measure.ambient_visibility : The same within a radius.
    measure.solar_exposure : The sun instead of the sky.

    Notes
    -----
    Each batch of directions is a lattice of the golden ratio on the square, moved at random (Cranley and
    Patterson 1976), and mapped to the disk evenly (Shirley and Chiu 1997) and up to the hemisphere (Malley's
    method). Batches are independent and unbiased, and their mean has a smaller error than that of as many
    independent rays.

    Examples
    --------
    >>> plain = rw.Scene(rw.Plane(normal=(0, 1, 0)))
    >>> rw.measure.sky_view(plain, [0, 0, 0], (0, 1, 0)).value.item()
    1.0

    At the foot of an endless wall, half of the sky is hidden:

    >>> wall = rw.Scene([rw.Plane(normal=(0, 1, 0)), rw.Plane(normal=(1, 0, 0))])
    >>> round(rw.measure.sky_view(wall, [1e-6, 0, 0], (0, 1, 0)).value.item(), 1)
    0.5
    """
    zenith = None if up is None else unit("up", up)
    scene = scene_of(scene)
    where = places(scene, points, normals, offset, threads)
    found = _open_share(scene, where, rays, math.inf, zenith, seed, progress, threads, "sky view")
    found._at(scene, points)
    return found


def ambient_visibility(
    scene: SceneLike,
    points: SurfacePoints | ArrayLike | None = None,
    normals: ArrayLike | None = None,
    radius: float | None = None,
    rays: int = 256,
    offset: float | None = None,
    seed: SeedLike = 0,
    progress: BuildProgress | None = None,
    threads: int | None = None,
) -> Estimate:
    """Compute the ambient visibility of points on surfaces: 1 minus ambient occlusion.

    It is the cosine-weighted share of directions of the hemisphere without an obstruction within a radius.

    Parameters
    ----------
    scene, points, normals, rays, offset, seed, progress, threads
        As for `sky_view`.
    radius : float, optional
        Maximum distance of obstructions, inclusive; unlimited if not given.

    Returns
    -------
    Estimate
        With the leading shape of the points, or (F,) for all faces of all shapes in order.

    Raises
    ------
    ValueError, TypeError
        As `sky_view` does, and if the radius is not greater than 0.

    See Also
    --------
    measure.sky_view : The same for a sky with a horizon.
    AmbientOcclusion : A picture of it.

    Examples
    --------
    >>> wall = rw.Scene([rw.Plane(normal=(0, 1, 0)), rw.Plane(normal=(1, 0, 0))])
    >>> found = rw.measure.ambient_visibility(wall, [[1e-6, 0, 0], [1, 0, 0]], (0, 1, 0), radius=0.5)
    >>> found.value.round(1).tolist()
    [0.5, 1.0]
    """
    most = math.inf if radius is None else positive("radius", radius)
    scene = scene_of(scene)
    where = places(scene, points, normals, offset, threads)
    found = _open_share(scene, where, rays, most, None, seed, progress, threads, "visibility")
    found._at(scene, points)
    return found


def _open_share(
    scene: Scene,
    where: Places,
    rays: int,
    most: float,
    up: Floats | None,
    seed: SeedLike,
    progress: BuildProgress | None,
    threads: int | None,
    what: str,
) -> Estimate:
    each = -(-integer("rays", rays, _BATCHES) // _BATCHES)
    seed = seed_number(seed)
    if progress is not None:
        check_progress(progress)
    count = len(where)
    shares = np.empty((_BATCHES, count))
    lattice = np.stack([(np.arange(each) + 0.5) / each, np.arange(each) * _GOLDEN % 1.0], axis=-1)
    # One call holds points of all batches, or of one batch if that alone is enough.
    batches = _BATCHES if count * each * _BATCHES <= _TOGETHER else 1
    step = max(_TOGETHER // (each * batches), 1)
    with watcher(progress, what) as report:
        for first in range(0, _BATCHES, batches):
            some_batches = np.arange(first, first + batches)
            for start in range(0, count, step):
                some = slice(start, min(start + step, count))
                found = _share(scene, where, some, lattice, some_batches, most, up, seed, threads)
                shares[first : first + batches, some] = found
                if report is not None:
                    report((first + batches * some.stop / count) / _BATCHES)
    shares[:, ~np.isfinite(where.origins).all(axis=1)] = np.nan
    value, lead = shares.mean(axis=0), where.shape
    error = _told_error(value, shares.var(axis=0, ddof=1) / _BATCHES, each * _BATCHES)
    return Estimate(value.reshape(lead), error.reshape(lead), each * _BATCHES)


def _told_error(value: Floats, variance: Floats, rays: int) -> Floats:
    """Return the standard error of the mean of batches, whose variance was estimated from them."""
    freedom = _BATCHES - 1
    error = np.sqrt(freedom / (freedom - 2) * variance + 1.0 / rays**2)
    # Rule of three: an outcome that no ray saw has a share below 3 / n at 95 %.
    return np.where((value == 0) | (value == 1), 3.0 / rays, error)


def _share(
    scene: Scene,
    where: Places,
    some: slice,
    lattice: Floats,
    batches: NDArray[np.int64],
    most: float,
    up: Floats | None,
    seed: int,
    threads: int | None,
) -> Floats:
    """Return the unobstructed share of directions, for each of some batches and points."""
    origins, normals = where.origins[some], where.normals[some]
    index, batch = np.meshgrid(np.arange(some.start, some.stop, dtype=np.uint32), batches.astype(np.uint32))
    moved = _core.random_numbers(seed, index.reshape(-1), batch.reshape(-1), 0, True).reshape(
        *index.shape, 1, 2
    )
    square = (np.swapaxes(moved, 1, 2) + lattice[:, None]) % 1.0
    x, y = np.moveaxis(_to_disk(square), -1, 0)
    first, second = frames(normals)
    height = np.sqrt(np.maximum(0.0, 1.0 - x * x - y * y))
    # By batch, direction and point.
    ways = x[..., None] * first + y[..., None] * second + height[..., None] * normals
    free = ~scene.occluded(origins, ways, t_max=most, threads=threads)
    if up is not None:
        free &= ways @ up > 0
    share: Floats = free.mean(axis=1)
    return share


def _to_disk(square: NDArray[np.float64]) -> Floats:
    """Map the unit square to the unit disk evenly, by rings (Shirley and Chiu 1997)."""
    a, b = np.moveaxis(2.0 * square - 1.0, -1, 0)
    is_wide = np.abs(a) > np.abs(b)
    radius = np.where(is_wide, a, b)
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = np.where(is_wide, math.pi / 4 * (b / a), math.pi / 2 - math.pi / 4 * (a / b))
    turn = np.where(radius == 0, 0.0, turn)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=-1)
