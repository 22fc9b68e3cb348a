"""Where cameras come to when they are moved around what they look at."""

import math

import numpy as np
import pytest

import raywright as rw
from raywright.viewer.orbit import Orbit, View, resized, scaled

EYE = {"position": (1.0, 2.0, 6.0), "target": (0.5, 1.0, 0.0), "width": 120, "height": 90}
POSE = {name: EYE[name] for name in ("position", "target")}
K = [[150.0, 3.0, 61.0], [0.0, 140.0, 40.0], [0.0, 0.0, 1.0]]
CAMERAS = {
    "pinhole": rw.Camera(**EYE),
    "moving": rw.Camera(**EYE, end_pose=rw.Pose((1.5, 2.0, 6.0), (0.5, 1.2, 0.0))),
    "intrinsics": rw.Camera.from_intrinsics(K, np.diag([1.0, -1.0, -1.0]), (0, 0, 5), 120, 90),
    "lens": rw.ThinLens(**EYE, f_stop=0.05),
    "focused": rw.ThinLens(**EYE, aperture_radius=0.1, focus_point=(0.4, 1.1, 1.0)),
    "orthographic": rw.Orthographic(**EYE, scale=4.0),
    "fisheye": rw.Fisheye(**EYE),
    "panorama": rw.Panorama(**EYE),
}
VIEW = View(azimuth=75.0, elevation=-30.0, zoom=1.7)


@pytest.fixture(params=CAMERAS)
def camera(request):
    return CAMERAS[request.param]


def unit(vector):
    return np.asarray(vector) / np.linalg.norm(vector)


def pivot(camera):
    return np.array((0.0, 0.0, 1.0) if camera.target is None else camera.target)


def test_what_was_not_moved_is_the_camera_itself(camera):
    assert Orbit(camera).camera(View()) is camera


def test_it_goes_around_its_target_in_circles():
    orbit = Orbit(rw.Camera((0, 0, 4), (0, 0, 0)))
    for view, position in (
        (View(azimuth=90), (4, 0, 0)),
        (View(azimuth=180), (0, 0, -4)),
        (View(elevation=30), (0, 2, math.sqrt(12))),
        (View(azimuth=-90, elevation=-30), (-math.sqrt(12), -2, 0)),
        (View(zoom=2), (0, 0, 2)),
    ):
        moved = orbit.camera(view)
        assert np.allclose(moved.position, position, rtol=0, atol=1e-14)
        assert np.allclose(moved.forward, -unit(position), rtol=0, atol=1e-15)


def test_all_cameras_keep_looking_at_the_same_point(camera):
    moved = Orbit(camera, np.array([(-1, -1, 0), (1, 1, 2)])).camera(VIEW)
    assert type(moved) is type(camera)
    away = pivot(camera) - moved.position
    distance = np.linalg.norm(pivot(camera) - camera.position)
    assert np.allclose(away, moved.forward * distance / VIEW.zoom, rtol=0, atol=1e-12)
    # The camera does not roll: level lines stay level.
    right = moved.extrinsics[0][0]
    assert abs(right @ camera.up) < 1e-12


def test_the_end_of_a_movement_goes_around_as_well():
    camera = CAMERAS["moving"]
    moved = Orbit(camera).camera(VIEW)
    turn = moved.extrinsics[0].T @ camera.extrinsics[0]
    ends = [np.subtract(one.end_pose.position, one.position) for one in (camera, moved)]
    assert np.allclose(ends[1], turn @ ends[0] / VIEW.zoom, rtol=0, atol=1e-12)
    assert np.allclose(moved.end_pose.forward, turn @ camera.end_pose.forward, rtol=0, atol=1e-12)


def test_a_lens_stays_in_focus():
    for name, distance in (
        ("lens", np.linalg.norm(np.subtract(EYE["target"], EYE["position"]))),
        ("focused", 0),
    ):
        camera = CAMERAS[name]
        moved = Orbit(camera).camera(VIEW)
        assert moved.focused_distance == pytest.approx((distance or camera.focused_distance) / 1.7, rel=1e-12)
        assert moved.lens_radius == pytest.approx(camera.lens_radius, rel=1e-12)


def test_elevation_ends_before_the_poles(camera):
    orbit = Orbit(camera)
    least, most = orbit.elevations
    for end, beyond in ((least, -180.0), (most, 180.0)):
        moved = orbit.camera(View(elevation=beyond))
        assert moved == orbit.camera(View(elevation=end))
        assert abs(moved.forward @ unit(camera.up)) == pytest.approx(math.cos(math.radians(1)), abs=1e-12)


@pytest.mark.parametrize("kind", ["pinhole", "intrinsics", "orthographic"])
def test_moving_by_half_a_height_moves_the_picture_by_half_a_height(kind):
    camera = CAMERAS[kind]
    orbit = Orbit(camera, np.array([(-1, -1, 0), (1, 1, 2)]))
    (origin, _), (forward, _) = camera.rays_through([(60, 45)] * 2)
    moved = orbit.camera(View(right=0.25, up=-0.5))
    # A pixel's ray met a point in the plane of the target; it moves by this much.
    point = origin + (pivot(camera) - origin) @ camera.forward / (forward @ camera.forward) * forward
    origins, directions = moved.rays_through([(60 + 0.25 * 90, 45 + 0.5 * 90)])
    off = np.cross(point - origins[0], directions[0])
    # Pixels of that camera matrix are not square.
    assert np.linalg.norm(off) < (0.2 if kind == "intrinsics" else 1e-12)


def test_a_smaller_picture_is_of_the_same_view(camera):
    small = resized(camera, *scaled((120, 90), 1 / 3))
    assert (small.width, small.height) == (40, 30)
    points = np.random.default_rng(0).uniform((0, 0), (40, 30), (100, 2))
    for mine, theirs in zip(small.rays_through(points), camera.rays_through(3 * points), strict=True):
        assert np.allclose(mine, theirs, rtol=0, atol=1e-12, equal_nan=True)
    assert scaled((120, 90), 1 / 1000) == (1, 1)


@pytest.mark.parametrize(
    ("told", "kind", "message"),
    [
        ([1, 2], ValueError, "view must be an object, got list"),
        ({"azimuth": 1, "roll": 2}, ValueError, "view has no 'roll'"),
        ({"zoom": 0}, ValueError, "zoom must be between 0.000976562 and 1024, got 0"),
        ({"zoom": math.nan}, ValueError, "zoom must be"),
        ({"azimuth": 1e9}, ValueError, r"azimuth must be between -1e\+06 and 1e\+06, got 1e\+09"),
        ({"elevation": "5"}, TypeError, "elevation must be"),
        ({"right": None}, TypeError, "right must be"),
    ],
)
def test_views_that_make_no_sense_are_refused(told, kind, message):
    with pytest.raises(kind, match=message):
        View.read(told)


def test_views_are_read():
    assert View.read({}) == View()
    assert View.read({"zoom": 2, "up": -0.5}) == View(zoom=2.0, up=-0.5)
