"""Accelerators that take turns at the same shapes and the same rays."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import AcceleratorInfo
from ..accelerators import Accelerator, BruteForce
from ..scene.scene import Scene
from ..shapes.mesh import face_count
from .ray_sets import Rays

# Ray-primitive tests of brute force in the check, if no number of rays is given: a second or two of one core.
_CHECK_TESTS = 100_000_000
# Rays that are checked in any case, of all sets together.
_LEAST_CHECKED = 300
# Slower accelerators trace fewer rays, so that a set takes about this time.
_LONGEST_SECONDS = 1.0
# One accelerator is built as often as others take turns, but for no longer than this.
_BUILD_SECONDS = 1.0

Answer = tuple[NDArray[Any], ...]


@dataclass(frozen=True)
class Measured:
    """Measurements of one accelerator; dicts are by the names of the sets of rays.

    Attributes
    ----------
    name : str
        Its name in the report.
    accelerator : Accelerator
        The accelerator's options.
    info : AcceleratorInfo
        Statistics of the built accelerator.
    build_seconds : float
        Median over the builds.
    rays : dict of int
        Number of rays timed.
    seconds_per_ray : dict of float
        Median over the turns.
    nodes, primitives : dict of float
        Nodes visited and primitives tested for a ray's closest hit: means.
    checked, wrong : dict of int
        Number of rays compared with brute force, and number of those that differ.

    See Also
    --------
    AcceleratorReport.measured : Lists them.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=8)
    >>> choices = {"bvh": rw.BVH(), "grid": rw.accelerators.Grid()}
    >>> report = rw.report.accelerators(scene, camera, choices, repeats=1, check=20)
    >>> report.measured[0].name, sorted(report.measured[0].rays)
    ('bvh', ['diffuse', 'primary', 'shadow'])
    """

    name: str
    accelerator: Accelerator
    info: AcceleratorInfo
    build_seconds: float
    rays: dict[str, int]
    seconds_per_ray: dict[str, float]
    nodes: dict[str, float]
    primitives: dict[str, float]
    checked: dict[str, int]
    wrong: dict[str, int]


def measured(
    scene: Scene,
    sets: dict[str, Rays],
    accelerators: dict[str, Accelerator],
    threads: int | None,
    repeats: int,
    check: int | None,
) -> list[Measured]:
    """Build accelerators over a scene's shapes, hold them against brute force, and time them in turns.

    Parameters
    ----------
    scene : Scene
        The scene; its own accelerator does not matter.
    sets : dict of Rays
        Sets of rays.
    accelerators : dict of accelerators
        By the names that they get.
    threads : int or None
        Number of threads that trace rays; None is all cores.
    repeats : int
        Number of turns.
    check : int or None
        Number of rays compared with brute force, of all sets together; None is as many as it answers soon.
    """
    contest = _Contest(scene, sets, threads, _checked(scene, sets, check))
    entries = [contest.entry(name, accelerator) for name, accelerator in accelerators.items()]
    for turn in range(repeats):
        first = turn % len(entries)
        for entry in entries[first:] + entries[:first]:
            contest.turn(entry, build=turn > 0)
    return [entry.measured() for entry in entries]


def _checked(scene: Scene, sets: dict[str, Rays], check: int | None) -> dict[str, Rays]:
    """Return those of the rays that are held against brute force, a like number of each set."""
    if check is None:
        # Any other shape counts as one.
        count = sum(face_count(shape) or 1 for shape in scene.shapes)
        check = max(_CHECK_TESTS // max(count, 1), _LEAST_CHECKED)
    return {name: rays.thinned(-(-check // len(sets))) for name, rays in sets.items()}


@dataclass
class _Entry:
    """An accelerator in the contest, and its times so far."""

    name: str
    accelerator: Accelerator
    scene: Scene
    rays: dict[str, Rays]
    nodes: dict[str, float]
    primitives: dict[str, float]
    checked: dict[str, int]
    wrong: dict[str, int]
    builds: list[float]
    seconds: dict[str, list[float]] = field(default_factory=dict)

    def measured(self) -> Measured:
        return Measured(
            self.name,
            self.accelerator,
            self.scene.accelerator_info,
            statistics.median(self.builds),
            {name: rays.count for name, rays in self.rays.items()},
            {name: statistics.median(self.seconds[name]) / self.rays[name].count for name in self.rays},
            self.nodes,
            self.primitives,
            self.checked,
            self.wrong,
        )


class _Contest:
    """The same shapes and the same rays for every accelerator."""

    def __init__(
        self, scene: Scene, sets: dict[str, Rays], threads: int | None, checked: dict[str, Rays]
    ) -> None:
        self._given, self._sets, self._threads, self._checked = scene, sets, threads, checked
        brute = self._over(BruteForce())
        # The oracle is not timed and may take all cores.
        self._truth = {name: _answer(brute, rays, None) for name, rays in checked.items()}

    def _over(self, accelerator: Accelerator) -> Scene:
        given = self._given
        return Scene(given.shapes, accelerator=accelerator, precision=given.precision, quality=given.quality)

    def entry(self, name: str, accelerator: Accelerator) -> _Entry:
        """Build it, hold it against brute force, and find how many rays it has the time for."""
        scene = self._over(accelerator)
        entry = _Entry(name, accelerator, scene, {}, {}, {}, {}, {}, [scene.accelerator_info.build_seconds])
        for key, rays in self._sets.items():
            few = self._checked[key]
            began = time.perf_counter()
            answer = _answer(scene, few, self._threads)
            per_ray = (time.perf_counter() - began) / few.count
            differs = [a != b for a, b in zip(answer, self._truth[key], strict=True)]
            entry.checked[key] = few.count
            entry.wrong[key] = int(np.count_nonzero(np.logical_or.reduce(differs)))
            most = max(int(_LONGEST_SECONDS / max(per_ray, 1e-12)), 1)
            entry.rays[key] = timed = rays.thinned(most)
            cost = scene.traversal_cost(
                timed.origins, timed.directions, t_max=timed.t_max, threads=self._threads
            )
            entry.nodes[key], entry.primitives[key] = float(cost.nodes.mean()), float(cost.primitives.mean())
            entry.seconds[key] = []
        return entry

    def turn(self, entry: _Entry, build: bool) -> None:
        """Time every set of rays once, after a build if there is the time for one."""
        if build and sum(entry.builds) < _BUILD_SECONDS:
            entry.scene.rebuild()
            entry.builds.append(entry.scene.accelerator_info.build_seconds)
        for key, rays in entry.rays.items():
            ask = entry.scene.occluded if rays.any_hit else entry.scene.intersect
            began = time.perf_counter()
            ask(rays.origins, rays.directions, t_max=rays.t_max, threads=self._threads)
            entry.seconds[key].append(time.perf_counter() - began)


def _answer(scene: Scene, rays: Rays, threads: int | None) -> Answer:
    """Return the results that must be the same for every accelerator, bit for bit."""
    if rays.any_hit:
        return (scene.occluded(rays.origins, rays.directions, t_max=rays.t_max, threads=threads),)
    hits = scene.intersect(rays.origins, rays.directions, t_max=rays.t_max, threads=threads)
    return hits.t, hits.shape_id, hits.primitive_id
