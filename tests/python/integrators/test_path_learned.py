"""Paths that learn where light comes from: the same mean, less noise, the same bits."""

import math

import numpy as np
import pytest
import rare_scenes
from test_bidirectional import hollow

import raywright as rw


def render(scene, camera, guiding="learned", *, reuse=1, max_depth=None, samples=64, **how):
    path = rw.Path(max_depth, reuse=reuse, guiding=guiding)
    return rw.render(scene, camera, path, samples=samples, progress=False, **how)


def chambers(aperture, rho):
    """Two hollow spheres that meet in an opening, seen from within the one that does not emit."""
    rim = math.sqrt(1 - aperture**2)
    share = (1 - rim) / 2
    bounce = np.array([[rho * (1 - share), rho * share], [rho * share, rho * (1 - share)]])
    radiosity = np.linalg.solve(np.eye(2) - bounce, [1, 0])
    first = hollow(aperture, material=rw.Diffuse(rho), emission=1 / math.pi)
    second = hollow(aperture, center=2 * rim, up=False, material=rw.Diffuse(rho))
    camera = rw.Camera((0, 0, 2 * rim), (0.3, 0, 2 * rim + 1), fov=60, width=8, height=8)
    return rw.Scene([first, second]), camera, radiosity[1] / math.pi


@pytest.mark.parametrize("reuse", [1, 8])
def test_light_through_an_opening_has_its_closed_form(reuse):
    scene, camera, radiance = chambers(0.2, 0.8)
    how = {"reuse": reuse, "samples": 256}
    found = np.array([render(scene, camera, seed=seed, **how).rgb.mean() for seed in range(8)])
    error = found.std(ddof=1) / math.sqrt(len(found))
    assert error < 0.02 * radiance
    # Walls of straight pieces are off by less than a thousandth. With 7 degrees of freedom, 4 standard
    # errors are exceeded once in 190 cases; these seeds are fixed.
    assert abs(found.mean() - radiance) < 4 * error + 1e-3 * radiance, (found.mean(), error, radiance)


def assert_same_mean(scene, camera, count=24, most=0.05, **how):
    """Within 4 standard errors in each channel: exceeded once in 4,000 cases."""
    plain, learned = (
        np.array(
            [render(scene, camera, guiding, seed=k, **how).rgb.mean((0, 1)) for k in range(count)], float
        )
        for guiding in ("photons", "learned")
    )
    error = np.sqrt((plain.var(0, ddof=1) + learned.var(0, ddof=1)) / count)
    off = plain.mean(0) - learned.mean(0)
    assert (np.abs(off) < 4 * error).all(), (plain.mean(0), learned.mean(0), error)
    assert (error < most * plain.mean(0)).all()


@pytest.mark.parametrize("reuse", [1, 4])
@pytest.mark.parametrize("name", ["cornell_box", "glass_spheres", "veach_plates"])
def test_learning_changes_no_mean(name, reuse):
    assert_same_mean(*getattr(rw.scenes, name)(width=16, height=16), reuse=reuse, max_depth=5)


def test_a_slit_under_the_sky_has_the_same_mean():
    floor = rw.Plane((0, -1, 0), (0, 1, 0))
    lid = [
        rw.Mesh([(-9, 1, a), (9, 1, a), (9, 1, b), (-9, 1, b)], [(0, 1, 2), (0, 2, 3)])
        for a, b in ((-9, -0.05), (0.05, 9))
    ]
    camera = rw.Camera((0, 0, 3), (0, -1, 0), fov=50, width=8, height=8)
    assert_same_mean(rw.Scene([floor, *lid], environment=5.0), camera, max_depth=4)


def test_a_keyhole_takes_a_fifth_of_the_error_at_most():
    scene, camera = rare_scenes.keyhole(32)
    plain, learned = (
        np.array([render(scene, camera, guiding, reuse=8, seed=k).rgb for k in range(6)], float)
        for guiding in ("none", "learned")
    )
    mean = np.square(learned.mean(axis=0)) + 0.01
    assert np.mean(learned.var(axis=0, ddof=1) / mean) < 0.2 * np.mean(plain.var(axis=0, ddof=1) / mean)


def test_threads_and_other_views_change_no_bit():
    scene, camera = rare_scenes.keyhole(12)
    one = render(scene, camera, threads=1)
    assert np.array_equal(render(scene, camera, threads=3).rgb, one.rgb)
    # A view in between has a guide of its own.
    render(scene, rw.Camera((1, 1, 1), (3, 2, 1), width=4, height=4))
    assert np.array_equal(render(scene, camera, threads=2).rgb, one.rgb)


def test_nothing_is_learned_where_nothing_can_be():
    box, camera = rw.scenes.cornell_box(width=8, height=8)
    for scene, depth in ((rw.Scene(box.shapes[:1]), None), (box, 1)):
        plain, learned = (
            render(scene, camera, guiding, max_depth=depth, samples=4) for guiding in ("none", "learned")
        )
        assert np.array_equal(plain.rgb, learned.rgb)
