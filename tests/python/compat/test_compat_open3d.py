"""Open3D's `RaycastingScene` on raywright's rays: its keys, shapes and dtypes, with arrays and tensors."""

import pickle

import numpy as np
import pytest

import raywright as rw
from raywright.compat import open3d as compat
from raywright.compat.open3d import RaycastingScene

MISS = 2**32 - 1
TRIANGLE = np.float32([[0, 0, 0], [1, 0, 0], [1, 1, 0]]), np.uint32([[0, 1, 2]])
# The dtype of each result and its dimensions after the leading ones.
KINDS = {
    "t_hit": (np.float32, ()),
    "geometry_ids": (np.uint32, ()),
    "primitive_ids": (np.uint32, ()),
    "primitive_uvs": (np.float32, (2,)),
    "primitive_normals": (np.float32, (3,)),
    "points": (np.float32, (3,)),
    "ray_ids": (np.uint32, ()),
    "ray_splits": (np.uint32, ()),
}


def box(low=0.0, high=1.0):
    corners = np.float32([(x, y, z) for x in (low, high) for y in (low, high) for z in (low, high)])
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.uint32([face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))])


@pytest.fixture
def cube():
    scene = RaycastingScene()
    scene.add_triangles(*box())
    return scene


@pytest.fixture
def open3d():
    return pytest.importorskip("open3d", exc_type=ImportError)


def test_first_hits_and_misses():
    scene = RaycastingScene()
    assert scene.add_triangles(*TRIANGLE) == 0
    assert scene.add_triangles(TRIANGLE[0] + np.float32([0, 0, 5]), TRIANGLE[1]) == 1
    rays = np.float32([[0.5, 0.25, 1, 0, 0, -2], [9, 9, 9, 1, 0, 0], [0.5, 0.25, 8, 0, 0, -1]])
    answer = scene.cast_rays(rays)
    assert answer["t_hit"].tolist() == [0.5, np.inf, 3]
    assert answer["geometry_ids"].tolist() == [0, MISS, 1]
    assert answer["primitive_ids"].tolist() == [0, MISS, 0]
    assert answer["primitive_uvs"].tolist() == [[0.25, 0.25], [0, 0], [0.25, 0.25]]
    assert answer["primitive_normals"].tolist() == [[0, 0, 1], [0, 0, 0], [0, 0, 1]]
    assert RaycastingScene.INVALID_ID == MISS


@pytest.mark.parametrize("lead", [(11,), (1, 2, 3), (4, 0), ()])
def test_results_have_the_shapes_and_dtypes_of_open3d(cube, lead):
    rng = np.random.default_rng(0)
    rays, points = rng.uniform(size=(*lead, 6)), rng.uniform(size=(*lead, 3))
    for answer in (cube.cast_rays(rays), cube.compute_closest_points(points)):
        for name, array in answer.items():
            assert (array.dtype, array.shape) == (KINDS[name][0], lead + KINDS[name][1]), name
    for array, dtype in (
        (cube.test_occlusions(rays), np.bool_),
        (cube.count_intersections(rays), np.int32),
        (cube.compute_distance(points), np.float32),
        (cube.compute_signed_distance(points), np.float32),
        (cube.compute_occupancy(points), np.float32),
    ):
        assert (array.dtype, array.shape) == (dtype, lead)
    listed, total = cube.list_intersections(rays), int(cube.count_intersections(rays).sum())
    for name, array in listed.items():
        rows = rays.size // 6 + 1 if name == "ray_splits" else total
        assert (array.dtype, array.shape) == (KINDS[name][0], (rows, *KINDS[name][1])), name


def test_all_hits_stand_by_ray_and_along_it(cube):
    rays = [[0.5, 0.25, -1, 0, 0, 1], [9, 9, 9, 0, 0, 1], [0.5, 0.25, 0.5, 0, 0, 2], [0.5, 0.5, 2, 0, 0, -1]]
    listed = cube.list_intersections(rays)
    assert listed["ray_splits"].tolist() == [0, 2, 2, 3, 5]
    assert listed["ray_ids"].tolist() == [0, 0, 2, 3, 3]
    assert listed["t_hit"].tolist() == [1, 2, 0.25, 1, 2]
    # The last goes through the diagonal that two triangles share.
    assert cube.count_intersections(rays).tolist() == [2, 0, 1, 2]


def test_occlusion_is_asked_between_two_distances(cube):
    ray = [[0.5, 0.25, 3, 0, 0, -1]]
    assert cube.test_occlusions(ray).tolist() == [True]
    assert cube.test_occlusions(ray, tnear=0.5, tfar=1.5).tolist() == [False]
    assert cube.test_occlusions(ray, 3.5).tolist() == [False]
    assert cube.test_occlusions(ray, 2.0, 2.5).tolist() == [True]


def test_distances_and_insides(cube):
    points = [[0.5, 0.5, 0.75], [-3, -4, 0.5], [0, 0, 0], [np.nan, 0, 0]]
    assert cube.compute_distance(points).tolist() == [0.25, 5, 0, np.inf]
    assert cube.compute_signed_distance(points).tolist() == [-0.25, 5, 0, np.inf]
    assert cube.compute_occupancy(points).tolist()[:2] == [1, 0]
    found = cube.compute_closest_points(points)
    assert found["points"].tolist() == [[0.5, 0.5, 1], [0, 0, 0.5], [0, 0, 0], [0, 0, 0]]
    assert found["primitive_ids"][3] == found["geometry_ids"][3] == MISS
    np.testing.assert_array_equal(cube.compute_occupancy(points, nsamples=5), cube.compute_occupancy(points))


def test_all_meshes_together_are_crossed_an_odd_number_of_times_from_inside(cube):
    cube.add_triangles(*box(0.25, 0.75))
    points = [[0.5, 0.5, 0.5], [0.125, 0.5, 0.5], [2, 0.5, 0.5]]
    assert cube.compute_occupancy(points).tolist() == [0, 1, 0]
    assert cube.compute_signed_distance(points).tolist() == [0.25, -0.125, 1]


def test_no_mesh_and_a_mesh_that_comes_later():
    scene = RaycastingScene(nthreads=2)
    ray, point = [[0.5, 0.25, 1, 0, 0, -1]], [[0.5, 0.25, 2]]
    assert scene.cast_rays(ray)["t_hit"].tolist() == scene.compute_distance(point).tolist() == [np.inf]
    assert scene.compute_closest_points(point)["primitive_ids"].tolist() == [MISS]
    assert scene.compute_occupancy(point).tolist() == [0]
    scene.add_triangles(*TRIANGLE)
    assert scene.cast_rays(ray, nthreads=1)["t_hit"].tolist() == [1]
    assert repr(scene) == "RaycastingScene(1 meshes, 1 triangles)"
    assert pickle.loads(pickle.dumps(scene)).compute_distance(point).tolist() == [2]


def test_a_mesh_is_whatever_has_vertices_and_triangles():
    scene = RaycastingScene()
    assert scene.add_triangles(rw.Mesh(*box())) == 0
    assert scene.add_triangles(mesh=rw.Mesh(*box(2, 3))) == 1
    scene.add_triangles(vertex_positions=box(4, 5)[0], triangle_indices=box()[1].astype(np.int64))
    assert scene.count_intersections([[-1, 0.5, 0.25, 1, 0, 0], [0.5, 0.25, -1, 1, 1, 1]]).tolist() == [2, 0]
    assert scene.cast_rays([[4.5, 4.25, 9, 0, 0, -1]])["geometry_ids"].tolist() == [2]


def test_rays_of_a_camera_reach_a_depth_of_one():
    inner, outer = (
        [[4, 0, 1.5], [0, 2, 1], [0, 0, 1]],
        [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]],
    )
    rays = RaycastingScene.create_rays_pinhole(inner, outer, 3, 2)
    assert (rays.dtype, rays.shape) == (np.float32, (2, 3, 6))
    ends = rays[..., :3] + rays[..., 3:]
    seen = np.einsum("ij,hwj->hwi", np.array(outer, float)[:3], np.dstack((ends, np.ones((2, 3)))))
    pixels = np.einsum("ij,hwj->hwi", np.array(inner, float), seen)
    x, y = np.meshgrid((0.5, 1.5, 2.5), (0.5, 1.5))
    np.testing.assert_allclose(pixels, np.dstack((x, y, np.ones((2, 3)))), rtol=0, atol=1e-6)


def test_rays_of_a_view_go_through_its_center():
    view = {"center": [1, 2, 3], "eye": [4, 0, 1], "up": [0, 0, 2], "width_px": 5, "height_px": 3}
    rays = RaycastingScene.create_rays_pinhole(fov_deg=90, **view)
    np.testing.assert_allclose(rays[1, 2], [4, 0, 1, *np.array([-3, 2, 2]) / np.sqrt(17)], rtol=0, atol=1e-6)
    # Four of five columns lie between the first and the last, of a width of twice the depth.
    np.testing.assert_allclose(np.linalg.norm(rays[1, 4, 3:] - rays[1, 0, 3:]), 1.6, rtol=1e-6)
    assert rays[2, 2, 5] > rays[0, 2, 5]


@pytest.mark.parametrize(
    ("ask", "error", "told"),
    [
        (
            lambda s: s.cast_rays(np.zeros((3, 5))),
            ValueError,
            r"rays must have shape \(\.\.\., 6\), got \(3, 5\)",
        ),
        (lambda s: s.compute_distance([[0, 0]]), ValueError, r"query_points must have shape \(\.\.\., 3\)"),
        (lambda s: s.cast_rays([["a"] * 6]), TypeError, "rays must be real numbers"),
        (lambda s: s.compute_occupancy([[0, 0, 0]], nsamples=2), ValueError, "nsamples must be odd, got 2"),
        (lambda s: s.cast_rays([[0] * 6], nthreads=-1), ValueError, "nthreads must be at least 0, got -1"),
        (lambda s: s.add_triangles(3), TypeError, "mesh must have vertices and triangles, got int"),
        (lambda s: RaycastingScene(device="CUDA:0"), ValueError, "device must be a CPU, got CUDA:0"),
        (
            lambda s: s.create_rays_pinhole(90, [0, 0, 1], [0, 0, 0], [0, 0, 1], 4, 4),
            ValueError,
            "up must not be parallel to center - eye",
        ),
        (
            lambda s: s.create_rays_pinhole(np.zeros((3, 3)), np.eye(4), 4, 4),
            ValueError,
            "intrinsic_matrix must have an inverse",
        ),
        (
            lambda s: s.create_rays_pinhole(np.eye(4), np.eye(4), 4, 4),
            ValueError,
            r"intrinsic_matrix must have shape \(3, 3\), got \(4, 4\)",
        ),
    ],
)
def test_bad_input_is_refused(cube, ask, error, told):
    with pytest.raises(error, match=told):
        ask(cube)


@pytest.mark.slow
def test_tensors_come_back_as_tensors(open3d, cube):
    Tensor = open3d.core.Tensor
    mesh = open3d.t.geometry.TriangleMesh.create_box()
    scene = RaycastingScene(device=open3d.core.Device("CPU:0"))
    assert scene.add_triangles(mesh) == 0
    scene.add_triangles(Tensor(TRIANGLE[0] + np.float32([3, 0, 0])), Tensor(TRIANGLE[1]))
    rays = np.float32([[0.5, 0.25, 3, 0, 0, -1], [3.5, 0.25, 3, 0, 0, -1]])
    for given in (rays, Tensor(rays)):
        answer = scene.cast_rays(given)
        assert all(isinstance(value, Tensor) for value in answer.values())
        assert answer["t_hit"].numpy().tolist() == [2, 3]
        assert answer["geometry_ids"].dtype == open3d.core.uint32
    assert isinstance(cube.cast_rays(rays)["t_hit"], np.ndarray)
    assert isinstance(cube.count_intersections(Tensor(rays)), Tensor)
    rays = RaycastingScene.create_rays_pinhole(Tensor(np.eye(3)), Tensor(np.eye(4)), 2, 2)
    assert isinstance(rays, Tensor)


@pytest.mark.slow
def test_answers_are_those_of_open3d(open3d):
    mesh = open3d.t.geometry.TriangleMesh.create_torus(1.0, 0.5)
    ours, theirs = RaycastingScene(), open3d.t.geometry.RaycastingScene()
    assert ours.add_triangles(mesh) == theirs.add_triangles(mesh)
    rng = np.random.default_rng(0)
    rays = rng.normal(size=(1000, 6)).astype(np.float32)
    found, wanted = ours.cast_rays(rays), theirs.cast_rays(rays)
    assert found.keys() == wanted.keys()
    same = found["primitive_ids"].numpy() == wanted["primitive_ids"].numpy()
    # Embree rounds: a ray near an edge may hit the face on its other side.
    assert same.mean() > 0.99
    for name in found:
        assert (found[name].dtype, found[name].shape) == (wanted[name].dtype, wanted[name].shape), name
        close = found[name].numpy()[same], wanted[name].numpy()[same]
        np.testing.assert_allclose(*close, atol=1e-4, rtol=1e-4, err_msg=name)
    points = rng.uniform(-2, 2, (1000, 3)).astype(np.float32)
    for name in ("compute_distance", "compute_signed_distance", "compute_occupancy"):
        pair = (getattr(scene, name)(points).numpy() for scene in (ours, theirs))
        np.testing.assert_allclose(*pair, atol=1e-5, err_msg=name)
    view = (60.0, [0, 0, 0], [3, 1, 2], [0, 0, 1], 8, 6)
    np.testing.assert_allclose(
        ours.create_rays_pinhole(*view), theirs.create_rays_pinhole(*view).numpy(), atol=1e-6
    )


@pytest.mark.slow
def test_installed_it_stands_in_open3d(open3d):
    own = open3d.t.geometry.RaycastingScene
    with compat.install() as installation:
        assert repr(installation) == "Installation(in force)"
        scene = open3d.t.geometry.RaycastingScene()
        assert isinstance(scene, RaycastingScene)
        assert isinstance(
            scene.create_rays_pinhole(90, [0, 0, 0], [1, 0, 0], [0, 0, 1], 2, 2), open3d.core.Tensor
        )
    assert open3d.t.geometry.RaycastingScene is own
    compat.uninstall()
