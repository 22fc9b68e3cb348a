"""The closest point of a surface, and how far inside or outside it is."""

import copy
import pickle

import numpy as np
import pytest
import trimesh

import raywright as rw

KNOT = rw.scenes.torus_knot(along=40, around=6)


def brute_force(mesh, points):
    """Distances by trimesh's formula, of each point to every face: (P, F)."""
    triangles = mesh.vertices[mesh.faces].astype(np.float64)
    pairs = np.repeat(points, len(triangles), axis=0), np.tile(triangles, (len(points), 1, 1))
    closest = trimesh.triangles.closest_point(pairs[1], pairs[0])
    return np.linalg.norm(closest - pairs[0], axis=1).reshape(len(points), -1)


@pytest.mark.parametrize("accelerator", [rw.BVH(), rw.BruteForce()])
def test_distances_are_the_least_of_all_faces(accelerator):
    points = np.random.default_rng(1).uniform(-2, 2, (300, 3))
    distances = brute_force(KNOT, points)
    closest = rw.Scene(KNOT, accelerator=accelerator).closest_point(points)
    assert np.allclose(closest.distance, distances.min(axis=1), rtol=1e-12, atol=1e-14)
    told = distances[np.arange(300), closest.primitive_id]
    assert np.allclose(told, closest.distance, rtol=1e-12, atol=1e-14)
    assert np.allclose(np.linalg.norm(points - closest.position, axis=1), closest.distance, atol=1e-14)
    corners = KNOT.vertices[KNOT.faces[closest.primitive_id]]
    u, v = closest.uv.T[..., None]
    assert (closest.uv >= 0).all()
    assert (closest.uv.sum(axis=1) <= 1 + 1e-15).all()
    there = (1 - u - v) * corners[:, 0] + u * corners[:, 1] + v * corners[:, 2]
    assert np.allclose(there, closest.position, rtol=0, atol=1e-14)


def test_a_box_has_its_closest_points_in_closed_form(scene):
    points = np.random.default_rng(2).uniform(-1, 2, (2000, 3))
    outside = ((points < 0) | (points > 1)).any(axis=1)
    closest = scene.closest_point(points)
    assert np.allclose(closest.position[outside], np.clip(points, 0, 1)[outside], rtol=0, atol=1e-15)
    depth = np.minimum(points, 1 - points).min(axis=1)
    assert np.allclose(closest.distance[~outside], depth[~outside], rtol=0, atol=1e-15)
    signed = scene.signed_distance(points)
    assert np.array_equal(signed, np.where(outside, closest.distance, -closest.distance))
    assert 50 < outside.sum() < 1950


def test_on_the_surface_the_distance_is_zero(scene):
    points = np.array([(0.25, 0.5, 1), (0, 0, 0), (1, 0.5, 0.5), (0.5, 1, 0.0)])
    assert np.array_equal(scene.closest_point(points).distance, np.zeros(4))
    signed = scene.signed_distance(points)
    assert np.array_equal(signed, np.zeros(4))
    assert not np.signbit(signed).any()


def test_of_equal_distances_the_first_shape_and_face_are_told(box):
    closest = rw.Scene([box, box]).closest_point([(0.5, 0.5, 0.5), (-1, -1, -1), (0.25, 0.75, 2)])
    assert np.array_equal(closest.shape_id, [0, 0, 0])
    assert closest.primitive_id[0] == closest.primitive_id[1] == 0


def test_max_distance_is_included_and_per_point(scene):
    limits = np.array([0.5, np.nextafter(1, 0), 1.0, np.inf])
    closest = scene.closest_point((0.25, 0.5, 2), limits)
    assert np.array_equal(closest.found, [False, False, True, True])
    assert np.array_equal(closest.distance, [np.inf, np.inf, 1, 1])
    assert np.array_equal(closest.primitive_id >= 0, closest.found)
    assert np.isnan(closest.position[~closest.found]).all()
    assert np.array_equal(closest.position[closest.found], [(0.25, 0.5, 1)] * 2)
    assert scene.closest_point(np.zeros((3, 1, 3)), limits).shape == (3, 4)
    assert scene.closest_point(np.full((4, 3), 9.0), 1).shape == (4,)


def test_what_is_not_finite_has_no_closest_point(scene):
    points = np.full((4, 3), 0.5)
    points[[0, 1, 2], [0, 1, 2]] = np.nan, np.inf, -np.inf
    closest = scene.closest_point(points)
    assert np.array_equal(closest.found, [False, False, False, True])
    assert np.array_equal(closest.distance[:3], np.full(3, np.inf))
    assert np.array_equal(closest.shape_id[:3], np.full(3, -1))
    assert np.isnan(closest.normal[:3]).all()
    assert np.array_equal(scene.signed_distance(points), [np.inf, np.inf, np.inf, -0.5])
    nothing = rw.Scene([])
    assert not nothing.closest_point(points).found.any()
    assert np.array_equal(nothing.signed_distance((0, 0, 0)), np.inf)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_neither_threads_nor_batches_change_the_answer(dtype):
    scene = rw.Scene(KNOT)
    points = np.random.default_rng(3).uniform(-2, 2, (30, 100, 3)).astype(dtype)
    expected = scene.closest_point(points)
    assert expected.shape == (30, 100)
    for threads in (1, 3):
        assert scene.closest_point(points, threads=threads) == expected
        assert np.array_equal(scene.signed_distance(points, threads=threads), scene.signed_distance(points))
    for i in range(0, 30, 7):
        row = scene.closest_point(np.asfortranarray(points[i]))
        assert np.array_equal(row.distance, expected.distance[i])
        assert np.array_equal(row.position, expected.position[i])
        assert np.array_equal(row.primitive_id, expected.primitive_id[i])
        assert scene.closest_point(points[i, 3]).distance == expected.distance[i, 3]


def test_double_precision_keeps_small_things_far_away():
    ball = trimesh.creation.icosphere(subdivisions=2)
    mesh = rw.Mesh(ball.vertices * 1e-3 + 1e7, ball.faces)
    scene = rw.Scene(mesh, precision="double")
    rng = np.random.default_rng(4)
    way = rng.normal(size=(200, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    points = 1e7 + way * rng.choice([5e-4, 2e-3], (200, 1))
    signed = scene.signed_distance(points)
    radius = np.linalg.norm(points - 1e7, axis=1)
    assert np.array_equal(signed < 0, radius < 1e-3)
    # The ball's facets lie up to 4 % inside its sphere.
    assert np.allclose(signed, radius - 1e-3, atol=4e-5)


def test_closest_points_are_values(scene):
    points = np.full((2, 3), (0.3, 0.4, 2.0))
    closest = scene.closest_point(points)
    types = {
        "distance": "f8",
        "position": "f8",
        "normal": "f8",
        "uv": "f8",
        "primitive_id": "i4",
        "shape_id": "i4",
    }
    for name, dtype in {**types, "instance_id": "i4", "found": "?"}.items():
        assert getattr(closest, name).dtype == dtype
        assert getattr(closest, name).flags.writeable == (dtype in ("f8", "?"))
    assert np.array_equal(closest.normal, [(0, 0, 1)] * 2)
    assert len(closest) == 2
    assert repr(closest) == "ClosestPoints(shape=(2,), 2 of 2 found)"
    assert closest == scene.closest_point(points)
    assert closest != scene.closest_point(points + 1)
    for back in (pickle.loads(pickle.dumps(closest)), copy.deepcopy(closest)):
        assert back == closest
        assert np.array_equal(back.position, closest.position)
    with pytest.raises(AttributeError):
        closest.distance = None


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (((0, 0),), ValueError, r"points must have shape \(\.\.\., 3\), got \(2,\)"),
        (((0, 0, 0), np.nan), ValueError, r"max_distance must not be NaN"),
        (((0, 0, 0), -1.0), ValueError, r"max_distance must be at least 0, got -1.0"),
        (((0, 0, 0), [1, -2]), ValueError, r"max_distance must be at least 0, got -2.0"),
        (((0, 0, 0), "near"), TypeError, r"max_distance must be real numbers, got 'near'"),
        (
            (np.zeros((2, 3)), np.ones(3)),
            ValueError,
            r"do not broadcast: points \(2,\), max_distance \(3,\)",
        ),
        (((0, 0, 0), 1, 0), ValueError, r"threads must be at least 1, got 0"),
    ],
)
def test_bad_points_are_refused_in_one_line(scene, arguments, error, message):
    with pytest.raises(error, match=message) as caught:
        scene.closest_point(*arguments)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("accelerator", [rw.BVH(), rw.BruteForce(), rw.accelerators.KdTree()])
def test_only_shapes_that_are_named_count(accelerator):
    """As in a scene of these alone: meshes, what is no mesh, and instances."""
    rng = np.random.default_rng(11)
    box = trimesh.creation.box()
    shapes = [
        rw.Mesh(box.vertices, box.faces, name="box"),
        rw.Sphere((0.8, 0, 0), 0.6, name="ball"),
        KNOT,
        rw.Instance(rw.Mesh(box.vertices, box.faces), np.diag([0.5, 2, 0.5, 1]), name="pillar"),
        rw.Mesh(box.vertices + np.array((0, 0, 1)), box.faces[2:], name="open"),
    ]
    scene = rw.Scene(shapes, accelerator=accelerator, precision="double")
    points = rng.uniform(-2, 2, (300, 3))
    for mask in (*np.eye(5, dtype=bool), [True, True, False, False, False], [False, False, True, True, True]):
        kept = [shape for shape, counts in zip(shapes, mask, strict=True) if counts]
        alone = rw.Scene(kept, accelerator=accelerator, precision="double")
        found, wanted = scene.closest_point(points, shapes=mask), alone.closest_point(points)
        assert np.array_equal(found.distance, wanted.distance)
        assert np.array_equal(found.position, wanted.position)
        assert np.array_equal(found.primitive_id, wanted.primitive_id)
        assert np.array_equal(found.shape_id, np.flatnonzero(mask)[wanted.shape_id])
        assert np.allclose(found.normal, wanted.normal)
        assert np.array_equal(scene.signed_distance(points, shapes=mask), alone.signed_distance(points))
    near = scene.closest_point(points, max_distance=0.3, shapes=["ball", "pillar"])
    assert set(np.unique(near.shape_id)) == {-1, 1, 3}
    assert np.isinf(scene.signed_distance(points, shapes=np.zeros(5, bool))).all()
    # The ball beside the box is outside of the box, but inside the scene.
    assert scene.signed_distance((1.2, 0, 0)) < 0
    assert scene.signed_distance((1.2, 0, 0), shapes="box") == pytest.approx(0.7)
    for ask in (scene.closest_point, scene.signed_distance):
        with pytest.raises(ValueError, match="shapes has 'near', which is not the name of a shape"):
            ask(points, shapes="near")
        with pytest.raises(TypeError, match="shapes must be bool"):
            ask(points, shapes=np.ones(5))
