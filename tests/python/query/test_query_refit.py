"""Scenes whose vertices move."""

import pickle
import threading

import numpy as np
import pytest

import raywright as rw

KNOT = rw.scenes.torus_knot(along=80, around=10)


def bent(vertices, by):
    x, y, z = np.asarray(vertices, np.float64).T
    return np.stack([x + by * np.sin(2 * y), y - by * x * z, z * (1 + by)], axis=1)


def rays(count=4000, seed=1):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, 3)), rng.normal(size=(count, 3))


@pytest.mark.parametrize("accelerator", [rw.BVH(), rw.BruteForce()])
@pytest.mark.parametrize("precision", ["single", "double"])
def test_a_refitted_scene_answers_as_a_fresh_one(accelerator, precision):
    scene = rw.Scene(KNOT, accelerator=accelerator, precision=precision)
    before = scene.intersect(*rays())
    for by in (0.05, 0.4, -0.2):
        vertices = bent(KNOT.vertices, by)
        growth = scene.refit(vertices)
        assert 0.5 < growth < 3
        fresh = rw.Scene(
            rw.Mesh(vertices, KNOT.faces, KNOT.normals), accelerator=accelerator, precision=precision
        )
        assert scene == fresh
        hits = scene.intersect(*rays())
        assert hits == fresh.intersect(*rays())
        assert hits.hit.sum() > 300
        assert hits != before
        assert np.array_equal(hits.position, fresh.intersect(*rays()).position, equal_nan=True)
        assert np.array_equal(hits.normal, fresh.intersect(*rays()).normal, equal_nan=True)
        assert np.array_equal(scene.occluded(*rays()), hits.hit)
        assert scene.intersect_all(*rays()) == fresh.intersect_all(*rays())
        assert np.array_equal(scene.contains(rays()[0]), fresh.contains(rays()[0]))
        assert np.array_equal(scene.bounds, fresh.bounds)


def test_growth_tells_when_to_build_anew():
    scene = rw.Scene(KNOT)
    built = scene.accelerator_info.sah_cost
    assert scene.refit(KNOT.vertices) == pytest.approx(1, rel=1e-6)
    assert scene.accelerator_info.kind.endswith("refitted")
    # Exchanged vertices leave no order in the tree.
    shuffled = np.random.default_rng(2).permutation(KNOT.vertices)
    growth = scene.refit(shuffled)
    assert growth > 2
    assert growth == scene.accelerator_info.sah_cost / built
    hits = scene.intersect(*rays())
    assert scene.rebuild() is None
    assert not scene.accelerator_info.kind.endswith("refitted")
    assert scene.accelerator_info.sah_cost < growth * built
    assert scene.intersect(*rays()) == hits
    assert scene.refit(shuffled) == pytest.approx(1, rel=1e-6)


def test_hits_from_before_stay_as_they_were(scene, box):
    hits = scene.intersect((0.3, 0.4, 5), (0, 0, -1))
    every = scene.intersect_all((0.3, 0.4, 5), (0, 0, -1))
    scene.refit(box.vertices + np.array([0, 0, 2]))
    assert np.allclose(hits.position, (0.3, 0.4, 1), atol=1e-15)
    assert np.array_equal(every.position[:, 2], (1, 0))
    assert scene.intersect((0.3, 0.4, 5), (0, 0, -1)).t == 2


def test_all_but_the_vertices_stays(box):
    normals = np.tile((0.0, 0, 1), (8, 1))
    mesh = rw.Mesh(box.vertices, box.faces, normals, np.zeros((8, 2)), rw.Diffuse(0.25), 3.0)
    scene = rw.Scene([mesh, box], rw.PointLight((0, 0, 9), 1), 0.5, rw.BVH(bins=4), "double", "low")
    scene.bounds  # noqa: B018 (compiles it)
    scene.refit([box.vertices * 2, None])
    expected = rw.Mesh(box.vertices * 2, box.faces, normals, np.zeros((8, 2)), rw.Diffuse(0.25), 3.0)
    assert scene.shapes == (expected, box)
    assert scene.shapes[1] is box
    assert scene == rw.Scene([expected, box], scene.lights, 0.5, rw.BVH(bins=4), "double", "low")
    assert hash(scene) == hash(pickle.loads(pickle.dumps(scene)))
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert mesh.vertices is not scene.shapes[0].vertices
    assert np.array_equal(mesh.vertices, box.vertices)


def test_lights_move_with_their_meshes():
    floor = rw.Mesh([[-4, 0, 4], [4, 0, 4], [4, 0, -4], [-4, 0, -4]], [[0, 1, 2], [0, 2, 3]])
    lamp = rw.Mesh([[-1, 4, -1], [1, 4, -1], [1, 4, 1], [-1, 4, 1]], [[0, 1, 2], [0, 2, 3]], emission=12.0)
    camera = rw.Camera((0, 2.5, 7), (0, 1, 0), width=16, height=12)
    scene = rw.Scene([floor, lamp])
    dark = rw.render(scene, camera, samples=4, progress=False)
    scene.refit([None, lamp.vertices * (1, 0.5, 1)])
    moved = rw.render(scene, camera, samples=4, progress=False)
    fresh = rw.Scene([floor, rw.Mesh(lamp.vertices * (1, 0.5, 1), lamp.faces, emission=12.0)])
    assert np.array_equal(moved.rgb, rw.render(fresh, camera, samples=4, progress=False).rgb)
    assert not np.array_equal(moved.rgb, dark.rgb)


def test_a_scene_that_was_not_asked_yet_is_built_where_it_is(box):
    scene = rw.Scene(box)
    assert scene.refit(box.vertices + 5) == 1
    assert not scene.accelerator_info.kind.endswith("refitted")
    assert scene.intersect((5.3, 5.4, 9), (0, 0, -1)).t == 3


def test_what_cannot_be_refitted_is_built_anew(box):
    scene = rw.Scene(box, precision="double")
    scene.intersect((0, 0, 0), (0, 0, 1))
    # Corners beyond f32 need other leaves.
    assert scene.refit(box.vertices / 3) == 1
    assert not scene.accelerator_info.kind.endswith("refitted")
    assert scene.intersect((0.1, 0.1, 5), (0, 0, -1)).position[2] == 1 / 3
    broken = box.vertices.copy()
    broken[7] = np.nan
    with pytest.warns(RuntimeWarning, match=r"6 of 12 faces were dropped"):
        assert scene.refit(broken) == 1
    assert scene.accelerator_info.primitives == 6
    assert scene.intersect((0.3, 0.4, 5), (0, 0, -1)).t == 5
    assert scene.refit(box.vertices) == 1
    assert scene.intersect((0.3, 0.4, 5), (0, 0, -1)).t == 4


@pytest.mark.parametrize(
    ("shapes", "vertices", "error", "message"),
    [
        (1, np.zeros((7, 3)), ValueError, r"vertices must have shape \(8, 3\), got \(7, 3\)"),
        (1, np.zeros((8, 2)), ValueError, r"vertices must have shape \(8, 3\), got \(8, 2\)"),
        (1, None, TypeError, r"vertices must be real numbers, got None"),
        (1, np.zeros((8, 3), complex), TypeError, r"vertices must be real numbers, got dtype complex128"),
        (1, [np.zeros((7, 3))], ValueError, r"vertices\[0\] must have shape \(8, 3\), got \(7, 3\)"),
        (2, np.zeros((8, 3)), ValueError, r"vertices must be a list of 2 arrays, got an array"),
        (2, [np.zeros((8, 3))] * 3, ValueError, r"vertices must be a list of 2 arrays, got 3"),
        (2, [None, np.zeros((9, 3))], ValueError, r"vertices\[1\] must have shape \(8, 3\), got \(9, 3\)"),
        (2, [None, "far"], TypeError, r"vertices\[1\] must be real numbers, got 'far'"),
    ],
)
def test_bad_vertices_are_refused_in_one_line_and_change_nothing(box, shapes, vertices, error, message):
    scene = rw.Scene([box] * shapes)
    with pytest.raises(error, match=message) as caught:
        scene.refit(vertices)
    assert "\n" not in str(caught.value)
    assert scene.shapes == (box,) * shapes


def test_a_mesh_may_be_given_in_a_list_or_alone(box):
    moved = box.vertices + 1
    for vertices, kept in ((moved, moved), ([moved], moved), (moved.tolist(), moved), ([None], box.vertices)):
        scene = rw.Scene(box)
        scene.refit(vertices)
        assert np.array_equal(scene.shapes[0].vertices, kept)
    assert rw.Scene([]).refit([]) == 1


def test_rays_may_be_asked_while_vertices_move(box):
    scene, answers, stop = rw.Scene(box), [], threading.Event()
    origins = np.full((2000, 3), (0.3, 0.4, 9.0))

    def ask():
        while not stop.is_set():
            answers.append(scene.intersect(origins, (0, 0, -1)).t)

    workers = [threading.Thread(target=ask) for _ in range(3)]
    for worker in workers:
        worker.start()
    for step in range(60):
        scene.refit(box.vertices + np.array([0, 0, step % 4]))
        if step % 7 == 0:
            scene.rebuild()
    stop.set()
    for worker in workers:
        worker.join()
    # Each batch saw one of the four places.
    assert all((t == t[0]).all() and np.isclose(t[0], (8, 7, 6, 5), rtol=1e-15).any() for t in answers)
