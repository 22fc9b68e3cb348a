"""Cameras told by matrices: of computer vision, and of scene files."""

import re
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import raywright as rw
from raywright import _core

# A quaternion for rotations, and camera matrices with all possible entries.
QUATERNION = np.array((3.0, 1.0, -2.0, 5.0))
SHIFT = (0.3, -1.7, 4.1)
MATRICES = {
    "plain": ((500, 0, 159.5), (0, 500, 119.5), (0, 0, 1)),
    "oblong pixels": ((700, 0, 100), (0, 450, 180), (0, 0, 1)),
    "skew": ((520.5, 13.25, 140.1), (0, 498.75, 99.9), (0, 0, 1)),
    "mirrored": ((-520.5, 4.0, 140.1), (0, 498.75, 99.9), (0, 0, 1)),
    "beside the picture": ((900, 0, -400), (0, 900, 700), (0, 0, 1)),
    "scaled": ((1000, 0, 319), (0, 1000, 239), (0, 0, 2)),
}


def rotation(quaternion=QUATERNION):
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        ]
    )


def projected(K, R, t, point):
    """Return the pixel of a point without any rounding, as a pair of fractions."""
    K, R, t, point = ([Fraction(float(x)) for x in np.ravel(a)] for a in (K, R, t, point))
    seen = [sum(R[3 * i + j] * point[j] for j in range(3)) + t[i] for i in range(3)]
    u, v, w = (sum(K[3 * i + j] * seen[j] for j in range(3)) for i in range(3))
    return u / w, v / w


@pytest.mark.parametrize("K", MATRICES.values(), ids=MATRICES)
@pytest.mark.parametrize("pixel_center", [0.0, 0.5])
def test_a_ray_goes_through_the_points_that_its_pixel_shows(K, pixel_center):
    R = rotation()
    camera = rw.Camera.from_intrinsics(K, R, SHIFT, 320, 240, pixel_center=pixel_center)
    rng = np.random.default_rng(3)
    # In front of the camera, and slightly beside the picture too.
    for before in rng.uniform((-1, -1, 2), (1, 1, 9), (40, 3)):
        point = R.T @ (before * (before[2], before[2], 1) * (0.4, 0.3, 1) - SHIFT)
        u, v = projected(K, R, SHIFT, point)
        shift = Fraction(0.5 - pixel_center)
        origin, direction = camera.rays_through((float(u + shift), float(v + shift)))
        towards = point - origin
        assert np.linalg.norm(np.cross(towards, direction)) < 1e-12 * np.linalg.norm(towards)
        assert towards @ direction > 0
        # The origin of a ray is where the projection is zero.
        assert np.abs(R @ origin + SHIFT).max() < 1e-14


@pytest.mark.parametrize("K", MATRICES.values(), ids=MATRICES)
def test_points_are_projected_where_rays_go_through(K):
    R = rotation()
    camera = rw.Camera.from_intrinsics(K, R, SHIFT, 320, 240)
    points = np.random.default_rng(4).uniform((-50, -50), (400, 300), (5, 8, 2))
    origins, ways = camera.rays_through(points)
    there = origins + np.geomspace(0.1, 1e4, 40).reshape(5, 8, 1) * ways
    assert np.abs(camera.project(there) - points).max() < 1e-9
    # OpenCV counts from the center of the first pixel.
    u, v = projected(K, R, SHIFT, there[2, 3])
    assert np.allclose(camera.project(there[2, 3]), (float(u) + 0.5, float(v) + 0.5), rtol=0, atol=1e-9)
    behind = origins - ways
    assert np.isnan(camera.project(behind)).all()
    assert np.isnan(camera.project(camera.position)).all()


def test_what_a_pixel_shows_is_projected_into_it():
    knot = rw.scenes.torus_knot(along=60, around=10)
    # At the origin, and at map coordinates.
    for place in (np.zeros(3), np.array((2.6e6, 1.2e6, 400.0))):
        moved = np.eye(4)
        moved[:3, 3] = place
        eye = place + np.array((3, 2, 6))
        camera = rw.Camera(eye, place, fov=50, width=60, height=40)
        hits = rw.Scene(knot.transformed(moved)).first_hits(camera)
        row, column = np.nonzero(hits.hit)
        assert len(row) > 100
        pixel = camera.project(hits.position[hits.hit])
        assert np.abs(pixel - np.stack([column, row], axis=-1) - 0.5).max() < 1e-6


def test_only_points_are_projected():
    with pytest.raises(ValueError, match=r"points must have shape \(\.\.\., 3\), got \(2,\)"):
        rw.Camera((0, 0, 5), (0, 0, 0)).project((1, 2))


def test_the_first_pixel_of_opencv_has_its_center_at_0():
    K = MATRICES["plain"]
    camera = rw.Camera.from_intrinsics(K, np.eye(3), np.zeros(3), 320, 240)
    _, directions = camera.rays()
    for row, column in [(0, 0), (100, 7), (239, 319)]:
        expected = np.linalg.solve(K, (column, row, 1))
        assert np.allclose(directions[row, column], expected / np.linalg.norm(expected), rtol=0, atol=1e-15)


@pytest.mark.parametrize("K", MATRICES.values(), ids=MATRICES)
def test_matrices_come_back(K):
    R = rotation()
    camera = rw.Camera.from_intrinsics(K, R, SHIFT, 320, 240)
    assert np.allclose(camera.intrinsics, np.array(K) / K[2][2], rtol=1e-15, atol=1e-12)
    found, shift = camera.extrinsics
    assert np.abs(found - R).max() < 1e-15
    assert np.abs(shift - SHIFT).max() < 1e-14
    again = rw.Camera.from_matrix(
        camera.matrix,
        focal_length_px=camera.focal_length_px,
        principal_point=camera.principal_point,
        skew=camera.skew,
    )
    assert np.abs(again.matrix - camera.matrix).max() < 1e-15


@pytest.mark.parametrize("axis", ["x", "y", "smaller", "larger", "diagonal"])
@pytest.mark.parametrize("size", [(320, 240), (240, 320), (200, 200)])
def test_an_angle_is_along_what_it_is_measured_along(axis, size):
    width, height = size
    camera = rw.Camera((1, 2, 3), (0, 0, 0), fov=70, fov_axis=axis, width=width, height=height)
    middle = (width / 2, height / 2)
    across, down = ((0, middle[1]), (width, middle[1])), ((middle[0], 0), (middle[0], height))
    ends = {
        "x": across,
        "y": down,
        "smaller": across if width < height else down,
        "larger": across if width > height else down,
        "diagonal": ((0, 0), size),
    }
    _, (a, b) = camera.rays_through(ends[axis])
    assert np.degrees(np.arccos(a @ b)) == pytest.approx(70, rel=1e-13)
    # The same camera by its matrix.
    other = rw.Camera.from_intrinsics(camera.intrinsics, *camera.extrinsics, width, height)
    for found, expected in zip(other.rays(), camera.rays(), strict=True):
        assert np.abs(found - expected).max() < 1e-14


@pytest.mark.parametrize(
    ("convention", "signs"), [("gltf", (1, 1, -1)), ("mitsuba", (-1, 1, 1)), ("opencv", (1, -1, 1))]
)
def test_conventions_of_matrices(convention, signs):
    turn = rotation()
    to_world = np.eye(4)
    to_world[:3, :3] = turn * 7.0
    to_world[:3, 3] = (4, 5, 6)
    camera = rw.Camera.from_matrix(to_world, convention, fov=60, width=8, height=6)
    assert camera.position == (4, 5, 6)
    tangent = np.tan(np.radians(30))
    for film, across, above in [((4, 3), 0, 0), ((8, 3), 4 / 3, 0), ((4, 0), 0, 1), ((0, 6), -4 / 3, -1)]:
        expected = turn @ (np.array((across * tangent, above * tangent, 1)) * signs)
        found = camera.rays_through(film)[1]
        assert np.allclose(found, expected / np.linalg.norm(expected), rtol=0, atol=1e-15)


def test_a_matrix_that_mirrors_mirrors_the_picture():
    to_world = np.eye(4)
    to_world[:3, :3] = rotation()
    straight = rw.Camera.from_matrix(to_world, fov=60, width=8, height=6, principal_point=(3.0, 2.5))
    to_world[:3, 0] *= -1
    mirrored = rw.Camera.from_matrix(to_world, fov=60, width=8, height=6, principal_point=(3.0, 2.5))
    points = np.random.default_rng(0).uniform((0, 0), (8, 6), (50, 2))
    flipped = points * (-1, 1) + (6, 0)
    assert np.abs(straight.rays_through(points)[1] - mirrored.rays_through(flipped)[1]).max() < 1e-15
    for kind, others in [(rw.Fisheye, {}), (rw.Pose, {}), (rw.ThinLens, {"f_stop": 2, "focus_distance": 1})]:
        with pytest.raises(ValueError, match="to_world must not mirror"):
            kind.from_matrix(to_world, **others)


@settings(max_examples=100, deadline=None)
@given(
    st.integers(0, 2**32),
    st.tuples(st.floats(5, 200), st.floats(5, 200)),
    st.tuples(st.floats(-60, 90), st.floats(-50, 70)),
    st.sampled_from([0.0, 0.5, 20.0, -90.0]),
    st.booleans(),
)
def test_what_is_rasterized_is_what_rays_hit(seed, focal, principal, skew, mirror):
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1, 1, (30, 1, 3)) + rng.normal(size=(30, 3, 3)) * 0.4
    scene = rw.Scene(rw.Mesh(corners.reshape(-1, 3), np.arange(90).reshape(-1, 3)))
    focal = (-focal[0] if mirror else focal[0], focal[1])
    camera = rw.Camera(
        rng.uniform(-3, 3, 3), (0, 0, 0), rng.normal(size=3), None, 33, 18,
        focal_length_px=focal, principal_point=principal, skew=skew,
    )  # fmt: skip
    found, wanted = scene.first_hits(camera), scene.intersect(*camera.rays())
    assert found == wanted
    assert np.array_equal(found.t, wanted.t)


def test_matrices_need_no_tree():
    scene = rw.Scene(rw.scenes.teapot(2))
    K = ((300, 5, 90), (0, 310, 130), (0, 0, 1))
    camera = rw.Camera.from_intrinsics(K, rotation((1, 0, 0, 0)) * (1, -1, -1), (0, 0, 9), 320, 240)
    t, *_, by_tree = _core.first_hits(scene._compiled(), camera, np.array((0.5, 0.5)), None)
    assert np.array_equal(t, scene.intersect(*camera.rays()).t)
    assert np.isfinite(t).any()
    assert by_tree < 320 * 240 / 2


BAD_R = np.diag((1.0, 1.0, -1.0))
SHEARED = np.eye(4)
SHEARED[0, 1] = 1e-3
FLAT = np.diag((1.0, 0.0, 1.0, 1.0))
K = MATRICES["plain"]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: vision(K=np.diag((0.0, 1, 1))), "K must have an inverse: K[0, 0] is 0"),
        (lambda: vision(K=np.diag((1.0, 1, 0))), "K must have an inverse: K[2, 2] is 0"),
        (lambda: vision(K=np.transpose(K)), "K must be upper triangular"),
        (lambda: vision(K=np.eye(4)), "K must have shape (3, 3), got (4, 4)"),
        (lambda: vision(K=np.full((3, 3), np.nan)), "K must be finite"),
        (lambda: vision(R=BAD_R), "R must be a rotation, got a reflection: its determinant is -1"),
        (
            lambda: vision(R=np.eye(3) * 1.001),
            "R must be a rotation, but R times its transpose deviates from 1 by 0.002",
        ),
        (lambda: vision(R=np.eye(3) + 2e-6), "R must be a rotation"),
        (lambda: vision(R=np.zeros((3, 3))), "R must be a rotation"),
        (lambda: vision(t=(0, 0, np.inf)), "t must be finite"),
        (lambda: vision(t=(0, 0)), "t must have shape (3,), got (2,)"),
        (lambda: rw.Pose.from_matrix(SHEARED), "to_world must rotate, translate and scale only"),
        (lambda: rw.Pose.from_matrix(FLAT), "to_world must have an inverse: its column 1 is zero"),
        (lambda: rw.Pose.from_matrix(np.ones((4, 4))), "to_world must have (0, 0, 0, 1) as its last row"),
        (lambda: rw.Pose.from_matrix(np.eye(3)), "to_world must have shape (4, 4), got (3, 3)"),
        (
            lambda: rw.Pose.from_matrix(np.eye(4), "pbrt"),
            "convention must be one of 'gltf', 'mitsuba', 'opencv'",
        ),
    ],
)
def test_what_is_no_matrix_is_refused(make, message):
    with pytest.raises(ValueError, match=re.escape(message)) as refusal:
        make()
    assert "\n" not in str(refusal.value)


def vision(K=K, R=None, t=(0, 0, 0)):
    return rw.Camera.from_intrinsics(K, np.eye(3) if R is None else R, t, 320, 240)


def test_a_rotation_may_be_off_by_its_roundings():
    assert vision(R=np.float32(rotation())).position == (0, 0, 0)
    assert vision(t=np.array([[1.0], [2], [3]])).position == (-1, -2, -3)
    with pytest.raises(TypeError, match="up must not be given: the matrix defines it"):
        rw.Camera.from_matrix(np.eye(4), up=(0, 0, 1))
