"""The boxes of trees, as arrays and drawn."""

import numpy as np
import pytest

import raywright as rw

TREES = [
    rw.BVH(),
    rw.BVH(traversal="stack"),
    rw.BVH(traversal="threaded"),
    rw.BVH(builder="spatial"),
    rw.accelerators.KdTree(),
    rw.accelerators.Octree(),
]


@pytest.fixture(scope="module")
def knot():
    return rw.scenes.torus_knot()


@pytest.mark.parametrize("accelerator", TREES, ids=repr)
def test_boxes_are_the_trees(knot, accelerator):
    scene = rw.Scene(knot, accelerator=accelerator)
    tree, info = scene.tree_boxes(), scene.accelerator_info
    assert len(tree) == info.nodes + info.leaves
    assert tree.leaf.sum() == info.leaves
    assert tree.depth[-1] == info.depth
    assert np.all(np.diff(tree.depth) >= 0)
    assert np.count_nonzero(tree.depth == 0) == 1
    # Boxes are rounded to float32 in units of about half the scene's size.
    assert tree.lower[0] == pytest.approx(scene.bounds[0], abs=1e-6)
    assert tree.upper[0] == pytest.approx(scene.bounds[1], abs=1e-6)
    assert np.all(tree.lower >= tree.lower[0])
    assert np.all(tree.upper <= tree.upper[0])
    assert tree.primitives[tree.leaf].sum() >= len(knot.faces)
    below = tree.at(3)
    assert len(below) == np.count_nonzero(tree.depth == 3)
    assert np.all(below.depth == 3)


@pytest.mark.parametrize("accelerator", [rw.accelerators.KdTree(), rw.accelerators.Octree()], ids=repr)
def test_cells_of_space_part_the_whole(knot, accelerator):
    tree = rw.Scene(knot, accelerator=accelerator).tree_boxes()
    volume = np.prod(tree.upper - tree.lower, axis=1)
    # For thousands of cells, each side rounded by 1e-7 of the whole.
    assert volume[tree.leaf].sum() == pytest.approx(volume[0], rel=1e-4)


def test_each_face_is_in_a_leaf(knot):
    tree = rw.Scene(knot, accelerator=rw.BVH(traversal="stack")).tree_boxes()
    lower, upper = tree.lower[tree.leaf] - 1e-6, tree.upper[tree.leaf] + 1e-6
    for corners in np.asarray(knot.vertices)[np.asarray(knot.faces)[::997]]:
        assert np.any(np.all((corners.min(axis=0) >= lower) & (corners.max(axis=0) <= upper), axis=1))


def test_turned_boxes_are_told_by_their_corners():
    # Thin needles along a diagonal: the default tree rotates its boxes to them.
    rng = np.random.default_rng(1)
    way, aside = np.array([1.0, 1, 1]) / np.sqrt(3), np.array([1.0, -1, 0]) / np.sqrt(2)
    starts = rng.uniform(-1, 1, (2000, 3))
    corners = np.stack([starts, starts + way, starts + 0.01 * aside], axis=1)
    scene = rw.Scene(rw.Mesh(corners.reshape(-1, 3), np.arange(6000).reshape(-1, 3)))
    assert "turned" in scene.accelerator_info.kind
    tree = scene.tree_boxes()
    root = tree.corners[0]
    sides = root[[1, 2, 4]] - root[0]
    along = sides @ sides.T
    assert np.abs(along - np.diag(np.diag(along))).max() < 1e-6
    # No axis of the boxes is one of the scene's, and the root box contains everything.
    assert np.abs(sides / np.linalg.norm(sides, axis=1)[:, None]).max() < 0.99
    inside = (corners.reshape(-1, 3) - root[0]) @ (sides / np.diag(along)[:, None]).T
    assert inside.min() > -1e-6
    assert inside.max() < 1 + 1e-6


def test_meshes_and_other_shapes_have_a_tree_each(box):
    scene = rw.Scene([box, *(rw.Sphere((3, 0, 3 * i), 1) for i in range(40))])
    tree = scene.tree_boxes()
    assert np.count_nonzero(tree.depth == 0) == 2
    assert tree.primitives[tree.leaf].sum() == 12 + 40
    assert len(rw.Scene([]).tree_boxes()) == 0
    assert "0 boxes" in repr(rw.Scene([]).tree_boxes())


@pytest.mark.parametrize(
    "accelerator",
    [rw.accelerators.Grid(), rw.accelerators.NestedGrid(), rw.accelerators.BSP(), rw.BruteForce()],
    ids=repr,
)
def test_what_has_no_boxes_says_so(box, accelerator):
    with pytest.raises(ValueError, match=f"a {type(accelerator).__name__} has no tree of boxes"):
        rw.Scene(box, accelerator=accelerator).tree_boxes()


def test_trees_are_drawn(box, tmp_path):
    pytest.importorskip("matplotlib")
    scene = rw.Scene(box, accelerator=rw.accelerators.KdTree())
    tree = scene.tree_boxes()
    ax = rw.report.tree(scene, plane="xz", ax=tmp_path / "tree.png")
    assert (tmp_path / "tree.png").stat().st_size > 1000
    (lines,) = ax.collections
    assert len(lines.get_segments()) == 12 * len(tree)
    assert ax.get_xlabel() == "x"
    assert ax.get_ylabel() == "z"
    ax = rw.report.tree(scene, depth=1, leaves=True, ax=tmp_path / "leaves.svg")
    assert len(ax.collections[0].get_segments()) == 12 * np.count_nonzero(tree.leaf & (tree.depth <= 1))


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        ({"plane": "yx"}, ValueError, "plane"),
        ({"depth": -1}, ValueError, "depth"),
        ({"ax": "tree.txt"}, ValueError, r"\.txt"),
        ({"scene": "box"}, TypeError, "scene must be a Scene"),
    ],
)
def test_wrong_arguments_are_told_in_a_line(scene, arguments, error, says):
    with pytest.raises(error, match=says):
        rw.report.tree(**{"scene": scene, **arguments})
