"""What `precision="auto"` keeps: all digits, as float32 where that has all of them."""

import pickle
import warnings

import numpy as np
import pytest
import trimesh

import raywright as rw

# Meters east and north of UTM's zone 32, and above the sea.
PLACE = np.array([465_000.3, 5_249_000.2, 440.6])
STEP = 2.0**-22  # half of what float32 counts in between 4 and 8


def there(x, y, z):
    return PLACE + np.array([x, y, z])


def cuboid(at=PLACE, size=(6.0, 4.0, 2.0), **look):
    box = trimesh.creation.box(size)
    return rw.Mesh(box.vertices + at, box.faces, **look)


def row(scene):
    return next(row for row in scene.plan().rows if row.what == "float64 vertices")


def bumpy(at=(0.0, 0.0, 0.0), count=41):
    """A terrain whose coordinates are eighths of a meter, so that moving it far by eighths rounds nothing."""
    x, y = 0.375 * np.stack(np.meshgrid(np.arange(count), np.arange(count)))
    heights = np.round(6 * np.sin(2.4 * x + 0.8 * y) * np.cos(1.9 * y)) / 8
    corner = np.arange(count * count).reshape(count, count)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]
    faces = np.concatenate([np.stack(f, axis=-1).reshape(-1, 3) for f in ((a, b, c), (a, c, d))])
    return rw.Mesh(np.stack([x, y, heights], axis=-1).reshape(-1, 3) + np.asarray(at), faces)


def sky_view(scene, at):
    """The share of the sky that places of the terrain see, by rays as a diffuse surface sends them."""
    rng = np.random.default_rng(7)
    places = np.concatenate([rng.uniform(4, 11, (400, 2)), np.full((400, 1), 50.0)], axis=1)
    ground = scene.intersect(places + at, (0, 0, -1))
    assert ground.hit.all()
    radius, angle = np.sqrt(rng.random((64, 400))), rng.uniform(0, 2 * np.pi, (64, 400))
    up = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1 - radius**2)], axis=-1)
    return ground.primitive_id, ~scene.occluded(*ground.spawn_rays(up))


def test_a_block_at_map_coordinates_is_as_thick_as_it_is():
    scene = rw.Scene(cuboid())
    off = np.array([0.1, 0.2, 0.3])
    for axis, size in enumerate((6.0, 4.0, 2.0)):
        way = np.eye(3)[axis]
        found = scene.intersect_all(PLACE + off - (off[axis] + 10) * way, way)
        assert np.abs(np.diff(found.t) - size).max() < 1e-9
        assert np.abs(found.t[0] - (10 - size / 2)) < 1e-9
    half = np.array([3.0, 2.0, 1.0])
    inside = np.random.default_rng(1).uniform(-1, 1, (2000, 3)) * half * (1 - 1e-6)
    assert scene.contains(PLACE + inside).all()
    outside = inside / np.abs(inside / half).max(axis=1, keepdims=True) * (1 + 1e-6)
    assert not scene.contains(PLACE + outside).any()
    nearest = scene.closest_point(there(0, 0, 3.5))
    assert abs(nearest.distance - 2.5) < 1e-9
    depth = (half - np.abs(inside)).min(axis=1)
    assert np.allclose(scene.signed_distance(PLACE + inside), -depth, rtol=0, atol=2e-9)


def test_what_cameras_and_cones_ask_at_map_coordinates_is_exact_too():
    scene, home = rw.Scene(cuboid()), rw.Scene(cuboid(at=(0, 0, 0)))
    eye = np.array([9.0, 7.0, 5.0])
    camera, before = (
        rw.Camera(at + eye, at, up=(0, 0, 1), width=32, height=24) for at in (PLACE, np.zeros(3))
    )
    hits = scene.first_hits(camera)
    assert hits == scene.intersect(*camera.rays())
    assert scene.pick(camera, 16, 12) == scene.intersect(*(part[12, 16] for part in camera.rays()))
    same = home.first_hits(before)
    assert same.hit.sum() > 100
    assert np.array_equal(hits.primitive_id, same.primitive_id)
    assert np.allclose(hits.t[hits.hit], same.t[same.hit], rtol=0, atol=1e-8)
    found, wanted = (s.faces_in_cone(at + eye, -eye, 5.0) for s, at in ((scene, PLACE), (home, np.zeros(3))))
    assert np.array_equal(found.primitive_id, wanted.primitive_id)
    assert np.allclose(found.distance, wanted.distance, rtol=0, atol=1e-8)


def test_a_terrain_at_map_coordinates_sees_as_much_of_the_sky_as_at_the_origin():
    faces, home = sky_view(rw.Scene(bumpy()), np.zeros(3))
    assert 0.7 < home.mean() < 0.78
    place = np.round(8 * PLACE) / 8
    same, seen = sky_view(rw.Scene(bumpy(place)), place)
    assert np.array_equal(same, faces)
    # Ray origins differ by 1e-7, so some of the 25,600 may graze.
    assert (seen != home).mean() < 1e-3
    with pytest.warns(RuntimeWarning, match="moves vertices"):
        rounded = sky_view(rw.Scene(bumpy(place), precision="single"), place)[1]
    assert (rounded != home).mean() > 0.05


@pytest.mark.parametrize("off", [0.0, 5e-324, 1e-17, 1e-9])
def test_digits_are_kept_unless_there_are_none_beyond_float32(off):
    mesh = rw.Mesh([(0, 0, 0), (1, off, 0), (0, 1, 0)], [(0, 1, 2)])
    # Not even in a mesh so large that the offset is negligible.
    for other in ([], [rw.Mesh(np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)]) * 2.0**100, [(0, 1, 2)])]):
        scene = rw.Scene([mesh, *other])
        precision = "double" if off else "single"
        assert scene.accelerator_info.precision == precision
        assert precision in scene.accelerator_info.kind
        assert row(scene).needed == bool(off)
        assert scene.precision == "auto"
    assert rw.Scene(mesh).bounds is not None
    assert rw.Scene(mesh).closest_point((1.0, off, 0.0)).position[1] == off


def test_the_figure_is_that_of_the_vertex_that_moves_most():
    far = 4 + STEP
    scene = rw.Scene(rw.Mesh([(far, 0, 0), (far - STEP / 1e-7, 0, 0), (3, 1, 0)], [(0, 1, 2)]))
    assert "2.4e-7, 1.0e-7 of its mesh's extent" in row(scene).meaning
    assert scene.bounds[1, 0] == far


def test_a_wall_is_where_it_is_and_a_film_as_thick():
    wall = rw.Mesh([(0, 0, 0.8), (1, 0, 0.8), (0, 1, 0.8)], [(0, 1, 2)])
    assert rw.Scene(wall).intersect((0.2, 0.2, 0), (0, 0, 1)).t == 0.8
    square = np.array([(0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0.0)])
    film = [rw.Mesh(square + np.array((0, 0, z)), [(0, 1, 2), (0, 2, 3)]) for z in (3.3, 3.3 + 1e-6)]
    found = rw.Scene(film).intersect_all((3.7, 4.1, 0), (0, 0, 1))
    assert np.diff(found.t) == pytest.approx(1e-6, rel=1e-9)
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.7)
    seen = rw.Scene(ball).intersect(np.zeros(3), ball.vertices)
    assert np.abs(seen.t - 1).max() < 4e-16


def test_rays_that_start_next_to_a_face_start_on_their_side_of_it():
    rng = np.random.default_rng(11)
    block = trimesh.creation.box((0.7, 1.1, 1.3))
    block.apply_translation((0.1, 0.2, 0.3))
    scene = rw.Scene(rw.Mesh(block.vertices, block.faces))
    low, high = block.vertices.min(axis=0), block.vertices.max(axis=0)
    points = low + (high - low) * rng.uniform(0.05, 0.95, (4000, 3))
    axis, up = rng.integers(3, size=4000), rng.integers(2, size=4000).astype(bool)
    face = np.where(up, high[axis], low[axis])
    off = 10.0 ** rng.uniform(-15, 0, 4000) * rng.choice([-1, 1], 4000)
    points[np.arange(4000), axis] = face + off
    outward = np.zeros((4000, 3))
    outward[np.arange(4000), axis] = np.where(up, 1.0, -1.0)
    moved = points[np.arange(4000), axis]
    is_inside = (moved > low[axis]) & (moved < high[axis])
    is_off = (moved != low[axis]) & (moved != high[axis])
    assert is_off.sum() > 3500
    assert np.array_equal(scene.contains(points)[is_off], is_inside[is_off])
    # Outwards from inside, the face is hit once; from beyond the other face, that one as well.
    count = scene.count_hits(points, outward)[is_off]
    assert np.array_equal(count % 2 == 1, is_inside[is_off])


@pytest.mark.parametrize(
    "vertices",
    [
        cuboid().vertices.astype(np.float32),
        cuboid().vertices.astype(np.float32).astype(np.float64),
        np.float32(1e30) * cuboid(at=(0, 0, 0)).vertices.astype(np.float32),
        np.float32(1e-30) * cuboid(at=(0, 0, 0)).vertices.astype(np.float32),
    ],
)
def test_what_is_float32_stays_so_wherever_it_is(vertices):
    scene = rw.Scene(rw.Mesh(vertices, cuboid().faces))
    assert scene.accelerator_info.precision == "single"
    assert row(scene).meaning == "kept as float32, which has all of their digits"
    single = rw.Scene(scene.shapes, precision="single")
    assert scene.bytes == single.bytes
    assert single.bytes < rw.Scene(cuboid()).bytes


def test_meshes_of_float32_numbers_stay_single():
    for mesh in (bumpy(), trimesh.creation.box(), cuboid(at=(0.5, 0.25, -7.0))):
        scene, single = rw.Scene(mesh), rw.Scene(mesh, precision="single")
        assert scene.accelerator_info.precision == "single"
        assert scene.bytes == single.bytes
        rays = np.random.default_rng(2).normal(size=(2, 500, 3))
        assert scene.intersect(*rays) == single.intersect(*rays)


def test_what_no_face_uses_does_not_count():
    block = cuboid()
    for stray in ((0.0, 0.0, 0.0), (1e30, 0.0, 0.0), (np.nan, 0.0, 0.0)):
        scene = rw.Scene(rw.Mesh(np.concatenate([block.vertices, [stray]]), block.faces))
        assert scene.accelerator_info.precision == "double"
        assert row(scene) == row(rw.Scene(block))
    at_home = cuboid(at=0.0)
    stray = rw.Mesh(np.concatenate([at_home.vertices, [PLACE + 0.1]]), at_home.faces)
    assert rw.Scene(stray).accelerator_info.precision == "single"


@pytest.mark.parametrize("scale", [1e-60, 1e-42, 1e39, 1e200])
def test_what_float32_has_no_numbers_for_is_kept(scale):
    block = cuboid(at=0.0)
    scene = rw.Scene(rw.Mesh(block.vertices * scale, block.faces))
    assert scene.accelerator_info.precision == "double"
    assert np.allclose(scene.intersect((0, 0, 5 * scale), (0, 0, -scale)).t, 4, rtol=1e-15, atol=0)


def test_one_mesh_that_loses_keeps_the_digits_of_all():
    # Both have the corners of the seam: rounded for both or for none.
    x, y = np.meshgrid((-1e6, 1e6 / 3, 1e6 / 3 + 7), (0.0, 0.1), indexing="ij")
    near, mid, far = np.stack([x, y, np.full_like(x, 0.1)], axis=-1)
    faces = [(0, 2, 3), (0, 3, 1)]
    large, small = rw.Mesh([*near, *mid], faces), rw.Mesh([*mid, *far], faces)
    scene = rw.Scene([large, small])
    assert scene.accelerator_info.precision == "double"
    plain = rw.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    assert rw.Scene(plain).accelerator_info.precision == "single"
    assert rw.Scene([plain, small]).accelerator_info.precision == "double"
    aims = mid[0] + np.linspace(0, 1, 1001)[:, None] * (mid[1] - mid[0])
    origins = np.array([1e6 / 3, 0.05, 9.1])
    assert scene.occluded(origins, aims - origins).all()
    for meshes in ([large, small], [small, large]):
        assert rw.Scene(meshes).bounds[0, 1] == rw.Scene(meshes, precision="double").bounds[0, 1]
        kept = rw.Scene(meshes).intersect((0.0, 0.05, 5.0), (0, 0, -1))
        assert kept == rw.Scene(meshes, precision="double").intersect((0.0, 0.05, 5.0), (0, 0, -1))
        assert kept.position[2] == 0.1


def test_groups_decide_for_themselves():
    vertices, faces = icosphere()
    ball, block = rw.Mesh(np.float32(vertices), faces), cuboid()
    to = np.eye(4)
    to[:3, 3] = PLACE
    placed = rw.Scene([rw.Instance(ball, to), cuboid(at=0.0)])
    assert not row(placed).needed
    # A copy is at the place of its matrix, in float64.
    assert abs(placed.intersect(there(0, 0, 9), (0, 0, -1)).t - 8) < 1e-8
    scene = rw.Scene([rw.Instance(block, np.eye(4)), rw.Instance(ball, np.eye(4)), ball])
    assert row(scene).needed
    assert row(scene).meaning == row(rw.Scene(block)).meaning
    assert scene.accelerator_info.precision == "single"
    assert abs(scene.intersect(there(0.1, 0.2, 9), (0, 0, -1)).t - 8) < 1e-9
    alone = rw.Scene([rw.Instance(rw.Instance(block, np.eye(4)), np.eye(4))])
    assert row(alone).needed
    with pytest.warns(RuntimeWarning, match=r"moves vertices by up to 0\.\d+, 0\.0\d+ of"):
        rw.Scene(alone.shapes, precision="single").bounds  # noqa: B018 (compiles it)


def icosphere():
    sphere = trimesh.creation.icosphere(subdivisions=1)
    return sphere.vertices, sphere.faces


def test_single_where_it_hurts_warns_once_and_tells_how_much():
    scene = rw.Scene(cuboid(), precision="single")
    # float32 has steps of a half there: 5,248,998.2 becomes 5,248,998.
    moved, share = 0.2, 0.2 / 6
    message = (
        rf'^precision="single" moves vertices by up to {moved:.3g}, {share:.2g} of the extent of their mesh; '
        r'"auto" and "double" keep them where they are$'
    )
    with pytest.warns(RuntimeWarning, match=message) as caught:
        scene.intersect(PLACE, (0, 0, 1))
    assert len(caught) == 1
    assert caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene.intersect(PLACE, (0, 0, 1))
        scene.rebuild()
        scene.refit(scene.shapes[0].vertices + 0.01)
        for precision in ("auto", "double"):
            rw.Scene(scene.shapes, precision=precision).bounds  # noqa: B018 (compiles it)
        rw.Scene(cuboid(at=0.1), precision="single").bounds  # noqa: B018 (compiles it)
    assert "which moves none by more than 2.1e-1, 3.5e-2 of its mesh's extent" in row(scene).meaning


def test_vertices_that_move_are_measured_where_they_are():
    home = cuboid(at=0.125)
    scene = rw.Scene(home)
    assert scene.intersect((0.1, 0.1, 9), (0, 0, -1)).hit
    assert scene.accelerator_info.precision == "single"
    scene.refit(home.vertices + PLACE)
    assert scene.accelerator_info.precision == "double"
    assert np.diff(scene.intersect_all(there(0.1, 0.1, 9), (0, 0, -1)).t) == pytest.approx(2, abs=1e-9)
    assert scene == rw.Scene(rw.Mesh(home.vertices + PLACE, home.faces))
    scene.refit(home.vertices)
    assert not row(scene).needed
    fresh = rw.Scene(home)
    rays = np.random.default_rng(3).normal(size=(2, 500, 3))
    assert scene.intersect(*rays) == fresh.intersect(*rays)
    scene.rebuild()
    assert scene.accelerator_info.precision == "single"
    single = rw.Scene(home, precision="single")
    assert single.intersect((0.1, 0.1, 9), (0, 0, -1)).hit
    with pytest.warns(RuntimeWarning, match="moves vertices") as caught:
        single.refit(home.vertices + PLACE)
    assert [one.filename for one in caught] == [__file__]


def test_what_was_asked_is_kept_and_told():
    block = cuboid()
    scenes = [rw.Scene(block), *(rw.Scene(block, precision=p) for p in ("auto", "single", "double"))]
    assert [scene.precision for scene in scenes] == ["auto", "auto", "single", "double"]
    assert scenes[0] == scenes[1]
    assert len({scenes[1], scenes[2], scenes[3]}) == 3
    assert "precision" not in repr(scenes[0])
    assert "precision='double'" in repr(scenes[3])
    for scene in scenes:
        back = pickle.loads(pickle.dumps(scene))
        assert back == scene
        assert back.precision == scene.precision
    assert row(scenes[3]) == rw.scene.PlanRow("float64 vertices", True, "all digits kept, as asked for")
    ways = np.random.default_rng(4).normal(size=(500, 3))
    assert scenes[0].intersect(PLACE, ways) == scenes[3].intersect(PLACE, ways)
    assert scenes[0].bytes == scenes[3].bytes


STRUCTURES = (
    rw.BVH,
    rw.accelerators.KdTree,
    rw.accelerators.Grid,
    rw.accelerators.NestedGrid,
    rw.accelerators.Octree,
    rw.accelerators.BSP,
    rw.BruteForce,
)


@pytest.mark.parametrize("accelerator", [rw.BVH(traversal="stack"), *(kind() for kind in STRUCTURES)])
def test_every_accelerator_tells_what_it_holds(accelerator):
    for mesh, precision, t in ((cuboid(at=0.0), "single", 8.5), (cuboid(), "double", 8.0)):
        scene = rw.Scene([mesh, rw.Sphere(PLACE, 0.5)], accelerator=accelerator)
        assert scene.accelerator_info.precision == precision
        assert abs(scene.intersect(there(0, 0, 9), (0, 0, -1)).t - t) < 1e-8


def lit_room(at):
    """A room with a block, a ball, a copy and lights of all kinds, at a place."""
    at = np.asarray(at, np.float64)
    room = cuboid(at, (12.0, 12.0, 8.0), material=rw.Diffuse((0.7, 0.6, 0.5)))
    block = cuboid(
        at + np.array((2, 2, -3)), (2.0, 3.0, 2.0), material=rw.Plastic((0.2, 0.4, 0.6), roughness=0.3)
    )
    to = np.eye(4)
    to[:3, 3] = at + np.array((-2, -1, -2.5))
    glossy = rw.Instance(rw.Mesh(*icosphere(), material=rw.Conductor("Au", roughness=0.2)), to)
    glass = rw.Sphere(at + np.array((-1.0, 3.0, -2.0)), 1.0, material=rw.Dielectric(1.5))
    corners = at + np.array([(-1, -1, 3.9), (-1, 1, 3.9), (1, 1, 3.9), (1, -1, 3.9)])
    lamp = rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], emission=9.0)
    bulb = rw.Sphere(at + np.array((3.0, -3.0, 1.0)), 0.3, emission=20.0)
    lights = [
        rw.PointLight(at + np.array((0, 0, 2)), 5),
        rw.SpotLight(at + np.array((3, 3, 3)), at, 20.0),
    ]
    scene = rw.Scene([room, block, glossy, glass, lamp, bulb], lights)
    camera = rw.Camera(at + np.array((4.5, -4.8, 1.0)), at, up=(0, 0, 1), fov=75, width=48, height=36)
    return scene, camera


@pytest.mark.parametrize("integrator", [rw.Path(max_depth=6), rw.Direct(), rw.AmbientOcclusion(radius=3)])
def test_a_room_at_map_coordinates_looks_as_it_does_at_the_origin(integrator):
    (home, before), (scene, camera) = lit_room((0, 0, 0)), lit_room(PLACE)
    assert row(scene).needed
    # The same random numbers: pictures differ only at few pixels, where rounding of coordinates decides.
    wanted, found = (
        rw.render(s, c, integrator, samples=16, seed=5, progress=False).rgb.astype(float)
        for s, c in ((home, before), (scene, camera))
    )
    differs = ~np.isclose(found, wanted, rtol=1e-4, atol=1e-4).all(axis=-1)
    assert wanted.mean() > 0.1
    assert differs.mean() < 0.02, differs.mean()
    assert found.mean() == pytest.approx(wanted.mean(), rel=2e-3)
