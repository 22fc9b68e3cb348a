"""Two at a time: each engine is timed beside raywright, turn after turn, and answers are compared."""

import statistics
import time

import numpy as np


def timed_beside(reference, threads, others, rays, repeat):
    """Return a record for each mode of each of `others`, a list of (engine, threads), after so many turns.

    In a turn each is timed with `reference`, on `threads` threads, just before or just after it, and `ratio`
    is the median over turns of how many times as long it takes. What slows a shared machine lasts for longer
    than such a pair, so that ratios hold where seconds do not. Who goes first changes from turn to turn.
    """
    records = []
    for engine, most in others:
        for mode in engine.modes:
            record = {"engine": engine.name, "mode": mode, "threads": min(most, engine.most_threads or most)}
            records.append((engine, record | {"seconds": [], "raywright_seconds": []}))
    for turn in range(repeat):
        for engine, record in records:
            for first in (True, False):
                if first == (turn % 2 == 0):
                    record["raywright_seconds"].append(_seconds(reference, threads, rays, ""))
                else:
                    record["seconds"].append(_seconds(engine, record["threads"], rays, record["mode"]))
    for _, record in records:
        record["mrays_per_second"] = rays.count / statistics.median(record["seconds"]) / 1e6
        both = zip(record["seconds"], record["raywright_seconds"], strict=True)
        record["ratio"] = statistics.median(own / raywright for own, raywright in both)
    return [record for _, record in records]


def disagreements(reference, other):
    """Return how many rays in a million two answers differ on: in whether they hit, or by 1e-4 of t."""
    (hit, t), (other_hit, other_t) = reference, other
    hit, other_hit = hit.reshape(-1), other_hit.reshape(-1)
    wrong = hit != other_hit
    if t is not None:
        both = hit & other_hit
        t, other_t = t.reshape(-1)[both], other_t.reshape(-1)[both]
        wrong[both] = np.abs(t - other_t) > 1e-4 * t
    return 1e6 * wrong.mean()


def _seconds(engine, threads, rays, mode):
    engine.use(threads)
    _wait_for_quiet()
    start = time.perf_counter()
    engine.ask(rays, mode)
    return time.perf_counter() - start


def _wait_for_quiet():
    """Wait until the threads of whoever ran last are asleep: some spin for 20 ms in case more is to do."""
    for _ in range(40):
        before = time.process_time()
        time.sleep(0.004)
        if time.process_time() - before < 0.001:
            return
