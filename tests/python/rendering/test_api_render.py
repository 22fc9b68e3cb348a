"""Scenes to pictures: limits, what comes back, and what is refused."""

import math
import signal
import threading
import time

import numpy as np
import pytest

import raywright as rw


def lit(box):
    return rw.Scene(box, environment=1.0)


def test_picture_has_the_shape_and_types_it_promises(box, camera):
    image = rw.render(lit(box), camera, samples=16, progress=False)
    assert image.rgb.shape == image.standard_error.shape == (6, 8, 3)
    assert image.rgb.dtype == image.standard_error.dtype == np.float32
    assert image.history.dtype.names == ("seconds", "samples", "error")
    assert image.samples == image.history["samples"][-1] == 16
    assert (np.diff(image.history["samples"]) > 0).all()
    assert (np.diff(image.history["seconds"]) >= 0).all()
    assert 0 < image.history["seconds"][-1] <= image.seconds
    assert 0 <= image.error.low < float(image.error) < image.error.high
    assert image.warnings == ()
    assert np.isfinite(image.rgb).all()
    assert (image.rgb >= 0).all()
    assert (image.standard_error >= 0).all()


def test_what_misses_shows_the_environment():
    camera = rw.Camera((0, 0, 5), (0, 0, 6), width=4, height=4)
    image = rw.render(rw.Scene([], environment=(0.25, 0.5, 1)), camera, samples=8, progress=False)
    assert np.array_equal(image.rgb, np.broadcast_to(np.float32((0.25, 0.5, 1)), (4, 4, 3)))
    assert (image.standard_error == 0).all()


def test_black_without_any_light(box, camera):
    assert not rw.render(rw.Scene(box), camera, samples=8, progress=False).rgb.any()


def test_row_0_is_the_top_and_column_0_the_left(triangle):
    lamp = rw.Mesh(triangle.vertices * (1, 0.5, 1), triangle.faces, material=rw.Diffuse(0), emission=3)
    # The picture shows the unit square; the right angle is at its lower left, and the upper half stays black.
    camera = rw.Camera((0.5, 0.5, 2), (0.5, 0.5, 0), fov=math.degrees(2 * math.atan(0.25)), width=4, height=4)
    seen = rw.render(rw.Scene(lamp), camera, samples=8, progress=False).rgb[..., 0]
    assert seen[3, 0] == seen[3, 1] == 3
    assert seen[3, 3] < 3
    assert not seen[:2].any()


def test_lamps_shine_from_the_side_of_their_normal_only(triangle):
    lamp = rw.Mesh(triangle.vertices, triangle.faces, emission=3)
    for z, radiance in ((2, 3), (-2, 0)):
        camera = rw.Camera((0.2, 0.2, z), (0.2, 0.2, 0), fov=1, width=2, height=2)
        image = rw.render(rw.Scene(lamp), camera, rw.Path(max_depth=0), samples=4, progress=False)
        assert (image.rgb == radiance).all()


def test_without_limits_there_are_64_samples(box, camera):
    assert rw.render(lit(box), camera, progress=False).samples == 64


@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        ({"samples": 8, "error": 1e-12, "seconds": 60}, "samples"),
        ({"samples": 10**6, "error": 1e3, "seconds": 60}, "error"),
        ({"samples": 10**6, "error": 1e-12, "seconds": 0.2}, "seconds"),
        ({"seconds": 0.2}, "seconds"),
    ],
)
def test_the_first_limit_that_is_met_ends_the_render(box, camera, limits, reason):
    began = time.perf_counter()
    image = rw.render(lit(box), camera, **limits, progress=False)
    assert time.perf_counter() - began < 10
    assert (image.samples == 8) if reason == "samples" else (image.samples < 10**6)
    if reason == "error":
        assert float(image.error) <= 1e3
    if reason == "seconds":
        assert 0.1 < image.seconds < 5


def test_same_seed_same_picture_for_any_number_of_threads(box, camera):
    pictures = [
        rw.render(lit(box), camera, samples=16, seed=5, threads=n, progress=False).rgb for n in (1, 2, 3)
    ]
    assert np.array_equal(pictures[0], pictures[1])
    assert np.array_equal(pictures[0], pictures[2])
    other = rw.render(lit(box), camera, samples=16, seed=2**64 - 1, progress=False).rgb
    assert not np.array_equal(pictures[0], other)


def test_bar_is_on_stderr_and_can_be_off(box, camera, capfd):
    rw.render(lit(box), camera, samples=16, progress=False)
    assert capfd.readouterr() == ("", "")
    rw.render(lit(box), camera, samples=16)
    out, err = capfd.readouterr()
    assert out == ""
    last = err.rstrip("\n").split("\r")[-1]
    assert "100%" in last
    assert "16 samples, relMSE" in last


def test_interrupt_is_passed_on_at_once(box):
    camera = rw.Camera((0.5, 0.5, 4), (0.5, 0.5, 0.5), width=200, height=200)
    timer = threading.Timer(0.3, signal.raise_signal, (signal.SIGINT,))
    timer.start()
    began = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        rw.render(lit(box), camera, seconds=60, progress=False)
    assert time.perf_counter() - began < 2
    timer.join()


def test_nan_faces_warn_the_caller(camera, triangle):
    vertices = np.concatenate([np.full((1, 3), np.nan), triangle.vertices])
    scene = rw.Scene(rw.Mesh(vertices, [(0, 1, 2), (1, 2, 3)]))
    with pytest.warns(RuntimeWarning, match="1 of 2 faces were dropped") as caught:
        rw.render(scene, camera, samples=1, progress=False)
    assert caught[0].filename == __file__


def test_a_picture_without_any_light_says_why_it_is_black():
    camera = rw.Camera((0, 0, 5), (0, 0, 0), width=8, height=8)
    lamp = rw.Instance(rw.Instance(rw.Sphere((0, 0, 0), 0.1, emission=1.0), np.eye(4)), np.eye(4))
    dark = rw.Scene(rw.Sphere())
    image = rw.render(dark, camera, samples=1, progress=False)
    assert "no light: give environment=1.0" in image.warnings[0]
    assert image.warnings[0] in repr(image)
    # Looking away from a light is another matter, and so are pictures that need none.
    away = rw.Camera((0, 0, 5), (0, 0, 9), width=8, height=8)
    for scene, view, how in (
        (rw.Scene([rw.Sphere(), lamp]), away, rw.Path()),
        (rw.Scene(rw.Sphere(), rw.PointLight((9, 9, 9), 1.0)), away, rw.Path()),
        (dark, camera, rw.AmbientOcclusion()),
    ):
        assert not any(
            "no light" in told for told in rw.render(scene, view, how, samples=1, progress=False).warnings
        )


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"scene": "box.ply"}, TypeError, r"scene must be a raywright\.Scene, got str"),
        ({"camera": None}, TypeError, r"camera must be a raywright\.Camera, got NoneType"),
        ({"integrator": 8}, TypeError, r"integrator must be a raywright\.Path, got int"),
        ({"integrator": rw.Path}, TypeError, r"integrator must be a raywright\.Path, got type"),
        ({"samples": 0}, ValueError, r"samples must be between 1 and \d+, got 0"),
        ({"samples": 1.5}, TypeError, r"samples must be an integer, got 1.5"),
        ({"error": 0}, ValueError, r"error must be greater than 0, got 0"),
        ({"error": math.nan}, ValueError, r"error must be finite, got nan"),
        ({"error": "small"}, TypeError, r"error must be real numbers, got 'small'"),
        ({"seconds": -1}, ValueError, r"seconds must be greater than 0, got -1"),
        ({"seconds": math.inf}, ValueError, r"seconds must be finite, got inf"),
        ({"seed": -1}, ValueError, r"seed must be between 0 and 18446744073709551615, got -1"),
        ({"seed": 2**64}, ValueError, r"seed must be between 0 and 18446744073709551615"),
        ({"seed": 0.5}, TypeError, r"seed must be an integer, got 0.5"),
        ({"threads": 0}, ValueError, r"threads must be at least 1, got 0"),
    ],
)
def test_bad_arguments_are_refused_in_one_line(scene, camera, arguments, error, message):
    with pytest.raises(error, match=message) as caught:
        rw.render(**{"scene": scene, "camera": camera, "progress": False, **arguments})
    assert "\n" not in str(caught.value)
