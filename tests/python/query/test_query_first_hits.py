"""What is rasterized is what rays hit, to the last bit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import raywright as rw
from raywright import _core


def agree(scene, camera, offsets=(0.5, 0.5)):
    """Check that both agree; return the hits, and which part of the picture the tree was asked for."""
    wanted = scene.intersect(*camera.rays(offsets))
    for threads in (1, 3):
        found = scene.first_hits(camera, offsets, threads=threads)
        assert found.shape == (camera.height, camera.width)
        for name in ("t", "uv"):
            assert np.array_equal(getattr(found, name).view(np.int64), getattr(wanted, name).view(np.int64))
        assert found == wanted
    asked = _core.first_hits(scene._compiled(), camera, np.array((0.5, 0.5)), None)[4]
    return found, asked / (camera.width * camera.height)


def soup(rng, count, size, dtype=np.float32):
    corners = rng.uniform(-1, 1, (count, 1, 3)) + rng.normal(size=(count, 3, 3)) * size
    return rw.Mesh(corners.reshape(-1, 3).astype(dtype), np.arange(3 * count).reshape(-1, 3))


@pytest.mark.parametrize(("count", "size"), [(1, 1), (20, 0.5), (200, 0.2), (3000, 0.03), (40000, 0.01)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_soups_from_outside_and_from_within(count, size, dtype):
    rng = np.random.default_rng(count)
    scene = rw.Scene(soup(rng, count, size, dtype))
    for position, fov in [((0, 0, 4), 40), ((0.1, 0.2, 0.1), 100), ((0.3, 0, 9), 3), ((0, 0.1, 0.5), 170)]:
        camera = rw.Camera(position, (0.05, 0, 0), fov=fov, width=75, height=50)
        hits, _ = agree(scene, camera)
        agree(scene, camera, rng.uniform(-1, 2, (50, 75, 2)))
        assert count < 200 or hits.hit.any()


def test_few_faces_are_rasterized_and_many_are_left_to_the_tree(box):
    camera = rw.Camera((1.5, 1.2, 4), (0.5, 0.5, 0.5), width=200, height=150)
    assert agree(rw.Scene(box), camera)[1] == 0
    assert agree(rw.Scene(soup(np.random.default_rng(0), 20000, 0.3)), camera)[1] > 0.5


def test_a_picture_may_be_of_both():
    rng = np.random.default_rng(7)
    crowd, wall = soup(rng, 5000, 0.3), soup(rng, 40, 0.4)
    shapes = [rw.Mesh(np.asarray(crowd.vertices) * 0.2, crowd.faces), wall]
    camera = rw.Camera((0, 0, 4), (0, 0, 0), width=200, height=150)
    assert 0.02 < agree(rw.Scene(shapes), camera)[1] < 0.6


def test_scenes_of_the_library():
    for shapes in ([rw.scenes.torus_knot()], rw.scenes.city(), rw.scenes.terrain()):
        scene = rw.Scene(shapes)
        bounds = scene._compiled().bounds
        center, size = bounds.mean(axis=0), np.ptp(bounds, axis=0).max()
        for shift in [(0.7, 0.4, 1.0), (0.0, 0.001, 0.01), (-30, 10, 5)]:
            camera = rw.Camera(center + size * np.array(shift), center, width=192, height=128)
            agree(scene, camera)


def test_shared_edges_are_seen_by_the_lowest_face_as_rays_see_them():
    # Pixel centers on edges and corners: a camera straight above a grid of squares of one pixel each.
    n = 16
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    quads = np.concatenate([np.stack([a, a + n + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + 1], 1)])
    mesh = rw.Mesh(np.concatenate([vertices, vertices]), np.concatenate([quads, quads + len(vertices)]))
    camera = rw.Camera((8, 8, 8), (8, 8, 0), fov=90, width=16, height=16)
    for offsets in [(0, 0), (0.5, 0.5), (0, 0.5), (0.25, 0.25), (1, 1)]:
        hits, _ = agree(rw.Scene(mesh), camera, offsets)
        assert hits.hit[1:-1, 1:-1].all()
        assert hits.primitive_id.max() < len(quads)


def test_hostile_triangles():
    rng = np.random.default_rng(5)
    eye = np.array((0.0, 0.0, 2.0))
    triangles = [
        # Behind, through the plane of the camera, with a corner in it, on it, and in the camera itself.
        [(0, 0, 3), (1, 0, 3), (0, 1, 4)],
        [(-1, -0.5, 1), (1, -0.5, 1), (0, -0.5, 5)],
        [(-2, -0.7, 0), (1, -0.7, 2), (2, -0.7, 0)],
        [(-1, -1, 2), (1, -1, 2), (0, 1, 2)],
        [tuple(eye), (1, 0.3, 0), (1, 0.6, 0)],
        # Degenerate, edge-on, of no finite size, huge, tiny, and large next to its distance.
        [(0, 0, 0), (0, 0, 0), (0, 0, 0)],
        [(0, 0, 0), (0.5, 0.5, 0), (1, 1, 0)],
        [(0, 0, 0), (0, 1, 0), (0, 0, 1)],
        [(np.nan, 0, 0), (1, 0, 0), (0, 1, 0)],
        [(np.inf, 0, 0), (1, 0, 0), (0, 1, 0)],
        [(-1e30, -1e30, -1), (1e30, -1e30, -1), (0, 1e30, -1)],
        [(1e-30, 0, 0), (0, 1e-30, 0), (0, 0, 1e-30)],
        [(-1e3, -0.9, -1e3), (1e3, -0.9, -1e3), (0, -0.9, 1e3)],
    ]
    corners = np.array(triangles, float)
    for chosen in [slice(None), *(slice(i, i + 1) for i in range(len(corners)))]:
        part = corners[chosen]
        faces = np.arange(3 * len(part)).reshape(-1, 3)
        finite = np.isfinite(part).all()
        mesh = rw.Mesh(part.reshape(-1, 3), faces)
        scene = rw.Scene(mesh)
        camera = rw.Camera(eye, (0, 0, 0), fov=100, width=40, height=33)
        if finite:
            agree(scene, camera)
            agree(scene, camera, rng.uniform(0, 1, (33, 40, 2)))
        else:
            with pytest.warns(RuntimeWarning, match="NaN"):
                agree(scene, camera)


def test_no_scene_and_no_number():
    camera = rw.Camera((0, 0, 1), (0, 0, 0), width=20, height=17)
    assert not agree(rw.Scene([]), camera)[0].hit.any()
    offsets = np.full((17, 20, 2), 0.5)
    offsets[3, 4], offsets[5, 6], offsets[7, 8], offsets[9, 10] = np.nan, np.inf, 1e300, -1e6
    one = rw.Mesh([(-3, -3, 0), (3, -3, 0), (0, 3, 0)], [(0, 1, 2)])
    hits, _ = agree(rw.Scene(one), camera, offsets)
    assert hits.hit[10, 10]
    assert not hits.hit[3, 4]


@settings(max_examples=150, deadline=None)
@given(
    st.integers(0, 2**32),
    st.sampled_from([1e-6, 1.0, 1e6]),
    st.sampled_from([0.0, 1.0, 1e5]),
    st.sampled_from([0.01, 1, 40, 120, 179.9]),
)
def test_cameras_anywhere_and_scenes_of_any_size(seed, size, far, fov):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 60))
    corners = (rng.uniform(-1, 1, (count, 1, 3)) + rng.normal(size=(count, 3, 3)) * 0.3) * size + far * size
    mesh = rw.Mesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
    position = rng.uniform(-1, 1, 3) * size * rng.choice([0.2, 2, 50]) + far * size
    target = corners[0].mean(axis=0)
    camera = rw.Camera(position, target, up=rng.normal(size=3), fov=fov, width=33, height=18)
    agree(rw.Scene(mesh), camera)


def test_curved_shapes_are_asked_of_the_accelerator(box):
    scene = rw.Scene([box, rw.Sphere((2, 0.5, 0.5), 0.7)])
    camera = rw.Camera((1, 0.5, 5), (1, 0.5, 0.5), width=40, height=30)
    found = scene.first_hits(camera)
    assert found == scene.intersect(*camera.rays())
    assert np.isfinite(found.normal[found.hit]).all()
    assert (found.shape_id == 1).any()


def test_what_is_no_camera_is_refused(scene, camera):
    with pytest.raises(TypeError, match="camera must be a Camera"):
        scene.first_hits("camera")
    with pytest.raises(ValueError, match="offsets must have shape"):
        scene.first_hits(camera, np.zeros((2, 2)))
    with pytest.raises(ValueError, match="threads must be at least 1"):
        scene.first_hits(camera, threads=0)


def test_the_report_tells_both_and_finds_no_difference(scene, camera):
    table = rw.report.first_hits(scene, camera, repeats=1)
    assert table.column("way") == ("rays at hand", "rays made", "rasterized")
    assert table.column("wrong") == (0, 0, 0)
    assert table.column("by_tree")[:2] == (1.0, 1.0)
    assert all(ms > 0 for ms in table.column("ms"))
    with pytest.raises(TypeError, match="scene must be a Scene"):
        rw.report.first_hits(camera, camera)
    with pytest.raises(ValueError, match="only meshes"):
        rw.report.first_hits(rw.Scene(rw.Sphere((0, 0, 0), 1)), camera)
