"""Ways through a BVH: the answers of brute force, whatever built the tree, and the work that they promise."""

from functools import cache
from typing import get_args

import numpy as np
import pytest

import raywright as rw
from raywright.accelerators import Traversal, Volume, every

WIDE8 = rw.simd() not in ("scalar", "neon", "sse2")
WAYS = [{"traversal": name} for name in get_args(Traversal) if name != "wide8" or WIDE8]
WAYS.append({"traversal": "threaded", "orders": 6})
WAYS += [{"traversal": "stack", "bounds": bounds} for bounds in ("oriented", "slabs")]
BUILDERS = [
    {},
    {"builder": "spatial", "budget": 4, "optimize": "reinsertion"},
    {"builder": "ploc"},
    {"builder": "morton", "optimize": ("treelet", "reinsertion")},
    {"builder": "median"},
]
KNOT = rw.scenes.torus_knot(along=60, around=8)


def named(options):
    """Return options in short, as a name of a test."""
    return " ".join(str(value) for value in options.values()) or "default"


def sticks(count=300):
    """Return long thin triangles along diagonals."""
    random = np.random.default_rng(1)
    start = random.uniform(-1, 1, (count, 3))
    end = start + np.array([1.5, 1.4, -1.5])
    corners = np.stack([start, end, end + random.uniform(-0.02, 0.02, (count, 3))], axis=1)
    return rw.Mesh(corners.reshape(-1, 3).astype(np.float32), np.arange(3 * count).reshape(-1, 3))


def coplanar():
    """Return a square of small squares."""
    x, y = np.meshgrid(np.arange(21.0), np.arange(21.0))
    corner = (np.arange(20)[:, None] * 21 + np.arange(20)).reshape(-1, 1)
    return rw.Mesh(
        np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3),
        (corner + np.array([[0, 1, 22, 0, 22, 21]])).reshape(-1, 3),
    )


ONE = rw.Mesh([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
COPIES = rw.Mesh(ONE.vertices, np.tile(ONE.faces, (60, 1)))
SHAPES = [
    rw.Sphere((0, 0, 0), 0.5),
    rw.Plane((0, 0, -1), (0, 0, 1)),
    rw.Torus(major_radius=1, minor_radius=0.2),
    rw.Cylinder((0, 0, 0), (1, 1, 1), 0.1),
    sticks(50),
]
# Closed meshes far from each other, huge and tiny.
SIZES = [KNOT, rw.Mesh(KNOT.vertices * 1e-3 + 5, KNOT.faces), rw.Mesh(KNOT.vertices * 1e4, KNOT.faces)]
SCENES = {
    "knot": KNOT,
    "sticks": sticks(),
    "sizes": SIZES,
    "coplanar": coplanar(),
    "coincident": COPIES,
    "single": ONE,
    "shapes": SHAPES,
    "nothing": [],
}


def rays_for(scene, seed=2):
    """Return rays at vertices and between them, along axes, from near and far; and a camera's."""
    random = np.random.default_rng(seed)
    meshes = [shape.vertices for shape in scene.shapes if isinstance(shape, rw.Mesh)]
    vertices = np.concatenate(meshes or [np.zeros((1, 3))]).astype(float)
    size = np.ptp(vertices, axis=0).max() + 1
    targets = vertices[random.integers(0, len(vertices), 500)]
    targets[::3] = (targets[::3] + vertices[random.integers(0, len(vertices), 167)]) / 2
    origins = targets + random.normal(size=(500, 3)) * size * 10.0 ** random.integers(-3, 3, (500, 1))
    directions = targets - origins
    axis = np.eye(3)[random.integers(0, 3, 100)]
    origins[:100] = targets[:100] - 3 * size * axis
    directions[:100] = axis
    middle = vertices.mean(axis=0)
    eye = middle + size * np.array([0.1, 0.2, 2])
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, 20), np.linspace(-0.5, 0.5, 20))
    screen = middle - eye + size * np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    return np.concatenate([origins, np.tile(eye, (400, 1))]), np.concatenate([directions, screen])


@cache
def true_answers(scene):
    """Return rays, and by brute force: hits, all hits, whether origins are inside, and what is nearest."""
    brute = rw.Scene(SCENES[scene], accelerator=rw.BruteForce())
    rays = rays_for(brute)
    nearest = brute.closest_point(rays[0])
    return rays, brute.intersect(*rays), brute.intersect_all(*rays), brute.contains(rays[0]), nearest


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("builder", BUILDERS, ids=named)
@pytest.mark.parametrize("way", WAYS, ids=named)
def test_every_answer_is_that_of_brute_force(way, builder, scene):
    tree = rw.Scene(SCENES[scene], accelerator=rw.BVH(**way, **builder))
    rays, hits, every_hit, inside, nearest = true_answers(scene)
    assert hits.hit.sum() > 100 or not tree.shapes
    assert tree.intersect(*rays) == hits
    np.testing.assert_array_equal(tree.occluded(*rays), hits.hit)
    assert tree.intersect_all(*rays) == every_hit
    np.testing.assert_array_equal(tree.contains(rays[0]), inside)
    assert tree.closest_point(rays[0]) == nearest
    cost = tree.traversal_cost(*rays)
    assert (cost.primitives[hits.hit] >= 1).all()
    assert (cost.nodes[hits.hit] >= 1).sum() > 0.1 * hits.hit.sum() or not tree.shapes


@pytest.mark.parametrize("way", WAYS, ids=named)
def test_doubles_are_kept(way):
    mesh = rw.Mesh(KNOT.vertices + np.array([1e6, 1 / 3, -1e5]), KNOT.faces)
    brute = rw.Scene(mesh, accelerator=rw.BruteForce(), precision="double")
    tree = rw.Scene(mesh, accelerator=rw.BVH(**way), precision="double")
    assert "double" in tree.accelerator_info.kind
    rays = rays_for(brute)
    assert brute.intersect(*rays).hit.sum() > 200
    assert tree.intersect(*rays) == brute.intersect(*rays)


@pytest.mark.parametrize("way", WAYS, ids=named)
def test_a_tree_follows_what_moves(way):
    tree = rw.Scene(KNOT, accelerator=rw.BVH(**way))
    kind = tree.accelerator_info.kind
    tree.refit(KNOT.vertices[::-1] * np.float32(1.5))
    brute = rw.Scene(tree.shapes, accelerator=rw.BruteForce())
    rays = rays_for(brute)
    assert tree.intersect(*rays) == brute.intersect(*rays)
    assert tree.accelerator_info.kind.startswith(kind)


@pytest.mark.parametrize(
    ("way", "said"),
    [
        ({"traversal": "wide4"}, "BVH, 4 wide, "),
        ({"traversal": "stack"}, ", stack, single"),
        ({"traversal": "threaded"}, ", threaded in 8 orders, single"),
        ({"traversal": "threaded", "orders": 6}, ", threaded in 6 orders, single"),
        ({"traversal": "stack", "bounds": "oriented"}, ", stack in turned boxes, single"),
        ({"traversal": "stack", "bounds": "slabs"}, ", stack in 13 slabs, single"),
        ({"traversal": "packets4"}, ", packets of 4, single"),
        ({"traversal": "packets64"}, ", packets of 64, single"),
        ({"traversal": "flat"}, ", flat, stack, single"),
        ({"traversal": "stackless"}, ", flat, stackless, single"),
    ],
    ids=str,
)
def test_the_kind_says_how_it_is_walked(way, said):
    scene = rw.Scene(KNOT, accelerator=rw.BVH(builder="ploc", **way), precision="single")
    kind = scene.accelerator_info.kind
    assert said in kind
    assert "PLOC" in kind


def test_threads_take_memory_for_each_order():
    stack, six, eight = (
        rw.Scene(KNOT, accelerator=rw.BVH(**way)).accelerator_info
        for way in ({"traversal": "stack"}, {"traversal": "threaded", "orders": 6}, {"traversal": "threaded"})
    )
    nodes = stack.nodes + stack.leaves
    assert six.bytes - stack.bytes == 6 * 8 * nodes
    assert eight.bytes - stack.bytes == 8 * 8 * nodes


def test_arrays_without_pointers_are_the_same_tree():
    stack, flat, stackless = (
        rw.Scene(KNOT, accelerator=rw.BVH(traversal=way)) for way in ("stack", "flat", "stackless")
    )
    rays = rays_for(stack)
    assert flat.accelerator_info.bytes == stackless.accelerator_info.bytes == stack.accelerator_info.bytes
    assert flat.accelerator_info.sah_cost == stack.accelerator_info.sah_cost
    # With a stack, the same boxes are tested in the same order; without one, others too.
    np.testing.assert_array_equal(flat.traversal_cost(*rays).nodes, stack.traversal_cost(*rays).nodes)
    np.testing.assert_array_equal(
        flat.traversal_cost(*rays).primitives, stack.traversal_cost(*rays).primitives
    )
    assert stackless.traversal_cost(*rays).primitives.sum() > stack.traversal_cost(*rays).primitives.sum()


def test_rays_of_one_mind_share_work():
    rays = rw.Camera((0, 0, 6), (0, 0, 0), width=256, height=256).rays()
    alone, together = (
        rw.Scene(KNOT, accelerator=rw.BVH(traversal=way)).traversal_cost(*rays).nodes.sum(dtype=int)
        for way in ("stack", "packets64")
    )
    assert 2 * together < alone


@pytest.mark.parametrize("bounds", ["oriented", "slabs"])
def test_volumes_beside_boxes_spare_tests_where_geometry_is_diagonal(bounds):
    mesh = sticks(2000)
    rays = np.random.default_rng(3).normal(size=(2, 3000, 3))
    box, fit = (rw.BVH(traversal="stack", bounds=b) for b in ("box", bounds))
    # Fast builds do not split sticks into pieces, which would leave less to save.
    box, fit = (rw.Scene(mesh, accelerator=tree, quality="low") for tree in (box, fit))
    before, after = box.traversal_cost(*rays), fit.traversal_cost(*rays)
    assert fit.accelerator_info.bytes > box.accelerator_info.bytes
    assert (after.nodes <= before.nodes).mean() > 0.99
    assert 2 * after.primitives.sum(dtype=int) < before.primitives.sum(dtype=int)


def test_costs_decide_what_becomes_a_leaf():
    def leaves(cost, **options):
        tree = rw.BVH(traversal="stack", intersection_cost=cost, **options)
        return rw.Scene(KNOT, accelerator=tree).accelerator_info.leaves

    for options in BUILDERS:
        assert leaves(0.02, **options) < 0.5 * leaves(50, **options)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"traversal": "wide16"}, r"traversal must be one of 'wide', .*, got 'wide16'"),
        ({"traversal": "threaded", "orders": 7}, r"orders must be 6 or 8, got 7"),
        ({"traversal": "threaded", "orders": 9}, r"orders must be between 6 and 8, got 9"),
        ({"bounds": "sphere"}, r"bounds must be one of 'box', .*, got 'sphere'"),
        ({"bounds": "slabs"}, r"bounds is for traversal 'stack', got traversal 'wide'"),
        ({"traversal": "stack", "orders": 8}, r"orders is for traversal 'threaded', got traversal 'stack'"),
    ],
    ids=str,
)
def test_what_is_refused(options, message):
    with pytest.raises(ValueError, match=message):
        rw.BVH(**options)


def test_eight_wide_says_where_it_cannot_be():
    scene = rw.Scene(KNOT, accelerator=rw.BVH(traversal="wide8"))
    if WIDE8:
        assert "8 wide" in scene.accelerator_info.kind
    else:
        with pytest.raises(ValueError, match='"wide8" needs AVX2, and kernels run at'):
            scene.rebuild()


def test_every_way_is_among_every_accelerator():
    trees = [one for one in every().values() if isinstance(one, rw.BVH)]
    assert {one.traversal for one in trees} == set(get_args(Traversal)) - {"wide8"}
    assert {one.bounds for one in trees} == set(get_args(Volume))
