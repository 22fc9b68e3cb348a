"""Grids: the same answers as brute force, and the work and memory that they promise."""

from functools import cache

import numpy as np
import pytest

import raywright as rw

KNOT = rw.scenes.torus_knot(along=60, around=8)
GRIDS = [
    rw.accelerators.Grid(),
    rw.accelerators.Grid(mailbox="cache"),
    rw.accelerators.Grid(mailbox="none"),
    rw.accelerators.Grid(resolution=1),
    rw.accelerators.Grid(resolution=40),
    rw.accelerators.Grid(resolution=(3, 17, 5)),
    rw.accelerators.Grid(density=0.5),
    rw.accelerators.NestedGrid(),
    rw.accelerators.NestedGrid(resolution=2, leaf=1, depth=16),
    rw.accelerators.NestedGrid(resolution=(4, 3, 2), density=8, mailbox="cache"),
    rw.accelerators.NestedGrid(density=0.5, mailbox="none"),
]


def soup(count, size, seed=1):
    """Small triangles, evenly spread over a cube."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1, 1, (count, 1, 3)) + rng.uniform(-size, size, (count, 3, 3))
    return rw.Mesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))


def flat_floor():
    """A square of small squares: along the third axis there is nothing to cut."""
    x, y = np.meshgrid(np.arange(21.0), np.arange(21.0))
    vertices = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    corner = (np.arange(20)[:, None] * 21 + np.arange(20)).reshape(-1, 1)
    faces = (corner + np.array([[0, 1, 22, 0, 22, 21]])).reshape(-1, 3)
    return rw.Mesh(vertices, faces)


def mixed_sizes():
    """A hall of two huge triangles around many tiny ones."""
    small = soup(500, 0.03)
    floor = rw.Mesh(np.array([(-1e4, -1e4, -2), (1e4, -1e4, -2), (0, 1e4, -2.5)]), [(0, 1, 2)])
    return [floor, small, rw.Mesh(small.vertices * 1e-3 + (50, 60, 3), small.faces)]


SCENES = {"knot": KNOT, "soup": soup(600, 0.2), "floor": flat_floor(), "mixed": mixed_sizes(), "nothing": []}


def rays_for(scene, seed):
    """Rays at vertices, edges, and anywhere; along axes; from near, inside and far."""
    rng = np.random.default_rng(seed)
    vertices = np.concatenate([m.vertices for m in scene.shapes] or [np.zeros((1, 3))])
    size = np.ptp(vertices, axis=0).max() + 1
    targets = vertices[rng.integers(0, len(vertices), 600)]
    targets[::3] = (targets[::3] + vertices[rng.integers(0, len(vertices), 200)]) / 2
    origins = targets + rng.normal(size=(600, 3)) * size * 10.0 ** rng.integers(-3, 3, (600, 1))
    # So far away that exact arithmetic decides, at half a millisecond a ray.
    origins[560:] = targets[560:] + rng.normal(size=(40, 3)) * size * 10.0 ** rng.integers(5, 30, (40, 1))
    directions = targets - origins
    axis = np.eye(3)[rng.integers(0, 3, 100)]
    origins[:100] = targets[:100] - 3 * size * axis
    directions[:100] = axis
    return origins, directions


@cache
def true_answers(scene):
    """Rays, and by brute force: hits, all hits, and what is nearest."""
    brute = rw.Scene(SCENES[scene], accelerator=rw.BruteForce())
    rays = rays_for(brute, 2)
    return rays, brute.intersect(*rays), brute.intersect_all(*rays), brute.closest_point(rays[0])


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("accelerator", GRIDS, ids=repr)
def test_every_answer_is_that_of_brute_force(accelerator, scene):
    grid = rw.Scene(SCENES[scene], accelerator=accelerator)
    rays, hits, every_hit, nearest = true_answers(scene)
    assert hits.hit.sum() > 200 or not grid.shapes
    assert grid.intersect(*rays) == hits
    assert np.array_equal(grid.occluded(*rays), hits.hit)
    assert grid.intersect_all(*rays) == every_hit
    assert grid.closest_point(rays[0]) == nearest


@pytest.mark.parametrize("accelerator", GRIDS, ids=repr)
def test_doubles_are_kept(accelerator):
    mesh = rw.Mesh(KNOT.vertices + np.array([1e6, 1 / 3, -1e5]), KNOT.faces)
    brute = rw.Scene(mesh, accelerator=rw.BruteForce(), precision="double")
    grid = rw.Scene(mesh, accelerator=accelerator, precision="double")
    assert "double" in grid.accelerator_info.kind
    rays = rays_for(brute, 3)
    hits = brute.intersect(*rays)
    assert hits.hit.sum() > 200
    assert grid.intersect(*rays) == hits


@pytest.mark.parametrize("accelerator", [rw.accelerators.Grid(), rw.accelerators.NestedGrid()], ids=repr)
def test_points_are_inside_where_brute_force_says(accelerator):
    points = np.random.default_rng(4).uniform(-2, 2, (3000, 3))
    inside = rw.Scene(KNOT, accelerator=rw.BruteForce()).contains(points)
    assert 50 < inside.sum() < 2900
    assert np.array_equal(rw.Scene(KNOT, accelerator=accelerator).contains(points), inside)


def test_a_mailbox_saves_tests_and_changes_nothing_else():
    mesh = soup(3000, 0.1)
    rays = np.random.default_rng(5).normal(size=(2, 2000, 3))
    scenes = [
        rw.Scene(mesh, accelerator=rw.accelerators.Grid(mailbox=m)) for m in ("stamps", "cache", "none")
    ]
    stamps, cache, none = (scene.traversal_cost(*rays) for scene in scenes)
    assert np.array_equal(stamps.nodes, none.nodes)
    assert np.array_equal(cache.nodes, none.nodes)
    assert (stamps.primitives <= cache.primitives).all()
    assert (cache.primitives <= none.primitives).all()
    assert stamps.primitives.sum() < 0.8 * none.primitives.sum()
    assert cache.primitives.sum() < 0.9 * none.primitives.sum()


def test_a_ray_takes_few_tests_where_primitives_are_even():
    mesh = soup(5000, 0.05)
    scene = rw.Scene(mesh, accelerator=rw.accelerators.Grid())
    cost = scene.traversal_cost(*np.random.default_rng(6).normal(size=(2, 3000, 3)))
    assert cost.primitives.mean() < 50
    x, y, z = (int(n) for n in scene.accelerator_info.kind.split("of ")[1].split(",")[0].split(" x "))
    # A line crosses at most as many cells as there are planes, plus one.
    assert cost.nodes.max() <= x + y + z - 2
    assert scene.accelerator_info.nodes == x * y * z


def test_nested_grids_are_for_what_is_fine_in_few_places():
    rng = np.random.default_rng(7)
    knot = rw.Mesh(KNOT.vertices * 1e-2, KNOT.faces)
    scene = [rw.Mesh(soup(300, 0.5).vertices * 10, soup(300, 0.5).faces), knot]
    targets = knot.vertices[rng.integers(0, len(knot.vertices), 2000)]
    rays = (targets + rng.normal(size=(2000, 3)) * 0.1, rng.normal(size=(2000, 3)))
    single, nested = (
        rw.Scene(scene, accelerator=a).traversal_cost(*rays)
        for a in (rw.accelerators.Grid(), rw.accelerators.NestedGrid())
    )
    assert nested.primitives.mean() < 0.2 * single.primitives.mean()
    assert rw.Scene(scene, accelerator=rw.accelerators.NestedGrid()).accelerator_info.depth > 1
    assert rw.Scene(scene, accelerator=rw.accelerators.NestedGrid(depth=1)).accelerator_info.depth == 1


@pytest.mark.parametrize("accelerator", GRIDS, ids=repr)
def test_memory_is_bounded_whatever_is_given(accelerator):
    one = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 1)])
    coincident = rw.Mesh(np.tile(one, (20_000, 1)), np.arange(60_000).reshape(-1, 3))
    rng = np.random.default_rng(8)
    huge = rw.Mesh(rng.normal(size=(60_000, 3)).astype(np.float32), np.arange(60_000).reshape(-1, 3))
    for mesh in (coincident, huge):
        info = rw.Scene(mesh, accelerator=accelerator).accelerator_info
        # A dozen references of forty bytes and a word, plus the cells of a given resolution.
        assert info.bytes < 20_000 * 12 * 60 + (2**21 * 44 if accelerator.resolution else 2**14 * 44)
    scene = rw.Scene(coincident, accelerator=accelerator)
    hits = scene.intersect([(0.25, 0.25, 5)], (0, 0, -1))
    assert (hits.primitive_id[0], hits.t[0]) == (0, 4.75)


def test_what_is_given_is_the_resolution():
    assert (
        "grid of 3 x 17 x 5,"
        in rw.Scene(KNOT, accelerator=rw.accelerators.Grid((3, 17, 5))).accelerator_info.kind
    )
    kind = rw.Scene(
        rw.Mesh(KNOT.vertices * (4, 2, 1), KNOT.faces), accelerator=rw.accelerators.Grid(32)
    ).accelerator_info.kind
    assert "grid of 32 x " in kind
    assert rw.accelerators.Grid(np.int64(7)).resolution == 7
    assert rw.accelerators.Grid([1, 2, np.uint8(3)]).resolution == (1, 2, 3)
    assert rw.Scene([], accelerator=rw.accelerators.Grid()).accelerator_info.nodes == 0


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: rw.accelerators.Grid(0), ValueError, r"resolution must be between 1 and 4096, got 0"),
        (
            lambda: rw.accelerators.Grid((1, 5000, 1)),
            ValueError,
            r"resolution must be between 1 and 4096, got 5000",
        ),
        (lambda: rw.accelerators.Grid((1, 2)), ValueError, r"resolution must be one integer or 3, got 2"),
        (
            lambda: rw.accelerators.Grid((1024, 1024, 1024)),
            ValueError,
            r"at most 134217728 cells, got 1024 x 1024 x 1024",
        ),
        (lambda: rw.accelerators.Grid(2.5), TypeError, r"resolution must be an integer, got 2\.5"),
        (lambda: rw.accelerators.Grid("fine"), TypeError, r"resolution must be an integer, got 'fine'"),
        (lambda: rw.accelerators.Grid(density=0), ValueError, r"density must be greater than 0, got 0"),
        (
            lambda: rw.accelerators.Grid(density=1e6),
            ValueError,
            r"density must be at most 1000, got 1000000\.0",
        ),
        (lambda: rw.accelerators.Grid(density=np.nan), ValueError, r"density must be finite, got nan"),
        (
            lambda: rw.accelerators.Grid(mailbox="both"),
            ValueError,
            r"mailbox must be one of 'stamps', 'cache', 'none', got 'both'",
        ),
        (
            lambda: rw.accelerators.NestedGrid(leaf=0),
            ValueError,
            r"leaf must be between 1 and 2147483647, got 0",
        ),
        (lambda: rw.accelerators.NestedGrid(depth=17), ValueError, r"depth must be between 1 and 16, got 17"),
        (
            lambda: rw.accelerators.NestedGrid(density=-1),
            ValueError,
            r"density must be greater than 0, got -1",
        ),
        (
            lambda: rw.accelerators.NestedGrid(mailbox=None),
            ValueError,
            r"mailbox must be one of .*, got None",
        ),
    ],
)
def test_what_is_out_of_range_is_refused_in_one_line(call, error, message):
    with pytest.raises(error, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)
