"""How a BVH is built and improved: what can be asked for, what is refused, and that answers stay the same."""

import pickle
from typing import get_args

import numpy as np
import pytest

import raywright as rw
from raywright.accelerators import Builder

BUILDERS = get_args(Builder)
KINDS = {
    "binned": "binned SAH",
    "sweep": "full-sweep SAH",
    "spatial": "SAH with spatial splits",
    "morton": "Morton codes",
    "ploc": "PLOC",
    "midpoint": "midpoints",
    "median": "medians",
    "mean": "means",
}


def sticks(count=400, seed=1, crossed=False):
    """Return long thin triangles along a diagonal, or along all four, and rays among them."""
    random = np.random.default_rng(seed)
    start = random.uniform(-1, 1, (count, 3))
    signs = random.choice([-1, 1], (count, 3)) if crossed else 1
    end = start + np.array([1.5, 1.4, -1.5]) * signs
    corners = np.stack([start, end, end + random.uniform(-0.02, 0.02, (count, 3))], axis=1).astype(np.float32)
    mesh = rw.Mesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
    origins = random.uniform(-3, 3, (2000, 3))
    targets = corners[random.integers(count, size=2000)].mean(axis=1)
    return mesh, origins, targets - origins


@pytest.mark.parametrize("optimize", [None, (), "treelet", "reinsertion", ("treelet", "reinsertion")])
@pytest.mark.parametrize("builder", BUILDERS)
def test_every_tree_gives_the_hits_of_brute_force(builder, optimize):
    mesh, origins, directions = sticks()
    scene = rw.Scene(mesh, accelerator=rw.BVH(builder=builder, optimize=optimize))
    hits = scene.intersect(origins, directions)
    wanted = rw.Scene(mesh, accelerator=rw.BruteForce()).intersect(origins, directions)
    np.testing.assert_array_equal(hits.t, wanted.t)
    np.testing.assert_array_equal(hits.primitive_id, wanted.primitive_id)
    assert hits.hit.sum() > 500
    assert scene.accelerator_info.primitives == len(mesh.faces)


@pytest.mark.parametrize(
    ("optimize", "said"),
    [
        (None, ""),
        ((), ""),
        ("treelet", " and treelets"),
        (("reinsertion", "treelet"), " and reinsertion and treelets"),
    ],
)
@pytest.mark.parametrize("builder", BUILDERS)
def test_the_kind_says_how_it_was_built(builder, optimize, said):
    mesh, _, _ = sticks(20)
    kind = rw.Scene(mesh, accelerator=rw.BVH(builder=builder, optimize=optimize)).accelerator_info.kind
    if builder == "binned" and optimize is None:
        said = " and reinsertion"
    assert f", {KINDS[builder]}{said}, " in kind


def test_quality_decides_only_where_the_user_does_not():
    mesh, _, _ = sticks(20)

    def kind(quality, **options):
        return rw.Scene(mesh, accelerator=rw.BVH(**options), quality=quality).accelerator_info.kind

    assert "reinsertion" not in kind("low")
    assert "reinsertion" in kind("high")
    assert "reinsertion" not in kind("high", optimize=())
    assert "reinsertion" not in kind("high", builder="sweep")
    assert "reinsertion" in kind("low", builder="sweep", optimize="reinsertion")


def test_more_work_on_the_tree_leaves_less_for_rays():
    diagonal, knot = sticks(3000)[0], rw.scenes.torus_knot(along=120, around=20)

    def cost(mesh, **options):
        return rw.Scene(mesh, accelerator=rw.BVH(**options)).accelerator_info.sah_cost

    assert cost(diagonal, builder="spatial", budget=4) < 0.8 * cost(diagonal, builder="spatial", budget=0)
    assert cost(knot, builder="sweep") < cost(knot, builder="median")
    for builder in ("morton", "ploc", "midpoint", "median", "mean"):
        assert cost(knot, builder=builder, optimize=("treelet", "reinsertion")) < cost(knot, builder=builder)


def test_costs_decide_what_becomes_a_leaf():
    knot = rw.scenes.torus_knot(along=60, around=10)

    def leaves(**options):
        return rw.Scene(knot, accelerator=rw.BVH(**options)).accelerator_info.leaves

    for builder in BUILDERS:
        dear = leaves(builder=builder, intersection_cost=50)
        cheap = leaves(builder=builder, intersection_cost=0.02)
        assert cheap < dear


def test_a_scene_with_spatial_splits_can_be_moved():
    mesh, origins, directions = sticks()
    scene = rw.Scene(mesh, accelerator=rw.BVH(builder="spatial", budget=4))
    before = scene.intersect(origins, directions)
    scene.refit(mesh.vertices + np.float32(0.25))
    wanted = rw.Scene(scene.shapes, accelerator=rw.BruteForce()).intersect(origins, directions)
    assert scene.intersect(origins, directions) == wanted != before
    assert not scene.accelerator_info.kind.endswith("refitted")


@pytest.mark.parametrize("quality", ["medium", "high"])
def test_diagonals_are_cut_where_quality_decides(quality):
    mesh, origins, directions = sticks(3000, crossed=True)
    scene, plain = (rw.Scene(mesh, quality=wanted) for wanted in (quality, "low"))
    assert scene.intersect(origins, directions) == plain.intersect(origins, directions)
    assert " of pieces and reinsertion" in scene.accelerator_info.kind
    assert scene.accelerator_info.sah_cost < 0.6 * plain.accelerator_info.sah_cost
    for moved in (scene, plain):
        assert moved.refit(mesh.vertices * 2) == pytest.approx(1)
    assert not scene.accelerator_info.kind.endswith("refitted")
    assert plain.accelerator_info.kind.endswith("refitted")
    assert (
        "pieces" not in rw.Scene(mesh, quality=quality, accelerator=rw.BVH(optimize=())).accelerator_info.kind
    )
    assert "pieces" not in rw.Scene(rw.scenes.torus_knot(), quality=quality).accelerator_info.kind


@pytest.mark.parametrize("quality", ["medium", "high"])
def test_boxes_turn_where_all_stands_askew_and_quality_decides(quality):
    (room,) = rw.scenes.turned(rw.scenes.room(3000), 33, (1, 2, 3))
    for mesh, straight in ((sticks(3000)[0], None), (room, rw.scenes.room(3000)[0])):
        scene, plain = (rw.Scene(mesh, quality=wanted, precision="single") for wanted in (quality, "low"))
        rng = np.random.default_rng(7)
        origins = mesh.vertices[rng.integers(len(mesh.vertices), size=4000)] + rng.normal(size=(4000, 3))
        directions = rng.normal(size=(4000, 3))
        hits = plain.intersect(origins, directions)
        assert scene.intersect(origins, directions) == hits
        assert hits.hit.sum() > 1000
        assert ", turned, " in scene.accelerator_info.kind
        assert scene.accelerator_info.sah_cost < 0.5 * plain.accelerator_info.sah_cost
        if straight is not None:
            unturned = rw.Scene(straight, quality=quality).accelerator_info
            assert "turned" not in unturned.kind
            assert scene.accelerator_info.sah_cost < 1.1 * unturned.sah_cost
            assert scene.accelerator_info.bytes < 1.1 * unturned.bytes
        if quality == "medium":
            # No primitive was split.
            assert scene.accelerator_info.bytes < 60 * scene.accelerator_info.primitives
        assert scene.refit(mesh.vertices * 2) == pytest.approx(1)
        assert quality != "medium" or scene.accelerator_info.kind.endswith("turned, single, refitted")
        assert scene.intersect(origins * 2, directions * 2) == hits
    assert "turned" not in rw.Scene(mesh, accelerator=rw.BVH(optimize=())).accelerator_info.kind


@pytest.mark.parametrize("builder", BUILDERS)
@pytest.mark.parametrize("count", [0, 1, 2])
def test_a_few_triangles_and_none(builder, count):
    mesh, origins, directions = sticks(max(count, 1))
    mesh = rw.Mesh(mesh.vertices, mesh.faces[:count])
    scene = rw.Scene(mesh, accelerator=rw.BVH(builder=builder, optimize=("reinsertion", "treelet")))
    wanted = rw.Scene(mesh, accelerator=rw.BruteForce()).intersect(origins, directions)
    np.testing.assert_array_equal(scene.intersect(origins, directions).t, wanted.t)


def test_values_are_kept_as_plain_python():
    bvh = rw.BVH("ploc", radius=np.int8(20), optimize=["treelet"])
    assert (bvh.radius, bvh.optimize) == (20, ("treelet",))
    assert type(bvh.radius) is int
    assert rw.BVH("spatial", budget=np.float32(2)).budget == 2.0
    assert rw.BVH(optimize="treelet") == rw.BVH(optimize=("treelet",))
    assert hash(bvh) == hash(pickle.loads(pickle.dumps(bvh)))


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"builder": "best"}, ValueError, r"builder must be one of 'binned', .*'mean', got 'best'"),
        ({"bins": 1}, ValueError, r"bins must be between 2 and 64, got 1"),
        ({"bins": 8.0}, TypeError, r"bins must be an integer, got 8.0"),
        (
            {"builder": "sweep", "bins": 8},
            ValueError,
            r"bins is for builder 'binned' or 'spatial', got builder 'sweep'",
        ),
        ({"budget": 1}, ValueError, r"budget is for builder 'spatial', got builder 'binned'"),
        ({"builder": "spatial", "budget": -1}, ValueError, r"budget must be between 0 and 8, got -1"),
        ({"builder": "spatial", "budget": np.nan}, ValueError, r"budget must be finite, got nan"),
        ({"builder": "spatial", "budget": "much"}, TypeError, r"budget must be real numbers, got 'much'"),
        ({"radius": 3}, ValueError, r"radius is for builder 'ploc', got builder 'binned'"),
        ({"builder": "ploc", "radius": 0}, ValueError, r"radius must be between 1 and 128, got 0"),
        ({"optimize": "best"}, ValueError, r"optimize must be one of 'reinsertion', 'treelet', got 'best'"),
        (
            {"optimize": ("treelet", 3)},
            ValueError,
            r"optimize must be one of 'reinsertion', 'treelet', got 3",
        ),
        ({"optimize": 3}, TypeError, r"optimize must be a name or a tuple of names, got 3"),
        (
            {"optimize": ("treelet", "treelet")},
            ValueError,
            r"optimize must name each optimizer at most once, got \('treelet', 'treelet'\)",
        ),
        ({"traversal_cost": 0}, ValueError, r"traversal_cost must be greater than 0, got 0"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(options, error, message):
    with pytest.raises(error, match=message) as caught:
        rw.BVH(**options)
    assert "\n" not in str(caught.value)
