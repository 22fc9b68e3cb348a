"""What rays take."""

import numpy as np
import pytest

import raywright as rw

KNOT = rw.scenes.torus_knot(along=60, around=8)


def test_brute_force_tests_everything():
    cost = rw.Scene(KNOT, accelerator=rw.BruteForce()).traversal_cost(
        *np.random.default_rng(1).normal(size=(2, 40, 3))
    )
    assert (cost.nodes == 0).all()
    assert (cost.primitives == len(KNOT.faces)).all()


def test_a_tree_tests_little():
    scene = rw.Scene(KNOT)
    rays = np.random.default_rng(2).normal(size=(2, 30, 40, 3))
    cost = scene.traversal_cost(*rays)
    assert cost.nodes.shape == cost.primitives.shape == (30, 40)
    assert cost.nodes.dtype == cost.primitives.dtype == np.int32
    hit = scene.intersect(*rays).hit
    assert hit.any()
    assert (cost.nodes[hit] >= 1).all()
    assert (cost.primitives[hit] >= 1).all()
    assert cost.nodes.max() <= scene.accelerator_info.nodes
    assert cost.primitives.mean() < len(KNOT.faces) / 10
    assert not cost.nodes.flags.writeable


def test_rays_that_are_not_finite_take_nothing(scene):
    cost = scene.traversal_cost([(np.nan, 0, 0), (0.3, 0.4, 5)], (0, 0, -1))
    assert cost.nodes[0] == cost.primitives[0] == 0
    assert cost.primitives[1] > 0


def test_costs_compare_by_content(scene):
    rays = ((0.3, 0.4, 5), (0, 0, -1))
    assert scene.traversal_cost(*rays) == scene.traversal_cost(*rays)
    assert scene.traversal_cost(*rays) != scene.traversal_cost((9, 9, 9), (0, 0, 1))
    with pytest.raises(AttributeError):
        scene.traversal_cost(*rays).nodes = None
