"""The worker's side of an executor: it renders parts of pictures.

A render is described by a job, which each process needs once: the first piece of work that finds it missing
reads it from a file, or requests it. The scene is compiled once a process, however many pieces are worked on
there.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import socket
import time
import traceback
from collections import OrderedDict
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from ..locks import Lock
from .job import Job

# Number of compiled scenes that a process keeps.
_KEPT = 4
_jobs: OrderedDict[str, Job] = OrderedDict()
_lock = Lock()


class Done(NamedTuple):
    """Answers to the requests, their run times, and warnings about the scene."""

    answers: list[bytes]
    seconds: float
    worker: str
    told: tuple[str, ...]


class Missing(NamedTuple):
    """The process has not been given the job yet."""

    worker: str


class Raised(NamedTuple):
    """The scene or the integrator raised an exception, which is no accident of the executor."""

    error: Exception
    trace: str


def keep(key: str, job: Job) -> None:
    """Let this process have a job without asking for it."""
    with _lock:
        _jobs[key] = job
        _jobs.move_to_end(key)
        while len(_jobs) > _KEPT:
            _jobs.popitem(last=False)


def work(
    key: str, payload: bytes | None, spool: str | None, requests: Sequence[bytes], threads: int, attempt: int
) -> Done | Missing | Raised:
    """Work on requests for a job; `attempt` only distinguishes repeated requests."""
    me = f"{socket.gethostname()}/{os.getpid()}"
    try:
        job = _job(key, payload, spool)
        if job is None:
            return Missing(me)
        # Compiled before the clock starts: later pieces are sized by this time.
        job.compiled()
        began = time.perf_counter()
        answers = [job.expose(request, threads) for request in requests]
    except Exception as error:
        return Raised(_sendable(error), traceback.format_exc())
    return Done(answers, time.perf_counter() - began, me, job.told)


def _job(key: str, payload: bytes | None, spool: str | None) -> Job | None:
    with _lock:
        if key in _jobs:
            _jobs.move_to_end(key)
            return _jobs[key]
        if payload is None and spool is not None:
            # The file does not exist on another machine.
            with suppress(OSError):
                payload = Path(spool).read_bytes()
        if payload is None or hashlib.sha256(payload).hexdigest() != key:
            return None
        job: Job = pickle.loads(payload)
        keep(key, job)
        return job


def _sendable(error: Exception) -> Exception:
    """Return an exception that survives being pickled: itself, or its words."""
    try:
        if type(pickle.loads(pickle.dumps(error))) is type(error):
            return error
    except Exception:
        pass
    return RuntimeError(f"{type(error).__name__}: {error}")
