"""Cones touch what has a point in them: by brute force, samples, an optimizer and closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

import raywright as rw
from raywright.scenes import torus_knot

KNOT = torus_knot(along=100, around=12)
ACCELERATORS = (rw.BVH(), rw.accelerators.KdTree(), rw.accelerators.Grid(), rw.accelerators.Octree())


def some_cones(count, seed):
    rng = np.random.default_rng(seed)
    vertices = np.asarray(KNOT.vertices)
    size = np.ptp(vertices, axis=0).max()
    origins = rng.normal(size=(count, 3)) * size
    directions = vertices[rng.integers(len(vertices), size=count)] - origins
    return origins, directions, rng.choice([0, 1e-3, 1, 10, 45, 85], count)


@pytest.mark.parametrize("accelerator", ACCELERATORS, ids=lambda a: type(a).__name__)
def test_every_accelerator_agrees_with_brute_force(accelerator):
    cones = some_cones(60, 1)
    wanted = rw.Scene(KNOT, accelerator=rw.BruteForce()).faces_in_cone(*cones)
    assert rw.Scene(KNOT, accelerator=accelerator).faces_in_cone(*cones) == wanted
    assert len(wanted) > 1000


def test_the_nearest_come_first_and_t_max_and_threads_change_nothing_else():
    scene = rw.Scene([KNOT, KNOT])
    origins, directions, angles = some_cones(200, 2)
    every = scene.faces_in_cone(origins, directions, angles)
    for threads in (1, 3):
        assert scene.faces_in_cone(origins, directions, angles, threads=threads) == every
    order = np.lexsort((every.primitive_id, every.shape_id, every.distance, every.cone))
    assert np.array_equal(order, np.arange(len(every)))
    middle = np.median(every.distance)
    near = scene.faces_in_cone(origins, directions * 8, angles, t_max=middle)
    kept = every.distance <= middle
    assert np.array_equal(near.distance, every.distance[kept])
    assert np.array_equal(near.primitive_id, every.primitive_id[kept])
    assert np.array_equal(near.cone, every.cone[kept])


def test_a_cone_of_no_angle_is_a_ray():
    scene = rw.Scene(KNOT)
    origins, directions, _ = some_cones(300, 3)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    touches, hits = scene.faces_in_cone(origins, directions, 0), scene.intersect_all(origins, directions)
    touched = set(zip(touches.cone.tolist(), touches.primitive_id.tolist(), strict=True))
    assert touched >= set(zip(hits.ray.tolist(), hits.primitive_id.tolist(), strict=True))
    assert hits.t.size > 300


def test_a_square_has_its_distances_in_closed_form():
    square = rw.Mesh([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [(0, 1, 2), (0, 2, 3)])
    scene = rw.Scene(square)
    # A plane at height 1 under a slanted axis: the nearest generator is the steepest one.
    for tilt, angle in [(0, 10), (30, 10), (30, 50), (60, 20), (75, 3)]:
        way = (np.sin(np.radians(tilt)), 0.001, -np.cos(np.radians(tilt)))
        steepest = max(tilt - angle, 0)
        distance = scene.faces_in_cone((0, 0.001, 1), way, angle).distance[0]
        assert distance == pytest.approx(1 / np.cos(np.radians(steepest)), rel=1e-5)
    # Straight down, with exact numbers.
    assert np.array_equal(scene.faces_in_cone((0, 0, 2), (0, 0, -5), 1).distance, (2, 2))
    # A cone up to its height touches both faces at one point, and a shorter one touches none.
    assert scene.faces_in_cone((0, 0, 2), (0, 0, -1), 30, t_max=2).count == 2
    assert scene.faces_in_cone((0, 0, 2), (0, 0, -1), 30, t_max=np.nextafter(2, 0)).count == 0
    assert scene.faces_in_cone((0, 0, 2), (0, 0, 1), 89).count == 0


def nearest_by_optimizer(corners, apex, axis, angle):
    """Return the least distance over weights of corners; None where no start leads into the cone."""
    cosine = np.cos(np.radians(angle))

    def point(w):
        return corners[0] + w[0] * (corners[1] - corners[0]) + w[1] * (corners[2] - corners[0]) - apex

    constraints = (
        {"type": "ineq", "fun": lambda w: 1 - w[0] - w[1]},
        {"type": "ineq", "fun": lambda w: point(w) @ axis - cosine * np.linalg.norm(point(w))},
    )
    best = None
    for start in [(1 / 3, 1 / 3), (0.9, 0.05), (0.05, 0.9), (0.02, 0.02)]:
        found = minimize(
            lambda w: point(w) @ point(w),
            start,
            bounds=[(0, 1), (0, 1)],
            constraints=constraints,
            method="SLSQP",
            options={"ftol": 1e-15, "maxiter": 200},
        )
        inside = all(c["fun"](found.x) > -1e-9 for c in constraints)
        if found.success and inside:
            distance = np.sqrt(found.fun)
            best = distance if best is None else min(best, distance)
    return best


def test_distances_are_those_of_an_optimizer():
    rng = np.random.default_rng(4)
    agreed = 0
    for _ in range(75):
        corners, apex = rng.uniform(-1, 1, (3, 3)), rng.uniform(-1, 1, 3)
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        angle = rng.choice([5, 20, 45, 70])
        wanted = nearest_by_optimizer(corners, apex, axis, angle)
        found = rw.Scene(rw.Mesh(corners, [(0, 1, 2)]), precision="double").faces_in_cone(apex, axis, angle)
        if wanted is not None:
            assert found.distance == pytest.approx([wanted], rel=1e-5, abs=1e-6)
            agreed += 1
    assert agreed > 20


coordinates = st.tuples(*[st.integers(-4, 4).map(lambda x: x / 2) | st.floats(-2, 2, width=32)] * 3)


@given(
    corners=st.tuples(coordinates, coordinates, coordinates),
    apex=coordinates,
    axis=coordinates,
    angle=st.sampled_from([0, 0.01, 10, 45, 80, 89.99]),
)
def test_nothing_that_dense_sampling_finds_is_missed(corners, apex, axis, angle):
    if np.linalg.norm(axis) < 1e-6:
        return
    found = rw.Scene(rw.Mesh(corners, [(0, 1, 2)])).faces_in_cone(apex, axis, angle)
    u, v = (x.ravel() / 40 for x in np.mgrid[0:41, 0:41])
    u, v = u[u + v <= 1], v[u + v <= 1]
    a, b, c = np.asarray(corners)
    q = a + u[:, None] * (b - a) + v[:, None] * (c - a) - apex
    axis = np.asarray(axis) / np.linalg.norm(axis)
    height, apart = q @ axis, np.linalg.norm(np.cross(q, axis), axis=1)
    radians = np.radians(angle)
    inside = (apart * np.cos(radians) <= height * np.sin(radians)) & (height >= 0)
    if inside.any():
        least = np.linalg.norm(q[inside], axis=1).min()
        assert found.count == 1
        assert found.distance[0] <= least + 1e-13
    # The result is near the cone: no sample is nearer to the apex than the triangle.
    if found.count:
        assert (
            found.distance[0] >= rw.Scene(rw.Mesh(corners, [(0, 1, 2)])).closest_point(apex).distance - 1e-13
        )


def test_shapes_broadcast_and_angles_may_differ(scene):
    touches = scene.faces_in_cone((0.5, 0.5, 4), np.full((4, 1, 3), (0, 0, -1.0)), [1, 10, 50])
    assert touches.shape == touches.count.shape == (4, 3)
    assert len(touches.cone_splits) == 13
    assert (np.diff(touches.count, axis=1) >= 0).all()
    assert "12 cones" in repr(touches)
    assert not touches.distance.flags.writeable
    assert scene.faces_in_cone(np.zeros((0, 3)), (0, 0, 1), 5).shape == (0,)
    assert touches != scene.faces_in_cone((0.5, 0.5, 4), (0, 0, -1), 1)


def test_hostile_cones_and_scenes_touch_nothing():
    degenerate = rw.Mesh([(0, 0, 1), (np.nan, 0, 0), (0, 0, 2)], [(0, 1, 2), (0, 0, 0), (0, 2, 2)])
    with pytest.warns(RuntimeWarning, match="NaN"):
        touches = rw.Scene(degenerate).faces_in_cone((0, 0, 0), (0, 0, 1), 0)
    # The cone touches a point and a line, which no ray hits; the face with NaN is dropped.
    assert touches.primitive_id.tolist() == [1, 2]
    assert touches.distance.tolist() == [1, 1]
    empty = rw.Scene([]).faces_in_cone(np.zeros((2, 3)), (0, 0, 1), 40)
    assert empty.count.tolist() == [0, 0]
    bad = [(np.nan, 0, 0), (np.inf, 0, 0), (0, 0, 0)]
    assert not rw.Scene(KNOT).faces_in_cone((0, 0, 0), bad, 89).count.any()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"half_angle": 90}, "half_angle must be at least 0 and less than 90 degrees, got 90"),
        ({"half_angle": -1.0}, "half_angle must be at least 0"),
        ({"half_angle": [1, np.nan]}, "half_angle must be at least 0 and less than 90 degrees, got nan"),
        ({"half_angle": [1, 2], "origins": np.zeros((3, 3))}, "do not broadcast"),
        ({"half_angle": 1, "t_max": np.nan}, "t_max must not be NaN"),
        ({"half_angle": 1, "origins": (0, 0)}, "origins must have shape"),
        ({"half_angle": 1, "threads": 0}, "threads must be at least 1"),
    ],
)
def test_what_is_no_cone_is_refused(scene, arguments, message):
    with pytest.raises(ValueError, match=message):
        scene.faces_in_cone(**{"origins": (0, 0, 0), "directions": (0, 0, 1)} | arguments)


def test_curved_shapes_are_refused():
    with pytest.raises(ValueError, match="only meshes, and shape 0"):
        rw.Scene(rw.Sphere((0, 0, 0), 1)).faces_in_cone((0, 0, 3), (0, 0, -1), 5)
