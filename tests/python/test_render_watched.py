"""Renders that are watched while they go on, and stopped from elsewhere."""

import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import raywright as rw


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


@pytest.mark.parametrize("adaptive", [False, True])
def test_watching_changes_no_bit_and_ends_with_what_is_returned(adaptive, executor):
    scene, camera = cornell()
    how = {"seed": 3, "adaptive": adaptive}
    watch = Watch()
    # Short passes too must leave room for being watched.
    image = rw.render(scene, camera, seconds=1.0, progress=watch, executor=executor, **how)
    assert len(watch) >= 3
    assert watch[-1] is image
    how |= {"samples": image.samples, "sampler": image.plan.sampler}
    again = rw.render(scene, camera, image.plan.path, progress=False, **how)
    assert np.array_equal(again.rgb, image.rgb)
    assert np.array_equal(again.standard_error, image.standard_error)


def test_pictures_so_far_get_better():
    scene, camera = cornell()
    truth = rw.render(scene, camera, samples=500, seed=10**9, progress=False).rgb.astype(float)
    watch = Watch()
    rw.render(scene, camera, seconds=1.5, progress=watch)

    def relmse(image):
        return float(np.mean(np.square(image.rgb - truth) / (np.square(truth) + 0.01)))

    whole = [image for image in watch if image.samples >= 4]
    assert [image.samples for image in whole] == sorted(image.samples for image in whole)
    assert whole[-1].samples > 4 * whole[0].samples
    # Four times the samples are a quarter of the error, but for chance.
    assert relmse(whole[-1]) < 0.5 * relmse(whole[0])
    for image in whole:
        # The estimate is of the last whole pass.
        assert image.history["error"][-1] == image.error.estimate
        assert image.history["samples"][-1] == image.samples
        assert image.rgb.shape == image.standard_error.shape == (64, 64, 3)


def test_pictures_come_ten_times_a_second_at_most_and_cost_a_tenth():
    watch = Watch()
    rw.render(*cornell(), seconds=1.0, progress=watch)
    assert (np.diff(watch.times[:-1]) >= 0.1).all()
    watch = Watch(lambda image: time.sleep(0.05))
    rw.render(*cornell(), seconds=1.5, progress=watch)
    assert (np.diff(watch.times[:-1]) >= 10 * 0.05).all()
    assert len(watch) >= 2


def test_another_thread_may_stop_a_render_at_once(executor):
    scene, camera = rw.scenes.cornell_box(width=400, height=400)
    stop, stopped = threading.Event(), []

    def end():
        stopped.append(time.monotonic())
        stop.set()

    threading.Timer(0.7, end).start()
    image = rw.render(scene, camera, error=1e-9, progress=False, stop=stop, executor=executor)
    # Fifty looks a second; tests run beside other work.
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
    part = rw.render(scene, camera, samples=200, progress=watch, stop=stop, **how)
    assert part.samples < 200
    whole = rw.render(scene, camera, samples=200, progress=False, **how)
    again = rw.render(scene, camera, samples=200, progress=False, seed=5)
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
