"""What is seen at a pixel."""

import numpy as np
import pytest

import raywright as rw

CAMERA = rw.Camera((1, 2, 5), (0.1, 0, 0), width=37, height=21)
SCENE = rw.Scene([rw.scenes.torus_knot(along=60, around=8), rw.scenes.teapot(2)])


def test_a_pick_is_the_hit_of_the_pixels_ray():
    hits = SCENE.intersect(*CAMERA.rays())
    y, x = np.mgrid[:21, :37]
    picked = SCENE.pick(CAMERA, x, y)
    assert picked == hits
    assert np.array_equal(picked.position, hits.position, equal_nan=True)
    assert hits.hit.any()
    assert not hits.hit.all()


def test_one_pixel_gives_one_hit():
    hits = SCENE.intersect(*CAMERA.rays())
    for row, column in [*np.argwhere(hits.hit)[:20], (0, 0), (20, 36)]:
        picked = SCENE.pick(CAMERA, int(column), int(row))
        assert picked.shape == ()
        for name in ("t", "shape_id", "primitive_id"):
            assert getattr(picked, name) == getattr(hits, name)[row, column]
        assert np.array_equal(picked.position, hits.position[row, column], equal_nan=True)


def test_distance_is_that_from_the_camera():
    y, x = np.mgrid[:21, :37]
    picked = SCENE.pick(CAMERA, x, y)
    away = np.linalg.norm(picked.position - CAMERA.position, axis=-1)
    assert np.allclose(picked.t[picked.hit], away[picked.hit], rtol=1e-12)


def test_offsets_are_those_of_the_cameras_rays():
    offsets = np.random.default_rng(4).random((21, 37, 2))
    y, x = np.mgrid[:21, :37]
    assert SCENE.pick(CAMERA, x, y, offsets) == SCENE.intersect(*CAMERA.rays(offsets))
    assert SCENE.pick(CAMERA, x, y, (0.0, 1.0)) == SCENE.intersect(*CAMERA.rays((0.0, 1.0)))


def test_columns_and_rows_broadcast():
    x, y = np.arange(37, dtype=np.uint8), np.arange(21)[:, np.newaxis]
    assert SCENE.pick(CAMERA, x, y) == SCENE.intersect(*CAMERA.rays())
    assert SCENE.pick(CAMERA, 5, [3, 4], threads=1).shape == (2,)
    assert SCENE.pick(CAMERA, np.empty((0,), int), 3).shape == (0,)
    assert SCENE.pick(CAMERA, 5, 3, np.random.default_rng(1).random((9, 2))).shape == (9,)


def test_rays_through_points_are_the_cameras():
    offsets = np.random.default_rng(5).random((21, 37, 2))
    y, x = np.mgrid[:21, :37]
    origins, directions = CAMERA.rays_through(np.stack([x, y], axis=-1) + offsets)
    for found, expected in zip((origins, directions), CAMERA.rays(offsets), strict=True):
        assert np.array_equal(found, expected)
    middle = CAMERA.rays_through((18.5, 10.5))[1]
    view = np.subtract(CAMERA.target, CAMERA.position)
    assert np.allclose(middle, view / np.linalg.norm(view), atol=1e-15)


@pytest.mark.parametrize(
    ("error", "arguments", "message"),
    [
        (ValueError, (CAMERA, 37, 0), "x must be between 0 and 36, got 37"),
        (ValueError, (CAMERA, [3, -1, -2], 0), "x must be between 0 and 36, got -1"),
        (ValueError, (CAMERA, 0, 21), "y must be between 0 and 20, got 21"),
        (TypeError, (CAMERA, 1.0, 0), "x must be integers, got 1.0"),
        (TypeError, (CAMERA, 1, 2.5), r"y must be integers, got 2.5; .*camera.rays_through"),
        (TypeError, (CAMERA, 1, np.array([True])), "y must be integers, got ndarray of dtype bool"),
        (TypeError, ("camera", 1, 1), "camera must be a Camera, got str"),
        (ValueError, (CAMERA, 1, 1, (0.5,)), r"offsets must have shape \(\.\.\., 2\), got \(1,\)"),
        (
            ValueError,
            (CAMERA, [1, 2], [1, 2, 3]),
            r"leading shapes do not broadcast: x \(2,\), y \(3,\), offsets \(\)",
        ),
        (ValueError, (CAMERA, 1, 1, (np.nan, 0)), "points must be finite"),
    ],
)
def test_bad_arguments_are_refused(error, arguments, message):
    with pytest.raises(error, match=message):
        SCENE.pick(*arguments)


def test_points_are_checked():
    with pytest.raises(ValueError, match=r"points must have shape \(\.\.\., 2\), got \(3,\)"):
        CAMERA.rays_through((1, 2, 3))
    with pytest.raises(ValueError, match="points must be finite"):
        CAMERA.rays_through((1, np.inf))
