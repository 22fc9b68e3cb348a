"""Structures that divide space: they answer as brute force does, and test no primitive twice for a ray."""

import numpy as np
import pytest

import raywright as rw

CHOICES = [
    *(
        rw.accelerators.KdTree(b, t)
        for b in ("sah", "median", "middle", "cycle")
        for t in ("stack", "restart")
    ),
    rw.accelerators.KdTree(max_depth=0),
    rw.accelerators.KdTree(empty_bonus=1, leaf_size=1, traversal_cost=3, intersection_cost=2),
    rw.accelerators.Octree(),
    rw.accelerators.Octree(max_depth=18, leaf_size=1),
    rw.accelerators.BSP(),
    rw.accelerators.BSP(candidates=1, leaf_size=1, max_depth=60),
]
KNOT = rw.scenes.torus_knot(along=60, around=8)
BRUTE = rw.Scene(KNOT, accelerator=rw.BruteForce())


def soup(count=300, size=0.3, seed=1):
    """Triangles across each other: hardly a plane cuts none."""
    random = np.random.default_rng(seed)
    corners = random.uniform(-1, 1, (count, 1, 3)) + random.normal(0, size, (count, 3, 3))
    return rw.Mesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))


def rays(count=400, seed=2):
    """Rays at vertices, along axes, and anywhere."""
    random = np.random.default_rng(seed)
    origins = random.uniform(-3, 3, (count, 3))
    directions = random.normal(size=(count, 3))
    vertices = KNOT.vertices[random.integers(len(KNOT.vertices), size=count)]
    directions[::3] = (vertices - origins)[::3]
    directions[1::9] = (0, 0, -1)
    return origins, directions


@pytest.mark.parametrize("choice", CHOICES, ids=repr)
@pytest.mark.parametrize("shape", [KNOT, soup()], ids=["knot", "soup"])
def test_every_question_is_answered_as_brute_force_does(choice, shape):
    scene, brute = rw.Scene(shape, accelerator=choice), rw.Scene(shape, accelerator=rw.BruteForce())
    origins, directions = rays()
    assert brute.intersect(origins, directions).hit.sum() > 50
    assert scene.intersect(origins, directions) == brute.intersect(origins, directions)
    assert scene.intersect_all(origins, directions) == brute.intersect_all(origins, directions)
    for t_max in (0.7, np.inf):
        expected = brute.occluded(origins, directions, t_max=t_max)
        assert (scene.occluded(origins, directions, t_max=t_max) == expected).all()


@pytest.mark.parametrize("choice", CHOICES, ids=repr)
def test_what_is_inside_is_inside(choice):
    points = np.random.default_rng(3).uniform(-2, 2, (500, 3))
    inside = BRUTE.contains(points)
    assert 0 < inside.sum() < len(points)
    assert (rw.Scene(KNOT, accelerator=choice).contains(points) == inside).all()


@pytest.mark.parametrize("choice", CHOICES, ids=repr)
def test_no_primitive_is_tested_twice_for_a_ray(choice):
    # All of them lie across the middle, and stand in many leaves.
    count = 60
    fan = soup(count, size=1.0)
    cost = rw.Scene(fan, accelerator=choice).traversal_cost(*rays())
    assert cost.primitives.max() <= count
    assert (rw.Scene(fan, accelerator=rw.BruteForce()).traversal_cost(*rays()).primitives == count).all()


@pytest.mark.parametrize(
    "choice", [rw.accelerators.KdTree(), rw.accelerators.Octree(), rw.accelerators.BSP()], ids=repr
)
def test_most_primitives_are_not_tested(choice):
    cost = rw.Scene(KNOT, accelerator=choice).traversal_cost(*rays())
    assert cost.primitives.mean() < len(KNOT.faces) / 20


def test_with_and_without_a_stack_the_same_primitives_are_tested():
    tested = [
        rw.Scene(KNOT, accelerator=rw.accelerators.KdTree(traversal=t)).traversal_cost(*rays())
        for t in ("stack", "restart")
    ]
    assert (tested[0].primitives == tested[1].primitives).all()
    assert (tested[0].nodes <= tested[1].nodes).all()


@pytest.mark.parametrize(
    "choice", [rw.accelerators.KdTree(), rw.accelerators.Octree(), rw.accelerators.BSP()], ids=repr
)
@pytest.mark.parametrize("count", [0, 1, 2])
def test_few_faces(choice, count):
    mesh = rw.Mesh([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2), (0, 1, 3)][:count])
    scene = rw.Scene(mesh, accelerator=choice)
    assert scene.intersect((0.2, 0.2, 5), (0, 0, -1)).hit == (count > 0)
    assert scene.intersect((0.2, 5, 0.2), (0, -1, 0)).hit == (count > 1)
    assert (scene.accelerator_info.nodes, scene.accelerator_info.leaves) == (0, min(count, 1))


@pytest.mark.parametrize(
    ("choice", "kind"),
    [
        (rw.accelerators.KdTree(), "kD-tree, sah, stack, single"),
        (rw.accelerators.KdTree("cycle", "restart"), "kD-tree, cycle, restart, single"),
        (rw.accelerators.Octree(), "octree, single"),
        (rw.accelerators.BSP(), "BSP tree, single"),
    ],
)
def test_what_it_is_is_told(choice, kind):
    told = rw.Scene(KNOT, accelerator=choice, precision="single").accelerator_info
    assert told.kind == kind
    assert told.leaves > told.nodes > 0
    assert 0 < told.depth <= 8 + 1.3 * np.log2(len(KNOT.faces))
    assert 0 < told.sah_cost < len(KNOT.faces)


def test_doubles_are_kept():
    choice = rw.accelerators.KdTree()
    mesh = rw.Mesh(KNOT.vertices.astype(float) + 1e-9, KNOT.faces)
    scene, brute = (rw.Scene(mesh, accelerator=a, precision="double") for a in (choice, rw.BruteForce()))
    assert scene.intersect(*rays()) == brute.intersect(*rays())
    assert scene.accelerator_info.kind.endswith("double")


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (
            lambda: rw.accelerators.KdTree("best"),
            ValueError,
            r"builder must be one of 'sah', 'median', 'middle', 'cycle', got 'best'",
        ),
        (
            lambda: rw.accelerators.KdTree(traversal="ropes"),
            ValueError,
            r"traversal must be one of 'stack', 'restart', got",
        ),
        (
            lambda: rw.accelerators.KdTree(empty_bonus=1.5),
            ValueError,
            r"empty_bonus must be between 0 and 1, got 1.5",
        ),
        (
            lambda: rw.accelerators.KdTree(traversal_cost=0),
            ValueError,
            r"traversal_cost must be greater than 0, got 0",
        ),
        (
            lambda: rw.accelerators.KdTree(max_depth=61),
            ValueError,
            r"max_depth must be between 0 and 60, got 61",
        ),
        (lambda: rw.accelerators.KdTree(leaf_size=0), ValueError, r"leaf_size must be at least 1, got 0"),
        (
            lambda: rw.accelerators.Octree(max_depth=19),
            ValueError,
            r"max_depth must be between 0 and 18, got 19",
        ),
        (lambda: rw.accelerators.Octree(leaf_size=1.5), TypeError, r"leaf_size must be an integer, got 1.5"),
        (
            lambda: rw.accelerators.BSP(candidates=0),
            ValueError,
            r"candidates must be between 1 and 1024, got 0",
        ),
        (
            lambda: rw.accelerators.BSP(intersection_cost=-1),
            ValueError,
            r"intersection_cost must be greater than 0, got -1",
        ),
        (
            lambda: rw.Scene(KNOT, accelerator=rw.accelerators.BSP(traversal_cost=1e-300)).intersect(
                (0, 0, 0), (0, 0, 1)
            ),
            ValueError,
            r"traversal_cost is 0 in single precision, expected a finite number greater than 0",
        ),
    ],
)
def test_bad_options_are_refused_in_one_line(call, error, message):
    with pytest.raises(error, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)
