"""Sky view and ambient visibility, against closed forms."""

import numpy as np
import pytest
import trimesh

import raywright as rw

measure = rw.measure
# 95 % interval of Student's t with 15 degrees of freedom: errors come from 16 batches.
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
    # Three standard errors, with a fixed seed.
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
    # All of them together behave like independent ones.
    assert abs(found.value.mean() - 0.8) < 4 * found.value.std() / 20
    # Low-discrepancy points err less than independent ones would.
    assert found.value.std() < 0.5 * np.sqrt(0.8 * 0.2 / 256)


@pytest.mark.parametrize("share", [0.5, 0.05, 0.01, 0.003])
@pytest.mark.parametrize("rays", [64, 256, 1024])
def test_told_errors_hold_for_rare_skies_too(share, rays):
    """A disk of radius one at a height h leaves h^2 / (h^2 + 1) of the sky. Over 400 seeds the spread of the
    estimates is less than 1.15 times the mean told error: it is known to 4 / sqrt(800) = 14 % (1e-4).
    """
    high = np.sqrt(share / (1 - share))
    disk = rw.Scene(rw.Disk((0, 0, high), (0, 0, 1), 1.0))
    found = measure.sky_view(disk, np.zeros((400, 3)), (0, 0, 1), rays=rays, seed=4)
    spread = np.sqrt(((found.value - share) ** 2).mean())
    assert spread < 1.15 * found.standard_error.mean()
    # No result claims to be certain.
    assert (found.standard_error >= 1 / rays).all()
    none = found.value == 0
    assert (found.standard_error[none] == 3 / rays).all()
    assert (np.abs(found.value - share) <= 3 * found.standard_error).mean() > 0.98


PLANE = rw.Plane((0, 0, 0), (0, 0, 1))
CURB = trimesh.creation.box(bounds=[(0.0625, -5, 0), (1, 5, 0.125)])


def ground(size):
    return quad((-size, -size, 0), (size, -size, 0), (size, size, 0), (-size, size, 0))


@pytest.mark.parametrize("place", [(0, 0, 0), (3.0, 4, 0), (1e5, -1e4, 0)])
def test_one_point_on_a_plane_sees_all_of_the_sky(place):
    found = measure.sky_view(PLANE, place, (0, 0, 1))
    assert found.value == 1
    sun = measure.solar_exposure(PLANE, place, (0, 0, 1), sun=[(0, 0, 1), (1, 0, 1)], up=(0, 0, 1))
    assert sun.sunlit == 2
    assert measure.thickness(PLANE, place, (0, 0, 1)) == np.inf
    assert measure.sky_view(PLANE, PLANE_BELOW, (0, 0, 1)).value == 0


PLANE_BELOW = (0.0, 0.0, -1e-3)


def test_a_point_is_told_the_same_whatever_is_asked_with_it():
    """A curb of 1/8 that stands 1/16 away, ten long, hides as much sky as an endless wall, but for 1e-4."""
    scene = rw.Scene([PLANE, CURB])
    alone = measure.sky_view(scene, (0, 0, 0), (0, 0, 1), rays=1024)
    others = measure.sky_view(scene, [(0, 0, 0), (1e5, 0, 0), (0, 0, 1e9)], (0, 0, 1), rays=1024)
    assert alone.value == others.value[0]
    # An endless wall that stands an angle a high hides (1 - cos a) / 2.
    hidden = (1 - np.cos(np.arctan2(0.125, 0.0625))) / 2
    assert abs(1 - alone.value - hidden) < 4 * alone.standard_error
    assert np.array_equal(others.value[1:], [1, 1])
    suns = [(1, 0, 1.0), (1, 0, 2.1), (-1, 0, 0.1)]
    for points in ((0, 0, 0), [(0, 0, 0), (1e5, 0, 0)]):
        sun = measure.solar_exposure(scene, points, (0, 0, 1), sun=suns, up=(0, 0, 1))
        assert np.atleast_1d(sun.sunlit)[0] == 2


@pytest.mark.parametrize("size", [10.0, 1e3, 1e5, 1e7])
@pytest.mark.parametrize("at", [0.0, 0.01])
def test_a_curb_is_not_stepped_over_however_large_the_scene_is(size, at):
    """On the ground, and a centimeter above it."""
    scene = rw.Scene([ground(size), CURB])
    found = measure.sky_view(scene, (0, 0, at), (0, 0, 1), rays=1024)
    hidden = (1 - np.cos(np.arctan2(0.125 - at, 0.0625))) / 2
    assert abs(1 - found.value - hidden) < 4 * found.standard_error
    assert measure.sky_view(scene, (0, 0, -at - 1.0), (0, 0, 1), rays=64).value == 0


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize(("offset", "precision"), [((0, 0, 0), "single"), ((1e4, -3e3, 200.0), "double")])
def test_points_on_a_mesh_are_off_it_however_they_are_rounded(kind, offset, precision):
    """Of a convex body every point of the surface sees all of the sky above its face, from within nothing."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    ball.vertices += offset
    scene = rw.Scene(rw.Mesh(ball.vertices, ball.faces), precision=precision)
    middles = ball.triangles_center.astype(kind)
    assert (measure.sky_view(scene, middles, ball.face_normals, rays=16).value == 1).all()
    assert (measure.sky_view(scene, middles, -ball.face_normals, rays=16).value == 0).all()
    if kind == np.float64:
        corners = measure.sky_view(scene, ball.vertices, ball.vertex_normals, rays=16)
        assert (corners.value > 0.8).all()


def test_what_was_hit_is_left_exactly(box):
    scene = rw.Scene([box, rw.Disk((0.5, 0.5, 3.0), (0, 0, 1), 1.0)])
    hits = scene.intersect([[(0.5, 0.5, 2.0)], [(9.0, 9.0, 2.0)]], (0, 0, -1.0))
    found = measure.sky_view(scene, hits, rays=4096)
    assert found.value.shape == (2, 1)
    assert abs(found.value[0, 0] - 0.8) < 3 * found.standard_error[0, 0] < 0.01
    assert np.isnan(found.value[1, 0])


def test_visibility_is_of_what_is_near():
    """A ball around a point is met within its radius, and not before."""
    ball = rw.Sphere((0, 0, 0), 2.0)
    for radius, expected in ((1.99, 1.0), (2.01, 0.0), (None, 0.0)):
        found = measure.ambient_visibility(ball, (0, 0, 0), (0, 1, 0), radius=radius, rays=64, offset=0.0)
        assert found.value == expected
        # All rays agree; a share of 3 / 64 that do not would be missed in 5 % of cases.
        assert found.standard_error == 3 / 64
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
        ({"normals": (0, 0, 0)}, ValueError, "normals must not contain zero vectors"),
        ({"normals": None}, ValueError, "normals must be given, unless points are"),
        ({"points": (0, np.nan, 0)}, ValueError, "points must be finite"),
        (
            {"points": np.zeros((3, 3)), "normals": np.ones((2, 3))},
            ValueError,
            "leading shapes do not broadcast",
        ),
        ({"points": (0, 0)}, ValueError, r"points must have shape \(\.\.\., 3\)"),
        ({"offset": -1}, ValueError, "offset must be finite and at least 0"),
        ({"up": np.zeros(3)}, ValueError, "up must not contain zero vectors"),
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


def test_without_points_it_is_measured_at_the_middle_of_every_face():
    floor = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
    faces = [(0, 1, 2), (0, 2, 3)]
    shapes = [rw.Mesh(floor, faces), rw.Mesh(np.array(floor) + np.array([0, 1, 0]), faces)]
    scene = rw.Scene(shapes)
    middles = np.concatenate([mesh.vertices[mesh.faces].mean(axis=1) for mesh in shapes])
    under = scene.intersect(middles + np.array([0, 0.5, 0]), (0, -1, 0))
    for measure in (rw.measure.sky_view, rw.measure.ambient_visibility):
        found, expected = measure(shapes), measure(scene, under)
        assert found.value.shape == (4,)
        # Directions are equal, and places but for rounding, so that a ray along an edge may differ.
        assert np.allclose(found.value, expected.value, rtol=0, atol=1 / 256)
    sun = [(0, 1, 0), (0, 1, 1)]
    lit = rw.measure.solar_exposure(shapes, sun=sun)
    assert np.array_equal(lit.sunlit, rw.measure.solar_exposure(scene, under, sun=sun).sunlit)
    with pytest.raises(ValueError, match="points must be given: shape 0 is a Sphere, not a mesh"):
        rw.measure.sky_view(rw.Sphere((0, 0, 0), 1))
