"""Renders that are watched while they go on, and stopped from elsewhere."""

import os
import pickle
import select
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import raywright as rw
from raywright.rendering import snapshots


class Watch(list):
    """Remembers the pictures that it is shown, and when."""

    def __init__(self, then=lambda image: None):
        super().__init__()
        self.times, self.then = [], then

    def __call__(self, image):
        self.append(image)
        self.times.append(time.monotonic())
        self.then(image)


@pytest.fixture(params=["here", "elsewhere"])
def executor(request):
    if request.param == "here":
        yield None
    else:
        with ThreadPoolExecutor(2) as pool:
            yield pool


def cornell(size=64):
    return rw.scenes.cornell_box(width=size, height=size)


@pytest.mark.parametrize(
    ("adaptive", "executor"), [(False, "here"), (True, "elsewhere")], indirect=["executor"]
)
def test_watching_changes_no_bit_and_ends_with_what_is_returned(adaptive, executor):
    scene, camera = cornell()
    how = {"seed": 3, "adaptive": adaptive}
    watch = Watch()
    # Short passes must leave room for progress reports, too.
    image = rw.render(scene, camera, seconds=1.0, threads=1, progress=watch, executor=executor, **how)
    assert len(watch) >= 3
    assert watch[-1] is image
    how |= {"samples": image.samples, "sampler": image.plan.sampler}
    again = rw.render(scene, camera, image.plan.path, progress=False, **how)
    assert np.array_equal(again.rgb, image.rgb)
    assert np.array_equal(again.standard_error, image.standard_error)


def test_pictures_so_far_get_better():
    scene, camera = cornell()
    truth = rw.render(scene, camera, samples=256, seed=10**9, progress=False).rgb.astype(float)
    watch = Watch()
    rw.render(scene, camera, seconds=1.5, threads=1, progress=watch)

    def relmse(image):
        return float(np.mean(np.square(image.rgb - truth) / (np.square(truth) + 0.01)))

    whole = [image for image in watch if image.samples >= 4]
    assert [image.samples for image in whole] == sorted(image.samples for image in whole)
    assert whole[-1].samples > 4 * whole[0].samples
    # Four times the samples are a quarter of the error, up to noise.
    assert relmse(whole[-1]) < 0.5 * relmse(whole[0])
    for image in whole:
        # The estimate is of the last whole pass.
        assert image.history["error"][-1] == image.error.estimate
        assert image.history["samples"][-1] == image.samples
        assert image.rgb.shape == image.standard_error.shape == (64, 64, 3)


class Clock:
    """Time that goes on by a fiftieth of a second with each look at the render, however long that takes.

    It stands for `time`, and as `stop`, which is asked at each look, it ends the render after so many.
    """

    def __init__(self, looks):
        self.now, self.left = 0.0, looks

    def monotonic(self):
        return self.now

    def is_set(self):
        self.now += 0.02
        self.left -= 1
        return self.left < 0


@pytest.fixture
def clock(monkeypatch):
    def start(looks):
        clock = Clock(looks)
        monkeypatch.setattr(snapshots, "time", clock)
        return clock

    return start


def test_who_asks_for_no_pixels_is_called_ten_times_a_second_however_large_the_picture_is(clock, monkeypatch):
    clock, told, waited = clock(40), [], []
    take = snapshots.Snapshots.take

    def taken(self, image, waits):
        take(self, image, waits)
        waited.append(waits())

    monkeypatch.setattr(snapshots.Snapshots, "take", taken)

    def watch(image):
        told.append(clock.now)
        # Values for the whole picture exist, and no pixel does.
        assert image.samples == 0
        assert np.isnan(image.error.estimate)
        assert repr(image).startswith("Image(2560x1440, 0 samples")
        # The last picture shown is the result.
        assert type(image) is rw.Image or not {"rgb", "standard_error", "degrees"} & set(vars(image))

    # One sample of each pixel takes one thread seconds, and all looks together eight tenths of one. The
    # render is not interrupted for any of them.
    scene = rw.scenes.cornell_box(width=2560, height=1440)
    image = rw.render(*scene, rw.Path(reuse=1), progress=watch, stop=clock, threads=1)
    assert image.samples == 0
    during = told[:-1]
    assert len(during) >= 6
    assert np.allclose(np.diff(during), 0.1, rtol=0, atol=0.021)
    assert waited == [False] * len(during)


@pytest.mark.parametrize(("threads", "share", "looks"), [(1, 9.0, 105), (2, 4.0, 120), (5, 1.0, 90)])
def test_what_it_takes_to_show_it_is_a_tenth_of_the_work_at_most(clock, threads, share, looks):
    clock, began = clock(looks), []

    def watch(image):
        began.append(clock.now)
        clock.now += 0.05

    scene = rw.scenes.cornell_box(width=1280, height=720)
    rw.render(*scene, rw.Path(reuse=1), progress=watch, stop=clock, threads=threads)
    gaps = np.diff(began[:-1])
    assert len(gaps) >= 3
    # One thread shows it, and the others continue. Looks are a fiftieth of a second apart.
    least = max(0.1, 0.05 * (1 + share))
    assert (gaps >= least - 1e-9).all()
    # No more than a tenth is kept free: the next picture comes as soon as that allows. With several threads
    # it may be later, since the others' looks continue while the showing thread waits for a core.
    soonest = gaps.max() if threads == 1 else gaps.min()
    assert soonest < least + 0.021


def test_pixels_so_far_have_the_first_of_their_samples_and_nothing_else(clock):
    scene, camera = rw.scenes.cornell_box(width=400, height=400)
    how = {"seed": 7, "sampler": rw.rendering.Independent(), "progress": False}
    whole = [rw.render(scene, camera, rw.Path(reuse=1), n, **how).rgb for n in (1, 2)]
    seen = []

    def watch(image):
        clock.now += 1.0
        seen.append((image.samples, image.rgb, image.rgb is image.rgb))

    clock = clock(100_000)
    how |= {"progress": watch, "stop": clock}
    rw.render(scene, camera, rw.Path(reuse=1), 2, threads=1, **how)
    before = {0: [np.zeros_like(whole[0]), whole[0]], 1: whole}
    mixed = 0
    for samples, rgb, same in seen:
        assert same
        if samples in before:
            old, new = ((rgb == one).all(axis=2) for one in before[samples])
            assert (old | new).all()
            mixed += old.any() and new.any() and not (old & new).all()
    assert mixed > 0


def test_pictures_that_are_kept_stay_as_they_were():
    kept, pixels = [], []

    def watch(image):
        pixels.append(image.rgb.copy())
        kept.append(image)

    scene, camera = rw.scenes.cornell_box(width=64, height=64)
    rw.render(scene, camera, seconds=1.0, threads=1, progress=watch, adaptive=True, clamp=0.5)
    assert len(kept) >= 3
    for image, rgb in zip(kept, pixels, strict=True):
        assert np.array_equal(image.rgb, rgb)
        assert not image.rgb.flags.writeable
        copy = pickle.loads(pickle.dumps(image))
        assert type(copy) is rw.Image
        assert copy == image
        assert image.aov["samples"].shape == (64, 64)
        if image.samples >= 4:
            assert np.isfinite(image.standard_error).all()
            assert image.biased
            assert "clamped" in image.warnings[0]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_after_a_fork_pictures_are_made_as_before():
    scene, camera = cornell(16)
    here = rw.render(scene, camera, samples=4, progress=False)
    read, write = os.pipe()
    # A child that hangs would block this test alone.
    child = os.fork()
    if child == 0:
        again = rw.render(scene, camera, samples=4, progress=False)
        os.write(write, b"y" if np.array_equal(again.rgb, here.rgb) else b"n")
        os._exit(0)
    ready, _, _ = select.select([read], [], [], 20)
    if not ready:
        os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    assert ready
    assert os.read(read, 1) == b"y"


def test_another_thread_may_stop_a_render_at_once(executor):
    scene, camera = rw.scenes.cornell_box(width=400, height=400)
    stop, stopped = threading.Event(), []

    def end():
        stopped.append(time.monotonic())
        stop.set()

    threading.Timer(0.7, end).start()
    image = rw.render(scene, camera, error=1e-9, progress=False, stop=stop, executor=executor)
    # Fifty looks per second; tests run beside other work.
    assert time.monotonic() - stopped[0] < 1.0
    assert image.rgb.shape == (400, 400, 3)
    assert image.error.estimate > 1e-9 or np.isnan(image.error.estimate)


def test_a_function_that_watches_may_stop_the_render():
    stop = threading.Event()
    watch = Watch(lambda image: stop.set() if image.samples >= 16 else None)
    image = rw.render(*cornell(), rw.Path(reuse=1), error=1e-9, progress=watch, stop=stop)
    assert watch[-1] is image
    assert image.samples >= 16
    assert image.warnings == ()


def test_what_is_stopped_before_all_pixels_have_a_sample_says_so():
    stop = threading.Event()
    stop.set()
    image = rw.render(*cornell(), samples=8, progress=False, stop=stop)
    assert image.samples == 0
    assert image.warnings == ("stopped before every pixel had a sample",)


def test_a_render_that_was_stopped_goes_on_from_its_checkpoint(tmp_path):
    scene, camera = cornell()
    stop = threading.Event()
    how = {"seed": 5, "checkpoint": tmp_path / "box.checkpoint"}
    watch = Watch(lambda image: stop.set() if image.samples >= 4 else None)
    part = rw.render(scene, camera, samples=500, progress=watch, stop=stop, **how)
    assert part.samples < 500
    whole = rw.render(scene, camera, samples=500, progress=False, **how)
    again = rw.render(scene, camera, samples=500, progress=False, seed=5)
    assert np.array_equal(whole.rgb, again.rgb)
    assert np.array_equal(whole.standard_error, again.standard_error)


class TroubleError(Exception):
    pass


def test_what_a_function_raises_ends_the_render():
    def fail(image):
        raise TroubleError

    with pytest.raises(TroubleError):
        rw.render(*cornell(), error=1e-9, progress=fail)


class BrokenEvent:
    def is_set(self):
        raise TroubleError


def test_what_a_stop_raises_ends_the_render():
    with pytest.raises(TroubleError):
        rw.render(*cornell(), error=1e-9, progress=False, stop=BrokenEvent())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"progress": "bar"}, "progress must be True, False or a function, got 'bar'"),
        ({"progress": None}, "progress must be True, False or a function, got None"),
        ({"stop": True}, "stop must be a threading.Event or the like, got bool"),
    ],
)
def test_anything_else_is_refused(arguments, message):
    with pytest.raises(TypeError, match=message):
        rw.render(*cornell(), samples=1, **arguments)
