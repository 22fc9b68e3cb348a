"""Closest points for trimesh: its own answers, and the facts that those get wrong."""

import pickle
import subprocess
import sys

import numpy as np
import pytest
import trimesh

import raywright as rw
from raywright.compat import trimesh_proximity, trimesh_ray
from raywright.compat.trimesh_proximity import ProximityQuery, closest_point, signed_distance


@pytest.fixture(autouse=True)
def _nothing_is_left_installed():
    yield
    trimesh_proximity.uninstall()
    trimesh_ray.uninstall()


def meshes():
    torus = trimesh.creation.torus(2.0, 0.7)
    torus.apply_transform(trimesh.transformations.euler_matrix(0.3, 0.7, 1.1))
    soup = trimesh.Trimesh(
        torus.triangles.reshape(-1, 3), np.arange(3 * len(torus.faces)).reshape(-1, 3), process=False
    )
    half = trimesh.creation.icosphere()
    half.update_faces(half.triangles_center[:, 2] > 0)
    return {
        "box": trimesh.creation.box(),
        "cylinder": trimesh.creation.cylinder(1.0, 3.0, sections=64),
        "torus": torus,
        "soup": soup,
        "half": half,
    }


def around(mesh, count=300):
    """Points about a mesh, near it, and right above its corners."""
    rng = np.random.default_rng(0)
    low, high = mesh.bounds
    points = rng.uniform(low - 0.2 * mesh.scale, high + 0.2 * mesh.scale, (count, 3))
    faces = rng.integers(len(mesh.faces), size=count // 3)
    points[: count // 3] = mesh.triangles_center[faces] + rng.normal(size=(count // 3, 3)) * 0.02 * mesh.scale
    points[-20:] = 1.1 * mesh.vertices[rng.integers(len(mesh.vertices), size=20)]
    return points


def cosines(mesh, points, closest, face):
    way = points - closest
    length = np.linalg.norm(way, axis=1)
    return np.einsum("ij,ij->i", way, mesh.face_normals[face]) / np.where(length > 0, length, 1)


@pytest.mark.parametrize("name", ["box", "cylinder", "torus", "soup", "half"])
def test_answers_are_those_of_trimesh(name):
    mesh = meshes()[name]
    points = around(mesh)
    closest, distance, face = closest_point(mesh, points)
    at, far, which = trimesh.proximity.closest_point(mesh, points)
    assert (closest.dtype, distance.dtype, face.dtype) == (np.float64, np.float64, np.int64)
    # trimesh takes another face if its squared distance is at most 1e-8 larger.
    np.testing.assert_allclose(distance, far, rtol=0, atol=1e-6)
    assert (distance <= far + 1e-12).all()
    np.testing.assert_allclose(np.linalg.norm(points - closest, axis=1), distance, rtol=1e-7, atol=1e-12)
    same = np.linalg.norm(closest - at, axis=1) < 1e-7
    assert same.mean() > 0.95
    # No equally close face faces the point more.
    ours, theirs = cosines(mesh, points, closest, face), cosines(mesh, points, at, which)
    assert (ours[same] >= theirs[same] - 1e-6).all()
    signed, wanted = signed_distance(mesh, points), trimesh.proximity.signed_distance(mesh, points)
    np.testing.assert_array_equal(np.abs(signed), distance)
    # Beside the rim of an open mesh, trimesh relies on one ray, and raywright on seven.
    agree = np.abs(signed - wanted) < 1e-6
    assert agree.mean() > 0.99 if name == "half" else agree.all()


def test_inside_is_positive_and_what_is_on_the_surface_too():
    box = trimesh.creation.box()
    points = [[0, 0, 0], [0.5, 0.1, 0.1], [0.5, 0.5, 0.5], [100, -0.5, -0.5], [0.6, 0.6, 0], [0.7, 0.1, 0.1]]
    found = signed_distance(box, points)
    np.testing.assert_allclose(found, [0.5, 0, 0, -99.5, -np.sqrt(0.02), -0.2], rtol=1e-14)


def test_above_an_edge_the_face_is_the_one_that_faces_the_point():
    # A wedge with an edge along y = 0.5, from in front of it, once from below and once from above.
    corners = [[-1, 0.5, 0], [1, 0.5, 0], [0, -1, -0.5], [0, -1, 0.5]]
    wedge = trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3], [0, 3, 1], [3, 2, 1]])
    points = np.array([(0, 1, z) for z in np.linspace(-1, 1, 20)])
    closest, distance, face = closest_point(wedge, points)
    np.testing.assert_array_equal(closest, np.tile([0, 0.5, 0], (20, 1)))
    np.testing.assert_allclose(distance, np.hypot(0.5, points[:, 2]), rtol=1e-15)
    assert len({*face[:10]}) == len({*face[10:]}) == 1
    assert face[0] != face[10]
    assert (cosines(wedge, points, closest, face) > 0).all()


def test_of_two_faces_about_as_close_the_one_that_faces_the_point_counts():
    corners = [[0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, 0, -1]]
    valley = trimesh.Trimesh(corners, [[0, 1, 2], [0, 1, 3]], process=False)
    closest, distance, face = closest_point(valley, [[-0.25 - 1e-10, 0, -0.25]])
    assert face.tolist() == [1]
    np.testing.assert_allclose(closest, [[0, 0, -0.25]], rtol=0, atol=1e-15)
    np.testing.assert_allclose(distance, 0.25, rtol=1e-14)


def test_many_faces_at_one_corner():
    # The tip, which 5000 faces share, is the closest point to all points of the axis beyond it.
    turn = np.linspace(0, 2 * np.pi, 5000, endpoint=False)
    rim = np.column_stack((np.cos(turn), np.sin(turn), np.zeros(5000)))
    faces = np.column_stack((np.zeros(5000, int), 1 + np.arange(5000), 1 + (np.arange(5000) + 1) % 5000))
    cone = trimesh.Trimesh(np.vstack(([0, 0, 1], rim)), faces, process=False)
    rng = np.random.default_rng(0)
    points = np.column_stack((rng.uniform(-0.1, 0.1, (200, 2)), rng.uniform(2, 3, 200)))
    closest, _, face = closest_point(cone, points)
    np.testing.assert_array_equal(closest, np.tile([0, 0, 1], (200, 1)))
    # The face in the direction of the point.
    way = (np.arctan2(points[:, 1], points[:, 0]) / (2 * np.pi) * 5000) % 5000
    assert (np.abs((face + 0.5 - way + 2500) % 5000 - 2500) < 1.5).all()


@pytest.mark.parametrize("size", [1e-20, 1e-6, 1e20])
def test_however_small_or_large_a_mesh_is(size):
    box = trimesh.creation.box()
    box.vertices *= size
    closest, distance, _ = closest_point(box, np.array([[0.25, 0.125, 2]]) * size)
    np.testing.assert_allclose(closest / size, [[0.25, 0.125, 0.5]], rtol=1e-14)
    np.testing.assert_allclose(distance / size, [1.5], rtol=1e-14)


def test_no_points_no_faces_and_points_that_are_not_finite():
    box, empty = trimesh.creation.box(), trimesh.Trimesh()
    closest, distance, face = closest_point(box, [])
    assert (closest.shape, distance.shape, face.shape) == ((0, 3), (0,), (0,))
    assert signed_distance(box, []).shape == (0,)
    for mesh, points in ((empty, [[0, 0, 0]]), (box, [[np.nan, 0, 0]]), (box, [[np.inf, 0, 0]])):
        closest, distance, face = closest_point(mesh, points)
        assert np.isnan(closest).all()
        assert distance.tolist() == [np.inf]
        assert face.tolist() == [-1]
        assert signed_distance(mesh, points).tolist() == [-np.inf]


def test_answers_follow_the_mesh():
    box = trimesh.creation.box()
    assert closest_point(box, [[0, 0, 2]])[1].tolist() == [1.5]
    box.apply_translation((0, 0, 1))
    assert closest_point(box, [[0, 0, 2]])[1].tolist() == [0.5]
    box.update_faces(box.face_normals[:, 2] < 0.5)
    assert closest_point(box, [[0, 0, 2]])[1].tolist() == [np.sqrt(0.5)]
    assert type(pickle.loads(pickle.dumps(box))) is trimesh.Trimesh


def test_bad_input_is_refused():
    box = trimesh.creation.box()
    for ask in (closest_point, signed_distance):
        with pytest.raises(ValueError, match=r"points must have shape \(n, 3\), got \(3,\)"):
            ask(box, [0, 0, 0])
        with pytest.raises(TypeError, match="points must be real numbers"):
            ask(box, [["a", "b", "c"]])
        with pytest.raises(TypeError, match=r"mesh must be a trimesh\.Trimesh, got Mesh"):
            ask(rw.Mesh([[0, 0, 0]], []), [[0, 0, 0]])


def test_installed_it_answers_all_of_trimesh():
    mesh = trimesh.creation.icosphere()
    points = mesh.triangles_center[::50]
    theirs = trimesh.proximity.closest_point
    wanted = trimesh.proximity.thickness(mesh, points)
    with trimesh_proximity.install(), trimesh_ray.install():
        assert trimesh.proximity.closest_point is closest_point
        np.testing.assert_allclose(trimesh.proximity.thickness(mesh, points), wanted, rtol=1e-6)
        np.testing.assert_array_equal(
            mesh.nearest.on_surface(2 * points)[2], closest_point(mesh, 2 * points)[2]
        )
        np.testing.assert_array_equal(mesh.nearest.signed_distance(points), signed_distance(mesh, points))
        # One tree serves both.
        assert mesh.ray._scene is trimesh_ray.installation.intersector_of(mesh)._scene
    assert trimesh.proximity.closest_point is theirs
    query = ProximityQuery(mesh)
    np.testing.assert_array_equal(query.on_surface(points)[0], closest_point(mesh, points)[0])
    np.testing.assert_array_equal(query.signed_distance(points), signed_distance(mesh, points))
    assert trimesh_proximity.longest_ray is trimesh.proximity.longest_ray


def test_neither_rtree_nor_scipy_is_needed():
    code = """
import sys
sys.modules["rtree"] = sys.modules["scipy"] = None
import trimesh
from raywright.compat import trimesh_proximity
with trimesh_proximity.install():
    print(*trimesh.creation.box().nearest.signed_distance([[0, 0, 2], [0, 0, 0.25]]))
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout.split() == ["-1.5", "0.25"]
