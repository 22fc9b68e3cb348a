"""Radiosity by shooting: number of rays, iterations, and the stopping rule."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from .problem import REPLICATES, Problem
from .solution import Floats, Method, RadiositySolution

# Default error.
_ERROR = 0.01
# Share of the wanted error that the unshot flux may add.
_BIAS = 0.1
# Rays of a replicate's first shot: per patch on average, and at least.
_A_PATCH, _LEAST = 8, 2**12
_A_PATCH_PROGRESSIVE, _LEAST_PROGRESSIVE = 64, 2**16
# A round takes at most this many times the rays of all rounds before: its error estimates the rest better.
_GROWTH = 8


def to_the_end(
    problem: Problem,
    method: Method,
    error: float | None,
    rays: int | None,
    report: Callable[[float], object] | None,
    bias: float = _BIAS,
) -> RadiositySolution:
    """Return the solution by a method, at the first of an error and a number of rays that is met.

    Unshot power may add the share `bias` of the wanted error.
    """
    tell = _Teller(report)
    if method == "progressive":
        for _ in _shots(problem, error or _ERROR, rays, tell):
            pass
        return problem.solution(method, problem.core.arrived, problem.core.books, problem.core.unshot)
    return _rounds(problem, error, rays, bias, tell)


def states(problem: Problem, error: float, rays: int | None) -> Iterator[RadiositySolution]:
    """Yield the solution after each shot of each replicate."""
    for _ in _shots(problem, error, rays, _Teller(None), at_once=1):
        yield problem.solution("progressive", problem.core.arrived, problem.core.books, problem.core.unshot)


class _Teller:
    """Reports a share that never falls."""

    def __init__(self, report: Callable[[float], object] | None) -> None:
        self._report, self._share = report, 0.0

    def __call__(self, share: float) -> None:
        self._share = max(self._share, min(share, 1.0))
        if self._report is not None:
            self._report(self._share)


def _shots(
    problem: Problem, error: float, rays: int | None, tell: _Teller, at_once: int | None = None
) -> Iterator[None]:
    """Shoot from patch after patch until the bound is met; give word some times."""
    sides = len(problem.areas)
    mine = max(_A_PATCH_PROGRESSIVE * sides, _LEAST_PROGRESSIVE)
    if rays is not None:
        mine = max(rays // REPLICATES, 1)
    problem.begin(0, mine)
    first = problem.note(problem.core.rays)
    bound = first
    while bound > error:
        problem.core.shoot_greatest(at_once or max(sides // 64, 1), mine, problem.threads)
        bound = problem.note(problem.core.rays)
        tell(_way(first, bound, error))
        yield


def _rounds(
    problem: Problem, error: float | None, rays: int | None, bias: float, tell: _Teller
) -> RadiositySolution:
    """Solve by all patches at once, again and again with more rays, until the error is met."""
    wanted = error if error is not None or rays is not None else _ERROR
    least = bias * (error if error is not None else _ERROR)
    mine = max(_A_PATCH * len(problem.areas), _LEAST)
    if rays is not None:
        limit = max(rays // REPLICATES, 1)
        mine = limit if wanted is None else min(mine, limit)
    arrived: Floats | None = None
    books: Floats | None = None
    unshot: Floats | None = None
    done = spent = number = 0
    while True:
        problem.begin(number, mine)
        first = bound = problem.note(spent + problem.core.rays)
        while bound > least:
            problem.core.shoot_all(mine, problem.threads)
            bound = problem.note(spent + problem.core.rays)
            if wanted is None:
                tell(_way(first, bound, least))
        spent += problem.core.rays
        core = problem.core
        new, share = (core.arrived, core.books, core.unshot), mine / (done + mine)
        arrived = new[0] if arrived is None else arrived + share * (new[0] - arrived)
        books = new[1] if books is None else books + share * (new[1] - books)
        unshot = new[2] if unshot is None else unshot + share * (new[2] - unshot)
        done, number = done + mine, number + 1
        solution = problem.solution("stochastic", arrived, books, unshot)
        off = solution.error
        if wanted is None or off <= wanted or (rays is not None and done >= limit):
            return solution
        tell((wanted / off) ** 2)
        # Errors fall as one over the root of the rays; nearer to the wanted error, the estimate is better.
        more = math.ceil(done * ((off / wanted) ** 2 * 1.1 - 1.0))
        mine = int(np.clip(more, done // 4 + 1, _GROWTH * done))
        if rays is not None:
            mine = min(mine, limit - done)


def _way(first: float, bound: float, least: float) -> float:
    """Return how far a bound has come from its first value to the least, by the factors between."""
    if bound <= least or first <= least:
        return 1.0
    return math.log(first / bound) / math.log(first / least)
