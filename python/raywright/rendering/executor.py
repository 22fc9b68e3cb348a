"""Renders by any executor: a pool of processes, a cluster, or anything else with ``submit``.

A pass over the picture is cut into pieces, each some tiles and the samples of one pass, that take some tenths
of a second each. Where all pixels get the same samples, pieces of later passes are worked on before the first
are done, so that no worker waits for another; where samples go by the error of those before, pass follows
pass. Pieces are added in the order of their samples, whenever they come, so a picture has the bits that it
has on one machine.
"""

from __future__ import annotations

import concurrent.futures
import hashlib
import importlib
import os
import pickle
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any

from .. import _core
from .job import Job
from .worker import Done, Missing, Raised, keep, work

# Target seconds of a piece of work: long against the cost of sending it, short against a render.
_PIECE = 0.4
_LEAST_PIECE = 0.05
# Number of losses of one piece after which the executor counts as broken.
_LOSSES = 3
# Seconds between looks at the clock, and the most requests in a piece.
_LOOK = 0.1
_MOST_REQUESTS = 64

Limits = tuple[int | None, float | None, float | None]


class BrokenError(Exception):
    """The executor does not work any more; the render is whole and can be gone on with."""


class RemoteError(Exception):
    """The traceback of an exception that was raised by a worker, in words."""

    def __str__(self) -> str:
        return f"\n{self.args[0]}"


@dataclass
class _Pass:
    """One pass over the picture."""

    before: int
    aim: int
    # True if its samples do not depend on earlier ones.
    alone: bool
    # The next tile to hand out, and the number of tiles not back yet.
    next: int = 0
    left: int = 0
    answers: list[bytes] = field(default_factory=list)


@dataclass
class _Piece:
    """Work that is handed out as one."""

    parts: list[tuple[_Pass, int, int]]
    requests: list[bytes]
    losses: int = 0
    attempt: int = 0
    # The worker that requested the job, if this piece brings it.
    feeds: str | None = None


class Distribution:
    """A render under way on an executor.

    Parameters
    ----------
    rendering : _core.Rendering
        The render, which is taken further in place.
    job : Job
        The job that is distributed.
    executor : concurrent.futures.Executor
        The executor.
    limits : (samples, error, seconds)
        The limits.
    threads : int
        Threads of each piece of work.
    """

    def __init__(
        self,
        rendering: _core.Rendering,
        job: Job,
        executor: Executor,
        limits: Limits,
        threads: int,
    ) -> None:
        self.told: tuple[str, ...] = ()
        self._rendering, self._executor, self._limits, self._threads = rendering, executor, limits, threads
        self._courier = _Courier(job, executor)
        self._passes: deque[_Pass] = deque()
        self._waiting: deque[_Piece] = deque()
        self._flying: dict[Future[Any], _Piece] = {}
        self._slots = _slots(executor)
        self._started, self._earlier = time.perf_counter(), rendering.seconds
        # Seconds per tile and sample, and samples of tiles that came back since a time.
        self._cost = 0.0
        self._landed, self._since = 0, 0.0

    def run(self, report: Callable[[float, int, float, bool], None] | None, rest: Callable[[], None]) -> None:
        """Go on until a limit is met.

        `report` is called after each pass, `rest` often: the render is whole then, and may be looked at.

        Raises
        ------
        BrokenError
            If the executor broke. The render can be gone on with.
        Exception
            An exception of the scene or the integrator.
        """
        try:
            with self._courier.ready():
                while self._fill():
                    done, _ = concurrent.futures.wait(
                        self._flying, _LOOK, return_when=concurrent.futures.FIRST_COMPLETED
                    )
                    for future in done:
                        self._land(future)
                    self._advance(report)
                    rest()
        finally:
            for future in self._flying:
                future.cancel()

    def _elapsed(self) -> float:
        return self._earlier + time.perf_counter() - self._started

    def _fill(self) -> bool:
        """Hand out work for all workers; whether there was any."""
        while len(self._flying) < 2 * self._slots + 2:
            piece = self._waiting.popleft() if self._waiting else self._cut()
            if piece is None:
                break
            self._submit(piece)
        return bool(self._flying)

    def _submit(self, piece: _Piece) -> None:
        payload, spool = self._courier.parcel(piece.feeds)
        piece.attempt += 1
        arguments = (self._courier.key, payload, spool, piece.requests, self._threads, piece.attempt)
        try:
            future = self._executor.submit(work, *arguments, **self._courier.options)
        except Exception as error:
            if not self._landed and not self._flying:
                raise
            raise BrokenError(_line(error)) from error
        self._flying[future] = piece

    def _cut(self) -> _Piece | None:
        """Cut the next piece off the passes, of about the seconds that one should take."""
        parts: list[tuple[_Pass, int, int]] = []
        wanted = self._wanted()
        tiles, spent = self._rendering.tiles, 0.0
        while not parts or (spent < wanted and len(parts) < _MOST_REQUESTS):
            now = self._passes[-1] if self._passes else None
            if now is None or now.next == tiles:
                now = self._next_pass()
                if now is None:
                    break
            samples = now.aim - now.before
            if self._cost:
                count = int((wanted - spent) / (self._cost * samples)) + 1
            else:
                count = -(-tiles // (4 * self._slots))
            count = min(count, tiles - now.next)
            parts.append((now, now.next, count))
            now.next += count
            spent += count * samples * self._cost if self._cost else wanted
            if not now.alone and now.next == tiles:
                break
        if not parts:
            return None
        return _Piece(parts, [self._request(*part) for part in parts])

    def _request(self, of: _Pass, first: int, count: int) -> bytes:
        return self._rendering.request(first, count, of.before if of.alone else None, of.aim)

    def _wanted(self) -> float:
        """Return how long the next piece should take: less towards an end that is in sight."""
        samples, _, seconds = self._limits
        left = float("inf")
        if samples is not None and self._cost:
            all_of_it = (samples - self._rendering.samples) * self._rendering.tiles - self._landed_ahead()
            left = all_of_it * self._cost
        if seconds is not None:
            left = min(left, (seconds - self._elapsed()) * self._slots)
        if self._passes and not self._passes[-1].alone and self._cost:
            now = self._passes[-1]
            left = min(left, (self._rendering.tiles - now.next) * (now.aim - now.before) * self._cost)
        return min(_PIECE, max(_LEAST_PIECE, left / (3 * self._slots)))

    def _landed_ahead(self) -> int:
        """Return how many samples of tiles are there of passes that are not done."""
        tiles = self._rendering.tiles
        return sum((tiles - one.left) * (one.aim - one.before) for one in self._passes)

    def _next_pass(self) -> _Pass | None:
        """Begin another pass, if there is one and it can be begun."""
        done, tiles = self._rendering.samples, self._rendering.tiles
        after = self._passes[-1].aim if self._passes else done
        block = self._rendering.block
        if self._passes and not (self._rendering.appends and after % block == 0):
            return None
        # Work already handed out comes first.
        landed = done + self._landed_ahead() / max(tiles, 1)
        rate = self._rate()
        aim = self._rendering.next_aim(*self._limits, after, self._elapsed() + (after - landed) * rate, rate)
        if aim <= after or not tiles:
            return None
        # A render interrupted within a pass has tiles ahead of others.
        left_within = not self._passes and self._rendering.aim > done
        alone = self._rendering.appends and after % block == 0 and not left_within
        one = _Pass(after, aim, alone, left=tiles)
        self._passes.append(one)
        if len(self._passes) == 1:
            self._rendering.begin(aim)
        return one

    def _rate(self) -> float:
        """Return the seconds that a sample of all pixels takes, on all workers together."""
        tiles = max(self._rendering.tiles, 1)
        if self._landed > 4 * tiles:
            return (time.perf_counter() - self._since) / (self._landed / tiles)
        return self._cost * tiles / self._slots or self._rendering.rate

    def _land(self, future: Future[Any]) -> None:
        """Add the results of a piece of work."""
        piece = self._flying.pop(future)
        try:
            error = future.exception()
        except concurrent.futures.CancelledError as canceled:
            error = canceled
        if error is not None:
            self._lost(piece, error)
            return
        outcome = future.result()
        if isinstance(outcome, Missing):
            piece.feeds = self._courier.asked(outcome.worker)
            self._waiting.appendleft(piece)
        elif isinstance(outcome, Raised):
            raise outcome.error from RemoteError(outcome.trace)
        elif isinstance(outcome, Done):
            self._courier.delivered(piece.feeds)
            self._take(piece, outcome)
        else:
            raise BrokenError(f"a worker answered with {type(outcome).__name__}")

    def _lost(self, piece: _Piece, error: BaseException) -> None:
        piece.losses += 1
        if isinstance(error, concurrent.futures.BrokenExecutor) or piece.losses > _LOSSES:
            raise BrokenError(_line(error)) from error
        self._courier.delivered(piece.feeds)
        piece.feeds = None
        try:
            self._courier.check()
        except Exception as trouble:
            raise BrokenError(_line(trouble)) from trouble
        self._waiting.appendleft(piece)

    def _take(self, piece: _Piece, outcome: Done) -> None:
        count = sum(tiles * (of.aim - of.before) for of, _, tiles in piece.parts)
        cost = outcome.seconds / count
        self._cost = 0.5 * (self._cost + cost) if self._cost else cost
        if self._since:
            self._landed += count
        else:
            self._since = time.perf_counter()
        self.told += tuple(told for told in outcome.told if told not in self.told)
        for (of, _, tiles), answer in zip(piece.parts, outcome.answers, strict=True):
            of.left -= tiles
            if of is self._passes[0]:
                self._rendering.take(answer)
            else:
                of.answers.append(answer)

    def _advance(self, report: Callable[[float, int, float, bool], None] | None) -> None:
        """End the passes that are complete."""
        while self._passes and self._passes[0].left == 0:
            self._passes.popleft()
            row = self._rendering.end(self._elapsed())
            if report is not None:
                report(*row)
            if self._is_met():
                # Passes begun beyond the limit are discarded.
                self._passes.clear()
                self._waiting.clear()
                for future in self._flying:
                    future.cancel()
                self._flying.clear()
                self._limits = (self._rendering.samples, None, None)
            if self._passes:
                now = self._passes[0]
                self._rendering.begin(now.aim)
                for answer in now.answers:
                    self._rendering.take(answer)
                now.answers.clear()

    def _is_met(self) -> bool:
        """Return whether the error is within the limit."""
        after = self._rendering.samples
        return self._rendering.next_aim(None, self._limits[1], None, after, 0.0, 0.0) <= after


class _Courier:
    """Brings the job to the workers, to each once.

    On a dask cluster it is scattered. Else it lies in a file, which workers on this machine read; workers
    elsewhere say that they miss it, and get it with a piece of their work.
    """

    def __init__(self, job: Job, executor: Executor) -> None:
        self._client = _dask_client(executor)
        self._dumps: Callable[[Any], bytes] = pickle.dumps
        # Further arguments of `submit`: dask need not hash the work to detect repetitions.
        self.options: dict[str, Any] = {} if self._client is None else {"pure": False}
        if self._client is not None:
            # cloudpickle also sends classes defined in a notebook.
            self._dumps = importlib.import_module("cloudpickle").dumps
        self._bytes = self._pickled(job)
        self.key = hashlib.sha256(self._bytes).hexdigest()
        self._spool: str | None = None
        self._scattered: Any = None
        self._fed: set[str] = set()
        if isinstance(executor, concurrent.futures.ThreadPoolExecutor):
            keep(self.key, job)

    def _pickled(self, job: Job) -> bytes:
        try:
            return self._dumps(job)
        except Exception as error:
            for name in ("scene", "camera", "integrator"):
                with suppress(Exception):
                    self._dumps(getattr(job, name))
                    continue
                told = f"{name} must be such that it can be pickled, to go to an executor: {error}"
                raise TypeError(told) from error
            raise

    @contextmanager
    def ready(self) -> Iterator[None]:
        """Keep the job where workers find it."""
        if self._client is not None:
            self.check()
            yield
            return
        handle, self._spool = tempfile.mkstemp(prefix="raywright-", suffix=".job")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(self._bytes)
            yield
        finally:
            with suppress(OSError):
                os.unlink(self._spool)

    def check(self) -> None:
        """Scatter the job unless it is scattered; it is no longer once all workers that had it are lost."""
        if self._client is not None and getattr(self._scattered, "status", None) != "finished":
            self._scattered = self._client.scatter(self._bytes, broadcast=True, hash=False)

    def parcel(self, feeds: str | None) -> tuple[Any, str | None]:
        """Return the parcel of a piece of work: the job, or its compiled state, and its place."""
        if self._client is not None:
            return self._scattered, None
        return (self._bytes if feeds else None), self._spool

    def asked(self, worker: str) -> str | None:
        """Return the worker if it needs the job now: it asks again until the job arrives."""
        if worker in self._fed:
            return None
        self._fed.add(worker)
        return worker

    def delivered(self, feeds: str | None) -> None:
        """Forget that a worker is being fed: if another got the job, it will ask again."""
        if feeds is not None:
            self._fed.discard(feeds)


def _dask_client(executor: Executor) -> Any:
    if type(executor).__module__.partition(".")[0] != "distributed":
        return None
    return getattr(executor, "_client", None)


def _slots(executor: Executor) -> int:
    """Return how many pieces are worked on at the same time, or a guess."""
    client = _dask_client(executor)
    if client is not None:
        return max(sum(int(count) for count in client.nthreads().values()), 1)
    # Attributes of concurrent.futures and mpi4py.futures.
    for name in ("_max_workers", "num_workers"):
        count = getattr(executor, name, None)
        if isinstance(count, int) and count > 0:
            return count
    return _core.cores()


def _line(error: BaseException) -> str:
    words = " ".join(str(error).split())
    return f"{type(error).__name__}: {words}" if words else type(error).__name__
