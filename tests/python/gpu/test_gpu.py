"""Rays on a graphics processor, or on one in software: the CPU's answers, to the bit.

Where there is no driver for Vulkan, Metal or Direct3D 12, or wgpu is not installed, they are skipped.
"""

import os
import re
import subprocess
import sys

import numpy as np
import pytest

import raywright as rw

# The software renderer gets one thread per test process.
os.environ.setdefault("LP_NUM_THREADS", "1")
KNOT = rw.scenes.torus_knot(along=60, around=10)
MOST_ANY, MOST_CLOSEST = 0.005, 0.06


@pytest.fixture(scope="module")
def gpu():
    try:
        return rw.Gpu()
    except (ImportError, RuntimeError) as missing:
        pytest.skip(str(missing))


def same(hits, wanted):
    """Count rays whose hits are not the same to the bit."""
    differs = (
        (hits.t != wanted.t) | (hits.shape_id != wanted.shape_id) | (hits.primitive_id != wanted.primitive_id)
    )
    return np.count_nonzero(differs | (hits.uv != wanted.uv).any(axis=-1))


def agrees(scene, gpu, origins, directions, **ends):
    """Hold a scene's answers on a device against its own, and return what became of the rays."""
    wanted = scene.intersect(origins, directions, **ends)
    with scene.on_device(gpu) as there:
        hits = there.intersect(origins, directions, **ends)
        found = there.occluded(origins, directions, **ends)
        assert same(hits, wanted) == 0
        np.testing.assert_array_equal(found, wanted.hit)
        return there.stats, wanted


def random_rays(mesh, count, seed=0, spread=1.5):
    """Return rays from anywhere about a mesh to anywhere."""
    random = np.random.default_rng(seed)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    middle, size = (low.astype(float) + high) / 2, np.ptp(mesh.vertices, axis=0).max()
    origins = middle + spread * size * random.uniform(-1, 1, (count, 3))
    return origins, middle + 0.5 * size * random.uniform(-1, 1, (count, 3)) - origins


def aimed_rays(mesh, count, seed=0):
    """Return rays at corners, at points of edges, along axes, and within planes across one."""
    random = np.random.default_rng(seed)
    vertices = np.asarray(mesh.vertices, float)
    faces = mesh.faces[random.integers(0, len(mesh.faces), count)]
    a, b = vertices[faces[:, 0]], vertices[faces[:, 1]]
    share = random.choice([0.0, 0.5, 1.0], (count, 1))
    targets = a * (1 - share) + b * share
    size = np.ptp(vertices, axis=0).max()
    origins = targets + size * random.uniform(-2, 2, (count, 3))
    axis = np.eye(3)[random.integers(0, 3, count // 4)]
    origins[: count // 4] = targets[: count // 4] - 2 * size * axis
    origins[count // 4 : count // 2, 1] = targets[count // 4 : count // 2, 1]
    return origins, targets - origins


def slivers(count=200, aspect=1e6, seed=3):
    """Return long thin triangles, and rays at points within them and next to them."""
    random = np.random.default_rng(seed)
    a, long = random.uniform(-1, 1, (2, count, 3))
    wide = np.cross(long, random.normal(size=(count, 3)))
    wide *= np.linalg.norm(long, axis=1)[:, None] / np.linalg.norm(wide, axis=1)[:, None] / aspect
    corners = np.stack([a, a + long, a + long + wide], axis=1)
    mesh = rw.Mesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
    i = random.integers(0, count, 4000)
    weights = random.dirichlet([1, 1, 1], 4000)
    targets = np.einsum("ij,ijk->ik", weights, corners[i]) + wide[i] * random.normal(size=(4000, 1))
    origins = random.uniform(-3, 3, (4000, 3))
    return mesh, origins, targets - origins


def test_random_rays_and_how_many_are_left(gpu):
    scene = rw.Scene(KNOT)
    stats, wanted = agrees(scene, gpu, *random_rays(KNOT, 6000))
    assert 1000 < wanted.hit.sum() < 5000
    assert stats.closest == stats.any == 6000
    assert stats.closest_share <= MOST_CLOSEST
    assert stats.any_share <= MOST_ANY


def test_corners_and_edges(gpu):
    stats, wanted = agrees(rw.Scene(KNOT), gpu, *aimed_rays(KNOT, 4000))
    assert wanted.hit.mean() > 0.9
    # Only the CPU decides hits at corners.
    assert stats.closest_decided + stats.closest_walked > 1000


@pytest.mark.parametrize("aspect", [1e3, 1e6])
def test_slivers(gpu, aspect):
    mesh, *rays = slivers(aspect=aspect)
    _, wanted = agrees(rw.Scene(mesh, precision="double"), gpu, *rays)
    assert wanted.hit.sum() > 500


@pytest.mark.parametrize("size", [1e-30, 1e30])
def test_sizes(gpu, size):
    mesh = rw.Mesh(KNOT.vertices.astype(float) * size, KNOT.faces)
    stats, _ = agrees(rw.Scene(mesh, precision="double"), gpu, *random_rays(mesh, 2000))
    assert stats.any_share <= MOST_ANY


@pytest.mark.parametrize("shift", [1e7, (-3e6, 1e7, 1 / 3)])
def test_far_from_the_middle_of_the_world(gpu, shift):
    mesh = rw.Mesh(KNOT.vertices.astype(float) + np.asarray(shift), KNOT.faces)
    stats, _ = agrees(rw.Scene(mesh, precision="double"), gpu, *random_rays(mesh, 2000))
    assert stats.any_share <= MOST_ANY


@pytest.mark.parametrize("distance", [1e3, 1e6, 1e9])
def test_far_origins(gpu, distance):
    origins, directions = random_rays(KNOT, 2000)
    at = origins + directions
    origins = at + distance * (origins - at)
    stats, wanted = agrees(rw.Scene(KNOT), gpu, origins, at - origins)
    assert wanted.hit.sum() > 300
    if distance < 1e9:
        # They are moved towards the scene before rounding.
        assert stats.any_share <= MOST_ANY
        assert stats.closest_share <= MOST_CLOSEST


def test_ends_of_rays_count(gpu):
    scene = rw.Scene(KNOT)
    origins, directions = random_rays(KNOT, 3000)
    hits = scene.intersect(origins, directions)
    origins, directions, t = origins[hits.hit], directions[hits.hit], hits.t[hits.hit]
    before, behind = np.nextafter(t, 0), np.nextafter(t, np.inf)
    for ends in ({"t_max": t}, {"t_max": before}, {"t_min": t}, {"t_min": behind}):
        _, wanted = agrees(scene, gpu, origins, directions, **ends)
        assert wanted.hit.any() == (ends.get("t_max") is not before)
    agrees(scene, gpu, origins, directions, t_min=-np.inf, t_max=0.5 * t)
    agrees(scene, gpu, origins, directions, t_min=2.0, t_max=1.0)


def test_rays_that_leave_a_surface_leave_it_behind(gpu):
    scene = rw.Scene(KNOT)
    hits = scene.intersect(*random_rays(KNOT, 3000))
    hits = hits[hits.hit]
    random = np.random.default_rng(9)
    ways = random.normal(size=(len(hits), 3))
    stats, _ = agrees(scene, gpu, hits.position, ways, t_min=1e-3)
    assert stats.any_share <= MOST_ANY
    assert stats.closest_share <= MOST_CLOSEST
    # Without one, only the CPU can decide that a leaving ray misses its own face, and it tests just that
    # face.
    stats, _ = agrees(scene, gpu, *hits.spawn_rays(ways))
    assert stats.any_decided > 0.2 * stats.any
    assert stats.any_walked <= MOST_ANY * stats.any


def test_rays_that_hit_nothing_slow_nothing_down(gpu):
    bad = np.array([[np.nan, 0, 0], [np.inf, 0, 0], [0, 0, 5], [0, 0, 5]])
    ways = np.array([[1.0, 0, 0], [1, 0, 0], [0, 0, 0], [0, 0, -1e-310]])
    stats, wanted = agrees(rw.Scene(KNOT), gpu, bad, ways)
    assert not wanted.hit.any()
    assert stats.closest_walked == 0
    # So short that t may overflow a float64.
    origins, directions = random_rays(KNOT, 200)
    agrees(rw.Scene(KNOT), gpu, origins, directions * 1e-300)
    agrees(rw.Scene(KNOT), gpu, origins, directions * 1e-307)
    agrees(rw.Scene(KNOT), gpu, origins, directions * 1e300)


def test_shapes_and_copies_are_candidates_by_their_boxes(gpu):
    moves = np.tile(np.eye(4), (6, 1, 1))
    moves[:, 0, 3] = np.arange(6) - 2.5
    shapes = [
        rw.Sphere((0, 2, 0), 0.7),
        KNOT,
        rw.Instance([KNOT, rw.Sphere((0, 0, 1), 0.3)], moves),
        rw.Torus(major_radius=2, minor_radius=0.2),
    ]
    scene = rw.Scene(shapes)
    origins, directions = random_rays(KNOT, 3000)
    wanted = scene.intersect(origins, directions)
    with scene.on_device(gpu) as there:
        hits = there.intersect(origins, directions)
        assert hits == wanted
        np.testing.assert_array_equal(hits.instance_id, wanted.instance_id)
        np.testing.assert_array_equal(hits.position, wanted.position)
        np.testing.assert_array_equal(there.occluded(origins, directions), wanted.hit)
    with_plane = rw.Scene([*shapes, rw.Plane((0, 0, -1), (0, 0, 1))])
    stats, wanted = agrees(with_plane, gpu, origins[:500], directions[:500])
    assert (wanted.shape_id == 4).any()
    # Every ray may hit it.
    assert stats.closest_share == 1
    assert stats.any_share <= 1


def test_coincident_faces_go_to_the_first(gpu):
    many = rw.Mesh(KNOT.vertices, np.tile(KNOT.faces, (3, 1)))
    agrees(rw.Scene(many), gpu, *random_rays(KNOT, 500))
    # More than four equal triangles are too many candidates.
    one = rw.Mesh([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)], np.tile([(0, 1, 2)], (9, 1)))
    stats, wanted = agrees(rw.Scene(one), gpu, [[0.2, 0.2, 1.0]], [[0.0, 0, -1]])
    assert wanted.primitive_id.tolist() == [0]
    assert (stats.closest_walked, stats.closest_decided) == (1, 0)


def test_nothing_and_one_of_everything(gpu):
    _, wanted = agrees(rw.Scene([]), gpu, [[0.0, 0, 0]], [[0.0, 0, 1]])
    assert not wanted.hit.any()
    triangle = rw.Scene(rw.Mesh([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
    for way in ([0.1, 0.1, -1], [0.0, 0.0, -1], [0.5, 0.5, -1]):
        agrees(triangle, gpu, [[0.0, 0, 1]], [way])
    with triangle.on_device(gpu) as there:
        assert there.intersect(np.zeros((0, 3)), np.zeros((0, 3))).shape == (0,)
        assert there.intersect([0.1, 0.1, 1], [0, 0, -1]).shape == ()
        assert there.intersect([0.1, 0.1, 1], np.full((2, 3, 3), [0, 0, -1])).hit.all()


def test_images_keep_their_shape(gpu):
    scene, camera = rw.Scene(KNOT), rw.Camera((0, 0, 6), (0, 0, 0), width=50, height=40)
    wanted = scene.intersect(*camera.rays())
    with scene.on_device(gpu) as there:
        hits = there.intersect(*camera.rays())
    assert hits == wanted
    assert hits.shape == (40, 50)
    np.testing.assert_array_equal(hits.normal, wanted.normal)


def test_scenes_larger_than_a_binding_are_split(gpu, monkeypatch):
    scene, rays = rw.Scene(KNOT), random_rays(KNOT, 500)
    most, gpu._most = gpu._most, 1 << 15
    try:
        with scene.on_device(gpu) as there:
            assert there.bytes > 2 * gpu._most
            assert there.intersect(*rays) == scene.intersect(*rays)
            np.testing.assert_array_equal(there.occluded(*rays), scene.occluded(*rays))
        # Some devices have a million bindings.
        monkeypatch.setitem(gpu._device.limits, "max-storage-buffers-per-shader-stage", 8)
        gpu._most = 256
        with pytest.raises(MemoryError, match="bindings, and the device has 8"):
            scene.on_device(gpu)
    finally:
        gpu._most = most


def test_a_device_that_is_lost_is_told_of_and_nothing_else_is(gpu, monkeypatch):
    scene, rays = rw.Scene(KNOT), random_rays(KNOT, 1000)
    wanted = scene.intersect(*rays)
    with scene.on_device(gpu) as there:
        monkeypatch.setattr(type(there._kernels), "chunk", 300)
        read, calls = there._kernels.read, []

        def fails(work):
            calls.append(work)
            if len(calls) == 2:
                raise RuntimeError("Parent device is lost")
            return read(work)

        monkeypatch.setattr(there._kernels, "read", fails)
        with pytest.warns(RuntimeWarning, match="was lost, and the CPU takes over: Parent device"):
            assert there.intersect(*rays) == wanted
        assert there.stats.closest_walked >= 700
        # Once.
        assert there.intersect(*rays) == wanted
        np.testing.assert_array_equal(there.occluded(*rays), wanted.hit)
        assert len(calls) == 2


def test_bounds_matter(gpu):
    """With bounds of a 256th, wrong answers are found: were they for nothing, this would not see it."""
    mesh, *sliver_rays = slivers()
    cases = [(rw.Scene(KNOT), aimed_rays(KNOT, 4000)), (rw.Scene(mesh, precision="double"), sliver_rays)]
    gpu._bounds = 1 / 256
    try:
        wrong = 0
        for scene, rays in cases:
            wanted = scene.intersect(*rays)
            with scene.on_device(gpu) as there:
                wrong += same(there.intersect(*rays), wanted)
                wrong += np.count_nonzero(there.occluded(*rays) != wanted.hit)
    finally:
        gpu._bounds = 1.0
    assert wrong > 10


def test_it_ends_with_its_block(gpu):
    with rw.Scene(KNOT).on_device(gpu) as there:
        assert re.fullmatch(r"GpuScene\(\d+ primitives on '.*'\)", repr(there))
    with pytest.raises(RuntimeError, match="its with block has ended"):
        there.intersect([0, 0, 5], [0, 0, -1])
    assert repr(gpu) == f"Gpu({gpu.name!r}, {gpu.backend})"


def test_what_is_no_device_is_refused(gpu):
    with pytest.raises(TypeError, match="device must be a Gpu, got 3"):
        rw.Scene([]).on_device(3)
    with pytest.raises(TypeError, match="device must be a Gpu, got <class"):
        rw.Scene([]).on_device(rw.Gpu)
    with pytest.raises(TypeError, match="scene must be a Scene, got int"):
        gpu.upload(3)
    with pytest.raises(ValueError, match="adapter is 'no such thing', expected part of one of"):
        rw.Gpu("no such thing")
    with pytest.raises(TypeError, match=r"adapter must be a name or a wgpu\.GPUAdapter, got int"):
        rw.Gpu(3)
    assert rw.Gpu(gpu.name[:6].upper()).name == gpu.name


def test_arithmetic_that_breaks_the_promises_is_found():
    from raywright.gpu.arithmetic import pairs, trouble

    given = pairs()
    x, y = given.T.astype(np.float32)
    cross, dot = x - y * y, x * y + y * x + x
    order = (x < y) + 2.0 * (x > y)
    right = [
        x + y,
        x - y,
        x * y,
        x / y,
        y,
        np.minimum(x, y),
        np.maximum(x, y),
        np.abs(x),
        cross,
        dot,
        order,
        x,
    ]
    right = np.stack(right, axis=1).astype(np.float32)
    assert trouble(given, right) is None
    # Subnormal results may be 0.
    flushed = np.where(np.abs(right) < 2.0**-126, 0, right).astype(np.float32)
    assert trouble(given, flushed) is None
    for column, off in [(0, 2), (1, 2), (2, 2), (3, 4), (7, 1), (8, 64), (9, 64), (10, 1), (11, 1)]:
        wrong = right.copy()
        row = np.argmax((np.abs(wrong[:, column]) > 1e-20) & (np.abs(wrong[:, column]) < 1e20))
        wrong[row, column] *= np.float32(1 + off * 2.0**-23)
        assert trouble(given, wrong) is not None, column
    wrong = right.copy()
    wrong[5, 3] = np.nan
    assert "a quotient of" in trouble(given, wrong)


def test_without_a_driver_one_line_says_what_is_missing():
    pytest.importorskip("wgpu")
    code = "import raywright as rw\ntry: rw.Gpu()\nexcept RuntimeError as e: print(e)"
    # No Vulkan driver: wgpu offers OpenGL, if anything.
    env = {**os.environ, "VK_DRIVER_FILES": "/nowhere.json", "VK_ICD_FILENAMES": "/nowhere.json"}
    if sys.platform != "linux":
        pytest.skip("Metal and Direct3D are part of the system")
    told = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, check=True)
    assert told.stdout.startswith("no Vulkan, Metal or D3D12 driver was found: install")
    assert told.stdout.count("\n") == 1


def test_without_wgpu_one_line_says_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "wgpu", None)
    with pytest.raises(ImportError, match=r"pip install 'raywright\[gpu\]'"):
        rw.Gpu()


SHAPES = {
    "knot": lambda: [rw.scenes.torus_knot(along=1000, around=30)],
    "teapot in a stadium": lambda: rw.scenes.teapot_in_stadium(),
    "terrain": lambda: rw.scenes.terrain(side=80, blades=10_000),
    "soup": lambda: rw.scenes.soup(20_000),
    "room": lambda: rw.scenes.room(30_000),
    "diagonal_wall": lambda: rw.scenes.diagonal_wall(),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SHAPES)
def test_two_hundred_thousand_rays(gpu, name):
    scene = rw.Scene(SHAPES[name]())
    corners = [shape.vertices[shape.faces].reshape(-1, 3) for shape in scene.shapes]
    mesh = rw.Mesh(np.concatenate(corners), np.arange(sum(map(len, corners))).reshape(-1, 3))
    stats, _ = agrees(scene, gpu, *random_rays(mesh, 100_000, spread=0.75))
    assert stats.closest_share <= MOST_CLOSEST
    assert stats.any_share <= MOST_ANY
    agrees(scene, gpu, *aimed_rays(mesh, 50_000))
    hits = scene.intersect(*random_rays(mesh, 100_000, seed=1, spread=0.75))
    hits = hits[hits.hit][:50_000]
    agrees(scene, gpu, *hits.spawn_rays(np.random.default_rng(2).normal(size=(len(hits), 3))))
