"""Scenes that are sent to other processes, which compile each once."""

import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np

import raywright as rw
from raywright import _core


def same_core(scenes):
    return len({id(scene._compiled()) for scene in scenes}) == 1


def test_what_comes_out_of_pickles_is_compiled_once(box):
    data = pickle.dumps(rw.Scene([box, rw.Sphere()]))
    one, two = pickle.loads(data), pickle.loads(data)
    assert one is not two
    assert same_core([one, two])
    # A different scene is not shared, and an equal one is.
    other = pickle.loads(pickle.dumps(rw.Scene([box, rw.Sphere(radius=2)])))
    assert not same_core([one, other])
    assert same_core([one, pickle.loads(pickle.dumps(rw.Scene([box, rw.Sphere()])))])


def test_one_may_move_without_the_other(box):
    data = pickle.dumps(rw.Scene(box))
    one, two = pickle.loads(data), pickle.loads(data)
    ray = (0.5, 0.4, 5.0), (0, 0, -1.0)
    assert same_core([one, two])
    one.refit(box.vertices + np.array([0, 0, 2]))
    assert (one.intersect(*ray).t, two.intersect(*ray).t) == (2, 4)
    moved = pickle.loads(pickle.dumps(one))
    assert moved.intersect(*ray).t == 2
    two.rebuild()
    assert not same_core([two, pickle.loads(data)])


def test_who_watches_is_told_that_it_is_done(box):
    data = pickle.dumps(rw.Scene(box))
    pickle.loads(data).build()
    told = []
    pickle.loads(data).build(progress=told.append)
    assert told == [1.0]


def ask(task):
    scene, origins = task
    hits = scene.intersect(origins, (0, 0, -1.0))
    # An id of the compiled scene, unique while this process keeps it.
    return id(scene._core), hits


def test_a_pool_compiles_a_scene_once_in_each_process(box):
    """Tasks bring the scene along; all that a process is given meet the same compiled one."""
    scene = rw.Scene(box)
    rng = np.random.default_rng(1)
    parts = [np.concatenate([rng.random((50, 2)), np.full((50, 1), 5.0)], axis=1) for _ in range(6)]
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        answers = list(pool.map(ask, [(scene, part) for part in parts]))
    assert len({core for core, _ in answers}) == 1
    for part, (_, hits) in zip(parts, answers, strict=True):
        assert hits == scene.intersect(part, (0, 0, -1.0))
    assert isinstance(scene._core, _core.CompiledScene)
