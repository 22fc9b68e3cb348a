"""Sky view and ambient visibility, against closed forms."""

import numpy as np
import pytest

import raywright as rw

measure = rw.measure
# Students t of 15 degrees of freedom, between which 95 % lie: errors are told by 16 batches.
T95 = 2.1314


def quad(a, b, c, d):
    return rw.Mesh([a, b, c, d], [(0, 1, 2), (0, 2, 3)])


def street(width, height, half=1e4, floor=True):
    """A street along x between two walls, y up: so long that its ends show less than 1e-6 of the sky."""
    w = width / 2
    walls = [quad((-half, 0, z), (half, 0, z), (half, height, z), (-half, height, z)) for z in (-w, w)]
    ground = [quad((-half, 0, -w), (half, 0, -w), (half, 0, w), (-half, 0, w))] if floor else []
    return rw.Scene(walls + ground)


def test_the_floor_of_a_street_sees_what_walls_leave():
    """Of an endless street the share is (cos a + cos b) / 2, with a and b how high the walls stand above
    the place.
    """
    width, height = 10.0, 12.0
    scene = street(width, height)
    z = np.array([-4.9, -2.0, 0.0, 3.0])
    points = np.stack([np.zeros(4), np.zeros(4), z], axis=-1)
    found = measure.sky_view(scene, points, (0, 1, 0), rays=8192, offset=1e-9)
    left, right = (np.cos(np.arctan2(height, width / 2 + side * z)) for side in (1, -1))
    assert found.rays == 8192
    assert (found.standard_error < 0.002).all()
    # Three standard errors, of a seed that stands.
    assert (np.abs(found.value - (left + right) / 2) < 3 * found.standard_error).all()


def test_a_wall_of_a_street_sees_the_sky_above_the_other():
    """(1 - sin a) / 2, with a how high the other wall stands above the place; below the horizon is no sky."""
    width, height = 10.0, 12.0
    for floor in (True, False):
        scene = street(width, height, floor=floor)
        points = [(0.0, y, -width / 2) for y in (2.0, 6.0, 11.5)]
        found = measure.sky_view(scene, points, (0, 0, 1), rays=8192, up=(0, 2, 0), offset=1e-9)
        high = np.arctan2(height - np.array([2.0, 6.0, 11.5]), width)
        assert (found.standard_error < 0.002).all()
        assert (np.abs(found.value - (1 - np.sin(high)) / 2) < 3 * found.standard_error).all()


def test_under_a_disk():
    """A point at a distance a from the axis of a disk of radius r, h above it, sees of it
    (1 - (a^2 + h^2 - r^2) / sqrt((a^2 + h^2 + r^2)^2 - 4 a^2 r^2)) / 2 (Howell, Catalog of Configuration
    Factors, B-13).
    """
    h, r = 2.0, 1.5
    a = np.array([0.0, 0.7, 2.5])
    points = np.stack([a, np.zeros(3), np.zeros(3)], axis=-1)
    found = measure.sky_view(rw.Disk((0, 0, h), (0, 0, 1), r), points, (0, 0, 1), rays=8192)
    squares = a**2 + h**2
    hidden = (1 - (squares - r**2) / np.sqrt((squares + r**2) ** 2 - 4 * a**2 * r**2)) / 2
    assert (found.standard_error < 0.002).all()
    assert (np.abs(found.value - (1 - hidden)) < 3 * found.standard_error).all()


def test_errors_are_told_as_they_are():
    """Of 400 independent estimates, 95 % lie within t standard errors of the truth: 3.3 deviations of a
    binomial are 3.6 %.

    Errors of 16 batches of few rays are not quite normal, which takes up to another 1.5 %.
    """
    points = np.zeros((400, 3))
    disk = rw.Scene(rw.Disk((0, 0, 2.0), (0, 0, 1), 1.0))
    found = measure.sky_view(disk, points, (0, 0, 1), rays=256, seed=3)
    inside = np.abs(found.value - 0.8) < T95 * found.standard_error
    assert 0.90 < inside.mean() < 0.99
    # And all of them together, as independent ones.
    assert abs(found.value.mean() - 0.8) < 4 * found.value.std() / 20
    # Low-discrepancy points err less than independent ones would.
    assert found.value.std() < 0.5 * np.sqrt(0.8 * 0.2 / 256)


def test_what_was_hit_is_left_exactly(box):
    scene = rw.Scene([box, rw.Disk((0.5, 0.5, 3.0), (0, 0, 1), 1.0)])
    hits = scene.intersect([[(0.5, 0.5, 2.0)], [(9.0, 9.0, 2.0)]], (0, 0, -1.0))
    found = measure.sky_view(scene, hits, rays=4096)
    assert found.value.shape == (2, 1)
    assert abs(found.value[0, 0] - 0.8) < 3 * found.standard_error[0, 0] < 0.01
    assert np.isnan(found.value[1, 0])
    with pytest.raises(ValueError, match="read-only"):
        found.value[0] = 1


def test_visibility_is_of_what_is_near():
    """A ball around a point is met within its radius, and not before."""
    ball = rw.Sphere((0, 0, 0), 2.0)
    for radius, expected in ((1.99, 1.0), (2.01, 0.0), (None, 0.0)):
        found = measure.ambient_visibility(ball, (0, 0, 0), (0, 1, 0), radius=radius, rays=64, offset=0.0)
        assert found.value == expected
        assert found.standard_error == 0
    # A plane at a distance d is within r in a cone whose cosine is d / r: the share is its sine squared.
    wall = rw.Plane((0, 0, 1.0), (0, 0, 1))
    found = measure.ambient_visibility(wall, (0, 0, 0), (0, 0, 1), radius=2.0, rays=8192, offset=0.0)
    assert abs(found.value - 0.25) < 3 * found.standard_error < 0.006


def test_seeds_batches_and_threads():
    disk = rw.Disk((0, 0, 2.0), (0, 0, 1), 1.0)
    points = np.zeros((70, 3))
    one = measure.sky_view(disk, points, (0, 0, 1), rays=32, threads=1)
    two = measure.sky_view(disk, points, (0, 0, 1), rays=17, threads=2)
    assert np.array_equal(one.value, two.value)
    other = measure.sky_view(disk, points, (0, 0, 1), rays=32, seed=1)
    assert not np.array_equal(one.value, other.value)
    told = []
    measure.sky_view(disk, points, (0, 0, 1), rays=32, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1


@pytest.mark.parametrize(
    ("arguments", "error", "told"),
    [
        ({"rays": 8}, ValueError, "rays must be at least 16, got 8"),
        ({"normals": (0, 0, 0)}, ValueError, "normals must have a length, and one is 0"),
        ({"normals": None}, ValueError, "normals must be given, unless points are"),
        ({"points": (0, np.nan, 0)}, ValueError, "points must be finite"),
        (
            {"points": np.zeros((3, 3)), "normals": np.ones((2, 3))},
            ValueError,
            "leading shapes do not broadcast",
        ),
        ({"points": (0, 0)}, ValueError, r"points must have shape \(\.\.\., 3\)"),
        ({"offset": -1}, ValueError, "offset must be finite and at least 0"),
        ({"up": np.zeros(3)}, ValueError, "up must have a length"),
        ({"seed": -1}, ValueError, "seed must be between 0"),
        ({"progress": "bar"}, TypeError, "progress must be True, False or a function"),
        ({"points": "here"}, TypeError, "points must be real numbers"),
    ],
)
def test_wrong_input_gets_one_line(box, arguments, error, told):
    given = {"points": (0.5, 0.5, 1.0), "normals": (0, 0, 1), **arguments}
    with pytest.raises(error, match=told):
        measure.sky_view(box, **given)
    with pytest.raises(ValueError, match="radius must be greater than 0"):
        measure.ambient_visibility(box, (0.5, 0.5, 1.0), (0, 0, 1), radius=0)
