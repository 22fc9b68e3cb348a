"""Rays for trimesh: the interface of its own intersectors, and the facts that those get wrong."""

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest
import trimesh
from trimesh.ray import ray_triangle

import raywright as rw
from raywright.compat import trimesh_ray
from raywright.compat.trimesh_ray import RayMeshIntersector


@pytest.fixture(autouse=True)
def _nothing_is_left_installed():
    yield
    trimesh_ray.uninstall()


@pytest.fixture
def engine():
    """The intersector of embree, for those who have it."""
    return pytest.importorskip("trimesh.ray.ray_pyembree", exc_type=ImportError).RayMeshIntersector


def meshes():
    twisted = trimesh.creation.torus(2.0, 0.7)
    twisted.apply_transform(trimesh.transformations.euler_matrix(0.3, 0.7, 1.1))
    return {
        "box": trimesh.creation.box(),
        "sphere": trimesh.creation.icosphere(subdivisions=3),
        "torus": twisted,
        "shells": trimesh.util.concatenate(
            [trimesh.creation.icosphere(subdivisions=2, radius=r) for r in (0.5, 1, 1.5)]
        ),
    }


def rays(mesh, count=1000, seed=0):
    """Rays from around a mesh to points well within its faces."""
    rng = np.random.default_rng(seed)
    faces = rng.integers(len(mesh.faces), size=count)
    weights = 0.1 + 0.7 * rng.dirichlet((1, 1, 1), size=count)
    targets = (mesh.triangles[faces] * weights[..., np.newaxis]).sum(axis=1)
    origins = mesh.centroid + rng.normal(size=(count, 3)) * mesh.scale
    return origins, (targets - origins) * rng.uniform(0.1, 3, size=(count, 1))


def by_ray(index_tri, index_ray, locations):
    """The same hits, by ray and then along each."""
    order = np.lexsort((index_tri, index_ray))
    return index_tri[order], index_ray[order], locations[order]


@pytest.mark.parametrize("name", ["box", "sphere", "torus", "shells"])
def test_answers_are_those_of_trimesh(name):
    mesh = meshes()[name]
    ours, theirs = RayMeshIntersector(mesh), ray_triangle.RayMeshIntersector(mesh)
    origins, directions = rays(mesh, 300)
    found = by_ray(*ours.intersects_id(origins, directions, return_locations=True))
    wanted = by_ray(*theirs.intersects_id(origins, directions, return_locations=True))
    np.testing.assert_array_equal(found[0], wanted[0])
    np.testing.assert_array_equal(found[1], wanted[1])
    np.testing.assert_allclose(found[2], wanted[2], atol=1e-9)
    away = np.arange(len(origins)) % 3 == 0
    directions[away] *= -1
    for method in ("intersects_first", "intersects_any"):
        np.testing.assert_array_equal(
            getattr(ours, method)(origins, directions), getattr(theirs, method)(origins, directions)
        )
    points = np.random.default_rng(1).uniform(*mesh.bounds, size=(500, 3))
    np.testing.assert_array_equal(ours.contains_points(points), theirs.contains_points(points))


@pytest.mark.parametrize("name", ["box", "sphere", "torus", "shells"])
@pytest.mark.parametrize("multiple_hits", [True, False])
def test_answers_types_and_order_are_those_of_embree(engine, name, multiple_hits):
    mesh = meshes()[name]
    ours, theirs = RayMeshIntersector(mesh), engine(mesh)
    origins, directions = rays(mesh)
    # trimesh may lose a hit at an edge, or return one twice.
    count = np.bincount(theirs.intersects_id(origins, directions)[1], minlength=len(origins))
    clear = count == np.bincount(ours.intersects_id(origins, directions)[1], minlength=len(origins))
    assert clear.mean() > 0.99
    origins, directions = origins[clear], directions[clear]
    for method in ("intersects_id", "intersects_location"):
        found = getattr(ours, method)(origins, directions, multiple_hits)
        wanted = getattr(theirs, method)(origins, directions, multiple_hits)
        assert len(found) == len(wanted)
        # Retried rays come late in trimesh's order of hits; along each ray the order is the same.
        place, other = (np.argsort(hits[1], kind="stable") for hits in (found, wanted))
        for a, b in zip(found, wanted, strict=True):
            assert a.shape == b.shape
            np.testing.assert_allclose(a[place], b[other], atol=1e-6)
            if int(trimesh.__version__.split(".")[0]) >= 5:
                assert a.dtype == b.dtype
    for method in ("intersects_first", "intersects_any"):
        found, wanted = (getattr(i, method)(origins, directions) for i in (ours, theirs))
        assert found.dtype == wanted.dtype
        np.testing.assert_array_equal(found, wanted)


def test_first_hits_come_first_then_second_ones():
    mesh = meshes()["shells"]
    origins = np.array([[0, 0, 0.0], [5, 5, 5], [0.1, 0.2, 5], [0.1, 0.2, 1.2]])
    directions = np.array([[0.1, 0.2, 0.97], [0, 0, 1], [0, 0, -2], [0, 0, 0.5]])
    ray = RayMeshIntersector(mesh)
    index_tri, index_ray, locations = ray.intersects_id(origins, directions, return_locations=True)
    assert index_ray.tolist() == [0, 2, 3, 0, 2, 0, 2, 2, 2, 2]
    assert ray.intersects_id(origins, directions, max_hits=2)[1].tolist() == [0, 2, 3, 0, 2]
    for most in range(8):
        part = ray.intersects_id(origins, directions, max_hits=most, return_locations=True)
        kept = len(part[0])
        for a, b in zip(part, (index_tri, index_ray, locations), strict=True):
            np.testing.assert_array_equal(a, b[:kept])
    alone = ray.intersects_location(origins, directions, multiple_hits=False)
    np.testing.assert_array_equal(alone[0], locations[:3])
    assert alone[1].tolist() == [0, 2, 3]
    np.testing.assert_array_equal(ray.intersects_first(origins, directions)[[0, 2, 3]], alone[2])
    assert ray.intersects_first(origins, directions)[1] == -1
    assert ray.intersects_any(origins, directions).tolist() == [True, False, True, True]


def test_however_many_layers_there_are_all_are_hit():
    corners = np.tile([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], (70_000, 1))
    corners[:, 2] = -np.repeat(np.arange(70_000), 4)
    faces = np.tile([[0, 1, 2], [0, 2, 3]], (70_000, 1)) + 4 * np.repeat(np.arange(70_000), 2)[:, np.newaxis]
    sheets = trimesh.Trimesh(corners, faces, process=False)
    origins, directions = [[0.25, 0.5, 1], [0.75, 0.25, 0.5]], [[0, 0, -1], [0, 0, -1]]
    locations, index_ray, index_tri = RayMeshIntersector(sheets).intersects_location(origins, directions)
    np.testing.assert_array_equal(index_ray, np.tile([0, 1], 70_000))
    np.testing.assert_array_equal(locations[:, 2], -np.repeat(np.arange(70_000), 2))
    np.testing.assert_array_equal(index_tri[::2], 2 * np.arange(70_000) + 1)


@pytest.mark.parametrize("size", [1e-30, 1e-12, 1e-3, 1.0, 1e8, 1e30])
def test_a_ray_from_the_surface_meets_it_and_the_other_side(size):
    box = trimesh.creation.box().subdivide().subdivide()
    box.apply_scale(size)
    ray = RayMeshIntersector(box, scale_to_box=False)
    locations, index_ray, _ = ray.intersects_location([[0.0, 0, size / 2]], [[0.0, 0, -1]])
    assert index_ray.tolist() == [0, 0]
    np.testing.assert_array_equal(locations[:, 2], [size / 2, -size / 2])


def test_a_tiny_mesh_far_from_the_ray_is_hit_twice():
    box = trimesh.creation.box(extents=[2.0**-10] * 3)
    locations, _, _ = RayMeshIntersector(box).intersects_location([[2.0**-13, 0, 1e4]], [[0.0, 0, -1]])
    np.testing.assert_array_equal(locations, [(2.0**-13, 0, 2.0**-11), (2.0**-13, 0, -(2.0**-11))])


def test_in_map_coordinates_hits_are_the_same_ones():
    mesh = trimesh.creation.icosphere(subdivisions=4)
    # Numbers of 24 bits, so that translation rounds none.
    mesh.vertices = np.round(mesh.vertices * 2**16) / 2**16
    offset = np.array([448_000.0, 5_412_000.0, 512.0])
    moved = mesh.copy().apply_translation(offset)
    origins, directions = rays(mesh, 2000)
    origins = np.round(origins * 2**16) / 2**16
    found = RayMeshIntersector(mesh).intersects_location(origins, directions)
    there = RayMeshIntersector(moved).intersects_location(origins + offset, directions)
    np.testing.assert_array_equal(found[1], there[1])
    np.testing.assert_array_equal(found[2], there[2])
    # To the nearest float64s there.
    np.testing.assert_allclose(there[0] - offset, found[0], rtol=0, atol=4e-9)


def test_through_edges_and_vertices_a_surface_is_crossed_once():
    box = trimesh.creation.box()
    ends = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]) / 2.0
    ends = ends[np.any(ends != 0, axis=1)]
    ray = RayMeshIntersector(box)
    _, index_ray, _ = ray.intersects_location(np.zeros_like(ends), ends)
    assert index_ray.tolist() == list(range(len(ends)))
    _, index_ray, _ = ray.intersects_location(-3 * ends, ends)
    assert sorted(index_ray) == sorted([*range(len(ends)), *range(len(ends))])
    assert ray.intersects_any(-3 * ends, ends).all()
    assert (ray.intersects_first(-3 * ends, ends) >= 0).all()


def test_a_grid_of_rays_meets_top_and_bottom_wherever_it_goes():
    # Most go exactly through edges of faces.
    plate = trimesh.creation.box().subdivide().subdivide().subdivide()
    x, y = np.meshgrid(np.arange(-7, 8) / 16, np.arange(-7, 8) / 16)
    origins = np.column_stack((x.ravel(), y.ravel(), np.full(x.size, -100.0)))
    locations, index_ray, _ = RayMeshIntersector(plate).intersects_location(
        origins, np.tile([0.0, 0, 1], (x.size, 1))
    )
    np.testing.assert_array_equal(index_ray, np.tile(np.arange(x.size), 2))
    np.testing.assert_array_equal(locations[:, :2], np.tile(origins[:, :2], (2, 1)))
    np.testing.assert_array_equal(locations[:, 2], np.repeat([-0.5, 0.5], x.size))


def test_what_is_inside_a_cavity_is_outside():
    inner = trimesh.creation.box(extents=[0.5] * 3)
    inner.invert()
    hollow = trimesh.util.concatenate([trimesh.creation.box(extents=[2] * 3), inner])
    points = [[0, 0, 0], [0.2, -0.2, 0.1], [0.5, 0, 0], [0.9, 0.9, -0.9], [1.5, 0, 0], [np.nan, 0, 0]]
    for mesh in (hollow, hollow.copy().apply_translation((1e7, -1e7, 1e7))):
        at = points + mesh.bounds.mean(axis=0)
        inside = RayMeshIntersector(mesh).contains_points(at)
        assert inside.dtype == bool
        assert inside.tolist() == [False, False, True, True, False, False]


def test_answers_follow_the_mesh():
    mesh = trimesh.creation.box()
    ray = RayMeshIntersector(mesh)
    ask = ([[0.25, 0.125, 5]], [[0.0, 0, -1]])
    assert ray.intersects_location(*ask)[0][0].tolist() == [0.25, 0.125, 0.5]
    compiled = ray._scene
    mesh.visual.face_colors = [255, 0, 0, 255]
    assert ray.intersects_any(*ask).all()
    assert ray._scene is compiled
    mesh.apply_translation((0, 0, 2))
    assert ray.intersects_location(*ask)[0][0].tolist() == [0.25, 0.125, 2.5]
    mesh.vertices[:, 2] *= 2
    assert ray.intersects_location(*ask)[0][0].tolist() == [0.25, 0.125, 5.0]
    mesh.update_faces(mesh.face_normals[:, 2] < 0.5)
    assert ray.intersects_location(*ask)[0].tolist() == [[0.25, 0.125, 3.0]]
    assert len(ray.intersects_location(*ask, multiple_hits=False)[1]) == 1


@pytest.mark.parametrize(
    "again",
    [copy.copy, copy.deepcopy, lambda ray: pickle.loads(pickle.dumps(ray))],
    ids=["copy", "deepcopy", "pickle"],
)
def test_an_intersector_can_be_copied_and_pickled(again):
    ray = RayMeshIntersector(trimesh.creation.icosphere(), scale_to_box=False)
    origins, directions = rays(ray.mesh)
    wanted = ray.intersects_id(origins, directions, return_locations=True)
    other = again(ray)
    assert type(other) is RayMeshIntersector
    assert other._scale_to_box is False
    found = other.intersects_id(origins, directions, return_locations=True)
    for a, b in zip(found, wanted, strict=True):
        np.testing.assert_array_equal(a, b)
    assert repr(other) == "RayMeshIntersector(1280 faces)"


def test_no_rays_no_faces_and_rays_of_nothing():
    box = RayMeshIntersector(trimesh.creation.box())
    nothing = np.empty((0, 3))
    for none in (nothing, []):
        index_tri, index_ray, locations = box.intersects_id(none, none, return_locations=True)
        assert (index_tri.shape, index_ray.shape, locations.shape) == ((0,), (0,), (0, 3))
        assert box.intersects_first(none, none).shape == box.intersects_any(none, none).shape == (0,)
        assert box.contains_points(none).shape == (0,)
    empty = RayMeshIntersector(trimesh.Trimesh())
    rays = ([[0, 0, 5], [1, 2, 3]], [[0, 0, -1], [0, 1, 0]])
    assert empty.intersects_location(*rays)[0].shape == (0, 3)
    assert empty.intersects_first(*rays).tolist() == [-1, -1]
    assert not empty.contains_points(rays[0]).any()
    idle = [[0, 0, 0], [np.nan, 0, 1], [np.inf, 0, 0]]
    assert not box.intersects_any([[0, 0, 0]] * 3, idle).any()
    assert len(box.intersects_id([[0, 0, 0]] * 3, idle)[0]) == 0


@pytest.mark.parametrize(
    ("arguments", "error", "told"),
    [
        (([[0, 0, 0]], [[0, 0, 1]] * 2), ValueError, r"differ in shape: \(1, 3\) and \(2, 3\)"),
        (([0, 0, 0], [0, 0, 1]), ValueError, r"ray_origins must have shape \(n, 3\), got \(3,\)"),
        (([[0, 0, 0]], [[0, 1]]), ValueError, r"ray_directions must have shape \(n, 3\), got \(1, 2\)"),
        (([["a", "b", "c"]], [[0, 0, 1]]), TypeError, "ray_origins must be real numbers"),
        (([[0, 0, 0]], [[0, 0, 1j]]), TypeError, "ray_directions must be real numbers"),
    ],
)
def test_bad_rays_are_refused(arguments, error, told):
    ray = RayMeshIntersector(trimesh.creation.box())
    for method in ("intersects_id", "intersects_location", "intersects_first", "intersects_any"):
        with pytest.raises(error, match=told):
            getattr(ray, method)(*arguments)


def test_other_bad_input_is_refused():
    with pytest.raises(TypeError, match=r"geometry must be a trimesh\.Trimesh, got Mesh"):
        RayMeshIntersector(rw.Mesh([[0, 0, 0]], []))
    ray = RayMeshIntersector(trimesh.creation.box())
    with pytest.raises(ValueError, match=r"points must have shape \(n, 3\), got \(3,\)"):
        ray.contains_points([0, 0, 0])
    with pytest.raises(ValueError, match="max_hits must be at least 0, got -1"):
        ray.intersects_id([[0, 0, 0]], [[0, 0, 1]], max_hits=-1)
    with pytest.raises(TypeError, match="max_hits must be an integer"):
        ray.intersects_id([[0, 0, 0]], [[0, 0, 1]], max_hits=2.5)


def test_installed_every_mesh_has_these_rays():
    before = trimesh.creation.icosphere()
    theirs = before.ray
    engines = trimesh.ray.has_embree, trimesh.ray.ray_pyembree
    trimesh_ray.install()
    made = {
        "existing": before,
        "new": trimesh.creation.box(),
        "without embree": trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], use_embree=False),
        "copy": before.copy(include_cache=True),
        "deep copy": copy.deepcopy(before),
        "part": before.submesh([[0, 1, 2]], append=True),
        "primitive": trimesh.primitives.Sphere(),
        "joined": before + trimesh.creation.box(),
        "pickled": pickle.loads(pickle.dumps(before)),
    }
    for name, mesh in made.items():
        assert type(mesh.ray) is RayMeshIntersector, name
        assert mesh.ray.mesh is mesh, name
        assert mesh.ray is mesh.ray, name
    assert trimesh.ray.has_embree
    assert type(trimesh.ray.ray_pyembree.RayMeshIntersector(before)) is RayMeshIntersector
    trimesh_ray.uninstall()
    assert before.ray is theirs
    for name, mesh in made.items():
        assert type(mesh.ray).__module__.startswith("trimesh.ray."), name
        assert mesh.ray.mesh is mesh, name
    assert "ray" not in vars(trimesh.Trimesh)
    assert (trimesh.ray.has_embree, trimesh.ray.ray_pyembree) == engines


def test_installed_for_a_while():
    mesh = trimesh.creation.box()
    with trimesh_ray.install() as installation:
        assert repr(installation) == "Installation(in force)"
        with trimesh_ray.install():
            assert type(mesh.ray) is RayMeshIntersector
        assert type(mesh.ray) is RayMeshIntersector
    assert repr(installation) == "Installation(undone)"
    assert type(mesh.ray) is not RayMeshIntersector
    with pytest.raises(KeyError), trimesh_ray.install():
        raise KeyError
    assert type(mesh.ray) is not RayMeshIntersector
    trimesh_ray.install()
    trimesh_ray.install()
    trimesh_ray.uninstall()
    assert type(mesh.ray) is not RayMeshIntersector
    trimesh_ray.uninstall()


def test_what_is_assigned_while_installed_counts_afterwards():
    mesh, given = trimesh.creation.box(), trimesh.creation.box()
    given.ray = RayMeshIntersector(given, scale_to_box=False)
    own = given.ray
    with trimesh_ray.install():
        mesh.ray = slow = ray_triangle.RayMeshIntersector(mesh)
        assert type(mesh.ray) is RayMeshIntersector
        given.ray = RayMeshIntersector(given)
        assert type(given.ray) is RayMeshIntersector
        assert given.ray is not own
    assert mesh.ray is slow
    assert type(given.ray) is not RayMeshIntersector


def test_a_pickled_mesh_needs_no_raywright():
    with trimesh_ray.install():
        mesh = trimesh.creation.box()
        mesh.ray.intersects_any([[0, 0, 5]], [[0, 0, -1]])
        pickled = pickle.dumps(mesh)
        assert b"raywright." not in pickled
    assert not type(pickle.loads(pickled).ray).__module__.startswith("raywright")


def test_what_trimesh_does_with_rays_it_does_with_these():
    mesh = trimesh.creation.icosphere(subdivisions=3)
    rng = np.random.default_rng(0)
    points, faces = trimesh.sample.sample_surface(mesh, 100, seed=1)
    inside = rng.uniform(-1, 1, (1000, 3))

    def all_of_it():
        thickness = trimesh.proximity.thickness(mesh, points, normals=mesh.face_normals[faces], method="ray")
        reach = trimesh.proximity.longest_ray(mesh, points * 0.5, points)
        return mesh.contains(inside), thickness, reach, trimesh.proximity.signed_distance(mesh, inside)

    wanted = all_of_it()
    with trimesh_ray.install():
        found = all_of_it()
    np.testing.assert_array_equal(found[0], wanted[0])
    for a, b in zip(found[1:], wanted[1:], strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-5)


def test_where_there_is_no_embree_it_seems_that_there_is():
    code = """
import sys
sys.modules["embreex"] = sys.modules["pyembree"] = None
import trimesh
from raywright.compat import trimesh_ray
assert not trimesh.ray.has_embree
with trimesh_ray.install():
    assert trimesh.ray.has_embree
    mesh = trimesh.creation.box()
    print(type(mesh.ray).__module__, *mesh.ray.intersects_any([[0, 0, 5]], [[0, 0, -1]]))
assert not trimesh.ray.has_embree
print(type(mesh.ray).__module__, type(trimesh.creation.box().ray).__module__)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout.split() == [
        "raywright.compat.trimesh_ray.intersector",
        "True",
        "trimesh.ray.ray_triangle",
        "trimesh.ray.ray_triangle",
    ]


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_pyvista_traces_with_these_rays():
    pyvista = pytest.importorskip("pyvista")
    cube = pyvista.Cube().triangulate()
    ends = np.array([(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], float)
    with trimesh_ray.install():
        locations, index_ray, index_tri = cube.multi_ray_trace(-2 * ends, ends)
        first = cube.multi_ray_trace(-2 * ends, ends, first_point=True)
    assert index_ray.tolist() == [0, 1, 2, 3, 0, 1, 2, 3]
    np.testing.assert_array_equal(locations, np.vstack((-ends, ends)) / 2)
    np.testing.assert_array_equal(first[0], locations[:4])
    np.testing.assert_array_equal(first[2], index_tri[:4])
