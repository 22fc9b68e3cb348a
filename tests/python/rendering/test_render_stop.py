"""Limits hold what they promise: the error asked for is reached, the time asked for is kept."""

from pathlib import Path

import numpy as np
import pytest

import raywright as rw

TARGET = 0.01


def render(scene, camera, **how):
    return rw.render(scene, camera, progress=False, **how)


def relmse(image, reference):
    return float(np.mean(np.square(image.rgb - reference) / (np.square(reference) + 0.01)))


def balls(size):
    """Balls under small bright lamps that are in the picture: few samples of a pixel meet them."""
    matt = [rw.Sphere((x, y, 0.0), 0.4) for x in (-1, 0, 1) for y in (-1, 0, 1)]
    lamps = [rw.Sphere((x + 0.5, y + 0.5, 1.0), 0.01, emission=200.0) for x in (-1, 0) for y in (-1, 0)]
    floor = rw.Plane((0, 0, -0.5), (0, 0, 1))
    camera = rw.Camera((0, -3, 4), (0, 0, 0), up=(0, 0, 1), fov=45, width=size, height=size)
    return rw.Scene([*matt, *lamps, floor], environment=0.2), camera


def with_reference(scene, camera):
    # Off by a fortieth of the target at most, which makes errors seem larger by that share.
    return scene, camera, render(scene, camera, samples=4000, seed=10**9, adaptive=True).rgb.astype(float)


@pytest.fixture(scope="module")
def highlights():
    return with_reference(*balls(48))


def reached(scene, camera, reference, seeds, adaptive):
    count = 0
    for seed in range(seeds):
        image = render(scene, camera, error=TARGET, seed=seed, adaptive=adaptive)
        assert image.error.high <= TARGET
        assert image.samples >= 16
        count += relmse(image, reference) <= TARGET
    return count


@pytest.mark.slow
@pytest.mark.parametrize("adaptive", [False, True])
@pytest.mark.parametrize("which", ["cornell", "highlights"])
def test_an_error_that_was_asked_for_is_reached(request, which, adaptive):
    # At exactly 95 of 100, 90 or fewer happen once in 35 cases; these seeds are fixed.
    assert reached(*request.getfixturevalue(which), 100, adaptive) >= 95


@pytest.mark.slow
def test_an_error_that_was_asked_for_is_reached_in_a_small_picture():
    # Off by 3e-6 in relMSE. The .rgb of rw.render(*balls(24), samples=16384, seed=10**9, adaptive=True)
    with np.load(Path(__file__).parents[1] / "data" / "balls_24.npz") as kept:
        reference = kept["rgb"].astype(float)
    # As above: 18 or fewer of 20 happen once in 4 cases, 17 once in 13.
    assert reached(*balls(24), reference, 20, False) >= 18


def test_stopping_at_an_error_does_not_darken_the_picture():
    scene, camera = rw.scenes.cornell_box(width=16, height=16)
    # Of rw.render(scene, camera, samples=65536, seed=10**9, sampler=rw.rendering.Lattice(64)): mean and
    # standard error.
    truth, doubt = 0.11368074172435172, 1.94e-5
    stopped = [render(scene, camera, error=0.04, seed=seed) for seed in range(150)]
    assert len({image.samples for image in stopped}) > 1
    means = np.array([image.rgb.mean(dtype=float) for image in stopped])
    error = means.std(ddof=1) / np.sqrt(len(means))
    off = means.mean() - truth
    # Within four standard errors, which chance exceeds once in 16,000 cases. Over 150 pictures that is less
    # than a third of the difference between two pictures.
    assert abs(off) < 4 * np.hypot(error, 2 * doubt)


@pytest.mark.parametrize("adaptive", [False, True])
def test_seconds_are_kept_to_a_sample(adaptive):
    scene, camera = rw.scenes.cornell_box(width=96, height=96)
    image = render(scene, camera, seconds=1.0, adaptive=adaptive)
    each = image.history["seconds"][-1] / image.samples
    # Half a sample of all pixels either way, plus other load on the machine.
    assert abs(image.seconds - 1.0) < 0.5 * each + 0.3
