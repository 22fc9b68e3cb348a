"""The same picture, bit for bit, however the work is done."""

import numpy as np
import pytest

import raywright as rw


@pytest.fixture(scope="module")
def knot():
    """A scene with all kinds of light, smooth normals, and thousands of faces."""
    mesh = rw.scenes.torus_knot(along=100, around=12)
    lights = [rw.PointLight((0, 3, 3), intensity=4)]
    lamp = rw.Mesh([(-1, 3, -1), (1, 3, -1), (0, 3, 1)], [(0, 1, 2)], material=rw.Diffuse(0.2), emission=5)
    return [mesh, lamp], lights, rw.Camera((0, 1, 5), (0, 0, 0), width=37, height=29)


def picture(knot, accelerator=None, **how):
    shapes, lights, camera = knot
    scene = rw.Scene(shapes, lights, environment=0.3, accelerator=accelerator or rw.BVH())
    return rw.render(scene, camera, progress=False, **how)


def assert_same(a, b):
    assert np.array_equal(a.rgb, b.rgb)
    assert np.array_equal(a.standard_error, b.standard_error)
    assert a.error == b.error
    assert a.samples == b.samples


def test_threads_change_no_bit(knot):
    one = picture(knot, samples=21, seed=3, threads=1)
    for threads in (2, 5):
        other = picture(knot, samples=21, seed=3, threads=threads)
        assert_same(one, other)
        assert np.array_equal(one.history["error"], other.history["error"], equal_nan=True)


def test_accelerators_change_no_bit(knot):
    reference = picture(knot, samples=4, accelerator=rw.BruteForce())
    assert_same(picture(knot, samples=4), reference)
    assert_same(picture(knot, samples=4, accelerator=rw.BVH(bins=4)), reference)


def test_passes_change_no_bit(knot):
    # A render with a time limit has passes of other sizes.
    timed = picture(knot, seconds=0.3)
    plan = timed.plan
    assert_same(picture(knot, integrator=plan.path, samples=timed.samples, sampler=plan.sampler), timed)


def test_one_seed_is_one_picture_and_another_is_another(knot):
    a, b = picture(knot, samples=4, seed=1), picture(knot, samples=4, seed=2)
    assert_same(a, picture(knot, samples=4, seed=1))
    assert not np.array_equal(a.rgb, b.rgb)
    # The rest is sky, which has no noise.
    assert (a.rgb != b.rgb).any(axis=2).mean() > 0.1
