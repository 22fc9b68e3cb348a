"""Surfaces a millionth apart, and surfaces in one place."""

import math

import numpy as np
import pytest

import raywright as rw

TURN = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3.0  # a rotation


def turned(points, place=0.0):
    return np.asarray(points, float) @ TURN.T + place


def sheet(height, *, up=True, place=0.0, size=5.0, diagonal=0, **kwargs):
    """A square in a plane that is not along the axes."""
    corners = [(-size, -size, height), (size, -size, height), (size, size, height), (-size, size, height)]
    faces = [[(0, 1, 2), (0, 2, 3)], [(0, 1, 3), (1, 2, 3)]][diagonal]
    return rw.Mesh(turned(corners, place), faces if up else np.asarray(faces)[:, ::-1], **kwargs)


def look(start, end, place=0.0, **more):
    return rw.Camera(turned(start, place), turned(end, place), up=TURN[:, 1], width=32, height=32, **more)


@pytest.mark.parametrize("place", [0.0, 10.0, 1e3])
@pytest.mark.parametrize("gap", [1e-6, 1e-9])
def test_a_sheet_hides_what_is_close_behind_it_anywhere(gap, place):
    # A black sheet and a lamp above it that emits upwards, both turned and moved.
    scene = rw.Scene(
        [
            sheet(0, up=False, place=place, material=rw.Diffuse(0)),
            sheet(gap, place=place, material=rw.Diffuse(0), emission=2),
        ],
        precision="double",
    )
    below = rw.render(scene, look((0.3, 0.2, -1), (0, 0, 0), place), samples=4, progress=False)
    above = rw.render(scene, look((0.3, 0.2, 1), (0, 0, 0), place), samples=4, progress=False)
    assert not below.rgb.any()
    np.testing.assert_array_equal(above.rgb, 2)


@pytest.mark.parametrize("gap", [1e-6, 1e-3])
def test_between_sheets_it_is_as_bright_as_in_any_closed_room(box, gap):
    # A room of 1 by 1 and this height, with radiance 1 and a reflectance of a half: 1 / (1 - 0.5) everywhere.
    corners = np.asarray(box.vertices) * (1, 1, gap)
    walls = rw.Mesh(turned(corners), np.asarray(box.faces)[:, ::-1], material=rw.Diffuse(0.5), emission=1)
    scene = rw.Scene(walls, precision="double")
    for end in ((0.5, 0.5, 1), (0.5, 0.5, -1), (0.9, 0.6, 0.5 * gap)):
        camera = look((0.5, 0.5, 0.5 * gap), end, fov=30)
        image = rw.render(scene, camera, samples=16, progress=False)
        error = math.sqrt(float(np.square(image.standard_error[..., 1].astype(float)).sum())) / 1024
        # Five standard errors, which chance exceeds once in two million renders.
        assert abs(float(image.rgb[..., 1].mean(dtype=float)) - 2) <= 5 * error + 1e-6
        assert error < 0.01
        assert not image.warnings


def test_nothing_leaks_sideways_out_of_a_gap():
    # A lamp that emits upwards, and a larger black sheet a millionth above it: black from above.
    lamp = sheet(0, size=1, material=rw.Diffuse(0.5), emission=1e6)
    cover = sheet(1e-6, size=2, material=rw.Diffuse(0))
    camera = look((0, 0, 3), (0, 0, 0), fov=40)
    scene = rw.Scene([lamp, cover], precision="double")
    assert not rw.render(scene, camera, samples=16, progress=False).rgb.any()


RED, BLUE = rw.Diffuse((0.9, 0.1, 0)), rw.Diffuse((0, 0.1, 0.9))
PAIRS = {
    "meshes": lambda m: sheet(0, material=m),
    "spheres": lambda m: rw.Sphere((0.1, 0.2, 0.3), 0.7, material=m),
    "disks": lambda m: rw.Disk((0.1, 0.2, 0.3), (1, 2, 3), 2, material=m),
    "boxes": lambda m: rw.Box((-1, -1, -1), (0.3, 0.4, 0.5), material=m),
    "copies": lambda m: rw.Instance(sheet(0, material=m), np.diag([0.7, 0.7, 0.7, 1])),
}


@pytest.mark.parametrize(
    "accelerator", [rw.BVH(), rw.accelerators.KdTree(), rw.accelerators.Grid(), rw.BruteForce()], ids=repr
)
@pytest.mark.parametrize("kind", PAIRS)
def test_of_two_in_one_place_the_first_is_there(kind, accelerator):
    # Bit for bit as if there were no other, from all sides, for any accelerator.
    make = PAIRS[kind]
    for first, second in ((RED, BLUE), (BLUE, RED)):
        for position in ((3, 2, 4), (-3, 1, -2)):
            camera = rw.Camera(position, (0.1, 0, 0.2), fov=40, width=24, height=24)
            both = rw.Scene([make(first), make(second)], environment=1.0, accelerator=accelerator)
            alone = rw.Scene([make(first)], environment=1.0, accelerator=accelerator)
            one = rw.render(both, camera, samples=2, progress=False)
            other = rw.render(alone, camera, samples=2, progress=False)
            np.testing.assert_array_equal(one.rgb, other.rgb)


@pytest.mark.parametrize(
    "accelerator", [rw.accelerators.KdTree(), rw.accelerators.Grid(), rw.BruteForce()], ids=repr
)
def test_of_sheets_cut_differently_one_is_there_and_always_the_same(accelerator):
    # Rounding may decide, pixel by pixel, but nothing else does, and every sample sees one of them.
    sheets = [sheet(0, material=RED), sheet(0, diagonal=1, material=BLUE)]
    camera = look((0.3, 0.2, 2), (0.1, 0, 0), fov=60)
    default = rw.render(rw.Scene(sheets, environment=1.0), camera, samples=4, progress=False)
    scene = rw.Scene(sheets, environment=1.0, accelerator=accelerator)
    other = rw.render(scene, camera, samples=4, threads=1, progress=False)
    np.testing.assert_array_equal(default.rgb, other.rgb)
    np.testing.assert_allclose(default.rgb[..., 0] + default.rgb[..., 2], 9 * default.rgb[..., 1], rtol=1e-5)
    assert (default.rgb[..., 1] > 0).all()
