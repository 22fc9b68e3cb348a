"""Renders by executors: the bits of one machine, lost workers, and what travels."""

import concurrent.futures
import multiprocessing
import os
import pickle
import signal
import threading
import time
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import raywright as rw
from raywright.rendering import executor as distributed

LIMITS = {"samples": 72, "seed": 3, "progress": False, "sampler": rw.rendering.Sobol(4)}


@pytest.fixture(scope="module")
def box():
    return rw.scenes.cornell_box(width=40, height=28)


@pytest.fixture(scope="module")
def pool():
    # Forked processes of a program with threads may hang.
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as executor:
        yield executor


def assert_same(a, b):
    assert np.array_equal(a.rgb, b.rgb)
    assert np.array_equal(a.standard_error, b.standard_error, equal_nan=True)
    assert (a.error, a.samples, a.warnings, a.biased) == (b.error, b.samples, b.warnings, b.biased)
    assert a.aov.keys() == b.aov.keys()
    assert all(np.array_equal(a.aov[name], b.aov[name]) for name in a.aov)
    for name in ("samples", "error"):
        assert np.array_equal(a.history[name], b.history[name], equal_nan=True)


class Noise(rw.integrators.Integrator):
    """Something noisy in Python."""

    def radiance(self, scene, rays, rng):
        hit = scene.intersect(rays.origins, rays.directions).hit
        return np.stack([rng.next_1d() ** 3 + hit for _ in range(3)], axis=1)


class Fails(rw.integrators.Integrator):
    def radiance(self, scene, rays, rng):
        raise LookupError("no such light")


class Deadly(Noise):
    """Kills its process once, half-way: a file says that it has been done."""

    def __init__(self, done, after=2):
        self.done, self.after = done, after

    def radiance(self, scene, rays, rng):
        calls = COUNTS[self.done] = COUNTS.get(self.done, 0) + 1
        if calls > self.after and multiprocessing.parent_process() is not None:
            try:
                os.close(os.open(self.done, os.O_CREAT | os.O_EXCL))
            except FileExistsError:
                pass
            else:
                os.kill(os.getpid(), signal.SIGKILL)
        return super().radiance(scene, rays, rng)


class Slow(Noise):
    def radiance(self, scene, rays, rng):
        time.sleep(0.2)
        return super().radiance(scene, rays, rng)


class Weighed(rw.Scene):
    """A scene that tells when it comes out of a pickle."""

    def __init__(self, *parts, told=None):
        super().__init__(*parts)
        self.told = told

    def __reduce__(self):
        return _weighed, (self._parts(), self.told)


def _weighed(parts, told):
    with open(told, "a") as file:
        file.write(f"{os.getpid()}\n")
    return Weighed(*parts, told=told)


COUNTS: dict = {}


class Elsewhere(concurrent.futures.Executor):
    """Another executor, of whose workers none sees this machine's files; what it is given is weighed."""

    def __init__(self, inner):
        self.inner, self.bytes, self.jobs = inner, [], 0

    def submit(self, fn, /, key, payload, spool, *rest):
        self.bytes.append(len(pickle.dumps((key, payload, rest))))
        self.jobs += payload is not None
        return self.inner.submit(fn, key, payload, "/missing", *rest)


class Forgetful(concurrent.futures.Executor):
    """One in which every third piece of work is lost, in one way or another."""

    def __init__(self, every=3):
        self.count, self.every, self.inner = 0, every, ThreadPoolExecutor(2)

    def submit(self, fn, /, *arguments):
        self.count += 1
        if self.count % self.every:
            return self.inner.submit(fn, *arguments)
        lost = Future()
        if self.count % 2:
            lost.set_exception(ConnectionError("the line is dead"))
        else:
            lost.cancel()
            lost.set_running_or_notify_cancel()
        return lost


@pytest.mark.parametrize("how", [{}, {"adaptive": True}, {"clamp": 2.0}, {"samples": 3}, {"samples": 33}])
def test_the_bits_are_those_of_one_machine(box, pool, how):
    assert_same(rw.render(*box, **{**LIMITS, **how}, executor=pool), rw.render(*box, **{**LIMITS, **how}))


@pytest.mark.parametrize("adaptive", [False, True])
def test_an_error_ends_it_at_the_same_pass(box, pool, adaptive):
    limits = {"error": 0.005, "adaptive": adaptive, "progress": False}
    one = rw.render(*box, **limits)
    assert one.samples > 16
    assert_same(rw.render(*box, **limits, executor=pool), one)


@pytest.mark.parametrize("kind", [Noise(), rw.Path(max_depth=2)])
def test_integrators_travel(box, pool, kind):
    assert_same(rw.render(*box, kind, **LIMITS, executor=pool), rw.render(*box, kind, **LIMITS))


def test_threads_and_pieces_change_no_bit(box, monkeypatch):
    one = rw.render(*box, **LIMITS)
    for seconds, threads in ((0.0, 1), (10.0, 3), (0.01, 2)):
        monkeypatch.setattr(distributed, "_PIECE", seconds)
        monkeypatch.setattr(distributed, "_LEAST_PIECE", seconds)
        with ThreadPoolExecutor(2) as executor:
            assert_same(rw.render(*box, **LIMITS, threads=threads, executor=executor), one)


def test_time_ends_it(box, pool):
    rw.render(*box, samples=1, progress=False, executor=pool)
    began = time.perf_counter()
    image = rw.render(*box, seconds=2, progress=False, executor=pool)
    assert 1 < time.perf_counter() - began < 10
    # Other passes, the same picture.
    plan = image.plan
    again = rw.render(*box, plan.path, samples=image.samples, sampler=plan.sampler, progress=False)
    assert np.array_equal(image.rgb, again.rgb)
    assert image.error == again.error


def test_a_bar_is_shown(box, pool, capfd):
    rw.render(*box, samples=32, executor=pool)
    assert "32 samples, relMSE" in capfd.readouterr().err


def test_the_scene_is_sent_once_a_worker(box, pool, tmp_path):
    scene, camera = box
    told = tmp_path / "told"
    weighed = Weighed(*scene._parts(), told=str(told))
    rw.render(weighed, camera, samples=200, progress=False, executor=pool)
    workers = told.read_text().split()
    assert 1 <= len(workers) == len(set(workers)) <= 2
    assert str(os.getpid()) not in workers
    # Another picture of it does not send it again either.
    rw.render(weighed, camera, samples=100, progress=False, executor=pool)
    assert told.read_text().split() == workers or len(set(told.read_text().split())) == 2


def test_workers_elsewhere_ask_for_the_scene(box, pool):
    knot = rw.scenes.torus_knot(along=300, around=30)
    scene, camera = rw.scenes.cornell_box(knot, width=40, height=28)
    executor = Elsewhere(pool)
    image = rw.render(scene, camera, **LIMITS, executor=executor)
    assert_same(image, rw.render(scene, camera, **LIMITS))
    weight = len(pickle.dumps(scene))
    # Two processes; one may get the job twice, once for the other's request.
    assert 1 <= executor.jobs <= 4
    heavy = [size for size in executor.bytes if size > weight]
    assert len(heavy) == executor.jobs


def test_lost_work_is_done_again(box):
    assert_same(rw.render(*box, **LIMITS, executor=Forgetful()), rw.render(*box, **LIMITS))
    assert_same(
        rw.render(*box, **LIMITS, adaptive=True, executor=Forgetful()),
        rw.render(*box, **LIMITS, adaptive=True),
    )


def test_work_that_is_always_lost_is_done_here(box):
    image = rw.render(*box, **LIMITS, executor=Forgetful(1))
    assert np.array_equal(image.rgb, rw.render(*box, **LIMITS).rgb)
    assert len(image.warnings) == 1
    assert image.warnings[0].startswith("the executor broke, and the rest was rendered here: ")


@pytest.mark.parametrize("adaptive", [False, True])
def test_a_pool_that_breaks_half_way_is_told(box, tmp_path, adaptive):
    kind = Deadly(str(tmp_path / "done"), after=3)
    whole = rw.render(*box, kind, **LIMITS, adaptive=adaptive)
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as executor:
        image = rw.render(*box, kind, **LIMITS, adaptive=adaptive, executor=executor)
    assert Path(kind.done).exists()
    assert np.array_equal(image.rgb, whole.rgb)
    assert image.error == whole.error
    assert [warning.partition(": ")[2].partition(":")[0] for warning in image.warnings] == [
        "BrokenProcessPool"
    ]


def test_exceptions_of_the_integrator_are_passed_on(box, pool):
    with pytest.raises(LookupError, match="no such light") as caught:
        rw.render(*box, Fails(), **LIMITS, executor=pool)
    assert "in radiance" in str(caught.value.__cause__)
    # The pool still works.
    assert pool.submit(int, "3").result() == 3


def test_what_does_not_pickle_is_named(box, pool):
    class Local(Noise):
        pass

    with pytest.raises(TypeError, match="integrator must be such that it can be pickled"):
        rw.render(*box, Local(), **LIMITS, executor=pool)


def test_other_things_are_refused(box):
    with pytest.raises(TypeError, match=r"executor must be a concurrent\.futures\.Executor, got int"):
        rw.render(*box, **LIMITS, executor=4)
    closed = ThreadPoolExecutor(1)
    closed.shutdown()
    with pytest.raises(RuntimeError, match="shutdown"):
        rw.render(*box, **LIMITS, executor=closed)


def test_faces_that_are_dropped_warn_the_caller(pool, triangle, camera):
    vertices = np.concatenate([np.full((1, 3), np.nan), triangle.vertices])
    scene = rw.Scene(rw.Mesh(vertices, [(0, 1, 2), (1, 2, 3)]))
    with pytest.warns(RuntimeWarning, match="1 of 2 faces were dropped"):
        rw.render(scene, camera, samples=1, progress=False, executor=pool)


def test_ctrl_c_cancels_what_waits(box, tmp_path):
    path = tmp_path / "slow.checkpoint"
    with ThreadPoolExecutor(1) as executor:
        timer = threading.Timer(1.0, signal.raise_signal, (signal.SIGINT,))
        timer.start()
        began = time.perf_counter()
        with pytest.raises(KeyboardInterrupt):
            rw.render(*box, Slow(), **{**LIMITS, "samples": 10_000}, executor=executor, checkpoint=path)
        assert time.perf_counter() - began < 3
        timer.join()
        # No other work is queued: the next is done at once.
        executor.submit(int).result(timeout=3)
    assert path.exists()


def test_checkpoints_go_from_one_to_the_other(box, pool, tmp_path):
    whole = {adaptive: rw.render(*box, **LIMITS, adaptive=adaptive) for adaptive in (False, True)}
    for adaptive in (False, True):
        for first, second in ((None, pool), (pool, None), (pool, pool)):
            path = tmp_path / f"{adaptive}{first is None}{second is None}"
            for samples, executor in ((5, first), (40, second), (72, first)):
                limits = {**LIMITS, "samples": samples, "adaptive": adaptive}
                image = rw.render(*box, **limits, executor=executor, checkpoint=path)
            assert np.array_equal(image.rgb, whole[adaptive].rgb)
            assert np.array_equal(image.standard_error, whole[adaptive].standard_error)


@pytest.fixture(scope="module")
def cluster():
    dask = pytest.importorskip("distributed")
    with (
        dask.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
        ) as running,
        dask.Client(running) as client,
    ):
        yield client


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("how", [{}, {"adaptive": True}])
def test_dask_gives_the_bits_of_one_machine(box, cluster, how):
    image = rw.render(*box, **LIMITS, **how, executor=cluster.get_executor())
    assert_same(image, rw.render(*box, **LIMITS, **how))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_dask_is_sent_the_scene_once_a_worker(box, cluster, tmp_path):
    told = tmp_path / "told"
    weighed = Weighed(*box[0]._parts(), told=str(told))
    rw.render(weighed, box[1], samples=400, progress=False, executor=cluster.get_executor())
    workers = told.read_text().split()
    assert len(workers) == len(set(workers)) == 2


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("adaptive", [False, True])
def test_a_dask_worker_killed_half_way_is_not_missed(cluster, adaptive):
    scene, camera = rw.scenes.cornell_box(width=96, height=72)
    limits = {"samples": 256, "seed": 3, "progress": False, "adaptive": adaptive}
    one = rw.render(scene, camera, **limits)
    pids = list(cluster.run(os.getpid).values())
    timer = threading.Timer(0.5 * one.seconds, os.kill, (pids[0], signal.SIGKILL))
    timer.start()
    image = rw.render(scene, camera, **limits, executor=cluster.get_executor())
    timer.join()
    cluster.wait_for_workers(2, timeout=60)
    assert pids[0] not in cluster.run(os.getpid).values()
    assert_same(image, one)
