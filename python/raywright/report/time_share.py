"""Estimated shares of rays' time for boxes and for primitives."""

from __future__ import annotations

import itertools
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import integer
from ..scene.scene import Scene
from .ray_sets import Rays, ray_sets

# Least number of batches to fit, and of rays in one: fewer rays mostly measure the call.
_BATCHES = 64
_LEAST_SIDE = 8
_DRAWS = 400
_SUBSETS = [list(s) for n in (3, 2, 1) for s in itertools.combinations(range(3), n)]

Array = NDArray[np.float64]
Pieces = list[tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]]]]


@dataclass(frozen=True)
class TimeShare:
    """Estimated shares of the time of rays: see `time_share`.

    Attributes
    ----------
    boxes, primitives, rest : float
        Shares of visiting nodes, of testing primitives, and of the fixed cost of each ray; they add up to 1.
    boxes_interval, primitives_interval : (float, float)
        Bounds of the 95 % interval of a share.
    node_ns, primitive_ns, ray_ns : float
        Fitted nanoseconds for a visited node, a tested primitive, and the fixed time of a ray.
    explained : float
        Share of the variance of time among batches that the counts explain, 1 at most. A small share means
        that the estimate is useless.

    See Also
    --------
    report.time_share : Makes it.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=16, height=16)
    >>> share = rw.report.time_share(scene, camera, repeats=1)
    >>> round(share.boxes + share.primitives + share.rest, 9)
    1.0
    """

    boxes: float
    primitives: float
    rest: float
    boxes_interval: tuple[float, float]
    primitives_interval: tuple[float, float]
    node_ns: float
    primitive_ns: float
    ray_ns: float
    explained: float

    def __str__(self) -> str:
        parts = [
            f"boxes {_told(self.boxes, self.boxes_interval)}",
            f"primitives {_told(self.primitives, self.primitives_interval)}",
            f"rest {self.rest:.0%}",
        ]
        return f"share of time, estimated: {', '.join(parts)}; counts explain {self.explained:.0%} of it"


def time_share(scene: Scene, rays: Any, repeats: int = 7) -> TimeShare:
    """Estimate the shares of rays' time that boxes and primitives take.

    The rays are cut into batches, squares of the picture if they are an image. Each is timed on one thread,
    several times in turns, and its nodes and primitives are counted. A non-negative least squares fit to the
    median times of batches gives a time for each node, for each primitive, and a fixed time for each ray.

    It is an estimate: if the counts of nodes and of primitives are correlated, the fit cannot separate them,
    and the intervals (bootstrap over batches) are wide. Costs in proportion to a count, such as waiting for
    memory or sorting children, are included in its cost.

    Parameters
    ----------
    scene : Scene
        The scene, whose accelerator is measured.
    rays : Camera, Rays, or (origins, directions)
        Rays to time, for their closest hits.
    repeats : int
        Number of timings of each batch.

    Returns
    -------
    TimeShare

    Raises
    ------
    ValueError
        If there are fewer rays than 64, or `repeats` is below 1.
    TypeError
        If `scene` or `rays` are of the wrong kind.

    See Also
    --------
    report.heatmap : The counts as a picture.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=16, height=16)
    >>> share = rw.report.time_share(scene, camera, repeats=1)
    >>> share.explained <= 1
    True
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene must be a Scene, got {type(scene).__name__}")
    repeats = integer("repeats", repeats, 1, 10_000)
    one = _closest(rays) if not isinstance(rays, Rays) else rays
    if one.count < _BATCHES:
        raise ValueError(f"rays must be at least {_BATCHES} for an estimate, got {one.count}")
    pieces = _pieces(one)
    seconds = np.empty((repeats, len(pieces)))
    for turn in range(repeats):
        for i, piece in enumerate(pieces):
            began = time.perf_counter()
            scene.intersect(*piece, t_max=one.t_max, threads=1)
            seconds[turn, i] = time.perf_counter() - began
    costs = [scene.traversal_cost(*piece, t_max=one.t_max, threads=1) for piece in pieces]
    counts = np.array([[c.nodes.sum(), c.primitives.sum(), c.nodes.size] for c in costs], np.float64)
    return fitted(counts, np.median(seconds, axis=0))


def fitted(counts: Array, seconds: Array, seed: int = 0) -> TimeShare:
    """Return the shares for counted and timed batches.

    Parameters
    ----------
    counts : (N, 3) float64
        Nodes, primitives and rays of each batch.
    seconds : (N,) float64
    seed : int
        Of the bootstrap.
    """
    best = _costs(counts[np.newaxis], seconds[np.newaxis])[0]
    shares = _shares(best, counts)
    chosen = np.random.default_rng(seed).integers(len(counts), size=(_DRAWS, len(counts)))
    drawn = [_shares(costs, counts) for costs in _costs(counts[chosen], seconds[chosen])]
    low, high = np.quantile(drawn, [0.025, 0.975], axis=0)
    spread = float(((seconds - seconds.mean()) ** 2).sum())
    left = float(((seconds - counts @ best) ** 2).sum())
    return TimeShare(
        boxes=float(shares[0]),
        primitives=float(shares[1]),
        rest=float(shares[2]),
        boxes_interval=(float(low[0]), float(high[0])),
        primitives_interval=(float(low[1]), float(high[1])),
        node_ns=float(1e9 * best[0]),
        primitive_ns=float(1e9 * best[1]),
        ray_ns=float(1e9 * best[2]),
        explained=1 - left / spread if spread > 0 else 0.0,
    )


def _closest(rays: Any) -> Rays:
    if hasattr(rays, "rays"):
        return Rays(*rays.rays())
    # A pair of arrays needs no scene.
    (one,) = ray_sets(None, rays, 0).values()  # type: ignore[arg-type]
    return one


def _pieces(rays: Rays) -> Pieces:
    """Cut rays into batches, each C-contiguous as the core takes it without a copy."""
    lead = rays.origins.shape[:-1]
    if len(lead) == 2:
        side = max(int((rays.count / _BATCHES) ** 0.5), 1)
        # A multiple of the side of the core's tiles, so that none is cut.
        side = max(side // _LEAST_SIDE * _LEAST_SIDE, min(_LEAST_SIDE, side))
        squares = [
            (slice(i, i + side), slice(j, j + side))
            for i in range(0, lead[0], side)
            for j in range(0, lead[1], side)
        ]
        return [
            (np.ascontiguousarray(rays.origins[at]), np.ascontiguousarray(rays.directions[at]))
            for at in squares
        ]
    origins, directions = rays.origins.reshape(-1, 3), rays.directions.reshape(-1, 3)
    return list(zip(np.array_split(origins, _BATCHES), np.array_split(directions, _BATCHES), strict=True))


def _costs(counts: Array, seconds: Array) -> Array:
    """Fit by least squares without negative costs, for each of B draws of batches: (B, 3).

    Of all fits with some of the costs zero, the best that has no negative one.
    """
    # Columns are scaled to equal norms, so that squares lose few digits.
    size = np.maximum(np.linalg.norm(counts, axis=1, keepdims=True), 1e-300)
    columns = counts / size
    gram = np.einsum("bni,bnj->bij", columns, columns)
    right = np.einsum("bni,bn->bi", columns, seconds)
    best, least = np.zeros_like(right), np.full(len(right), np.inf)
    for subset in _SUBSETS:
        found = np.zeros_like(right)
        part = np.linalg.pinv(gram[:, subset][:, :, subset], rcond=1e-12, hermitian=True)
        found[:, subset] = np.einsum("bij,bj->bi", part, right[:, subset])
        left = np.einsum("bi,bij,bj->b", found, gram, found) - 2 * np.einsum("bi,bi->b", found, right)
        better = (found >= 0).all(axis=1) & (left < least)
        best[better], least[better] = found[better], left[better]
    return np.asarray(best / size[:, 0])


def _shares(costs: Array, counts: Array) -> Array:
    times = costs * counts.sum(axis=0)
    total = times.sum()
    return np.asarray(times / total if total > 0 else np.zeros(3))


def _told(share: float, interval: tuple[float, float]) -> str:
    return f"{share:.0%} ({interval[0]:.0%} to {interval[1]:.0%})"
