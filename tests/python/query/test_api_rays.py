"""Rays going in: shapes, types, copies, and what is refused."""

import threading

import numpy as np
import pytest

import raywright as rw
from raywright.query.rays import ray_arguments

DOWN = (0.0, 0.0, -1.0)


def same_memory(a, b):
    return a.ctypes.data == b.ctypes.data and a.size == b.size and a.dtype == b.dtype


@pytest.mark.parametrize(
    "dtypes", [(np.float32, np.float32), (np.float64, np.float64), (np.float32, np.float64)]
)
@pytest.mark.parametrize("shape", [(3,), (5, 3), (2, 4, 3), (1, 3)])
def test_contiguous_arrays_reach_the_core_without_a_copy(dtypes, shape):
    origins, directions = (np.ones(shape, dtype) for dtype in dtypes)
    far = np.ones(shape[:-1])
    for limit in (9.0, far):
        arguments = ray_arguments(origins, directions, 0.0, limit, None)
        assert same_memory(arguments[0], origins)
        assert same_memory(arguments[1], directions)
        assert arguments[2] == 0.0
        assert arguments[4:] == (shape[:-1], None, None)
    if far.ndim:
        assert same_memory(arguments[3], far)


def test_one_origin_stays_one_row():
    for far in (np.inf, np.full((4, 6), 2.0)):
        origins, directions, _, _, shape, *_ = ray_arguments((0, 0, 5), np.ones((4, 6, 3)), 0.0, far, None)
        assert shape == (4, 6)
        assert origins.size == 3
        assert directions.shape == (4, 6, 3)


@pytest.mark.parametrize(
    ("dtype", "passed"),
    [
        (np.int32, np.float64),
        (np.uint8, np.float64),
        (np.float16, np.float64),
        (np.longdouble, np.float64),
        (">f4", np.float32),
        (">f8", np.float64),
    ],
)
def test_other_real_types_are_converted(dtype, passed):
    rays = ray_arguments(np.array([(1, 2, 3)], dtype), np.array([(4, 5, 6)], dtype), 0, np.inf, None)
    for array, expected in zip(rays, [(1, 2, 3), (4, 5, 6)], strict=False):
        assert array.dtype == passed
        assert array.dtype.isnative
        assert np.array_equal(array, [expected])


@pytest.mark.parametrize(
    "view",
    [
        lambda a: np.asfortranarray(a),
        lambda a: np.repeat(a, 2, axis=0)[::2],
        lambda a: np.concatenate([a, a], axis=1)[:, :3],
        lambda a: a[::-1][::-1],
        lambda a: np.frombuffer(b"x" + a.tobytes(), np.float64, offset=1).reshape(a.shape),
    ],
    ids=["fortran", "strided", "columns", "reversed", "unaligned"],
)
def test_memory_layout_does_not_matter(scene, view):
    rng = np.random.default_rng(1)
    origins = rng.uniform((-1, -1, 3), (2, 2, 6), (50, 3))
    directions = np.broadcast_to(DOWN, (50, 3)).copy()
    expected = scene.intersect(origins, directions)
    assert 0 < expected.hit.sum() < 50
    assert scene.intersect(view(origins), view(directions)) == expected


@pytest.mark.parametrize(
    ("origins", "directions", "t_min", "t_max", "lead"),
    [
        ((3,), (3,), (), (), ()),
        ((3,), (7, 3), (), (), (7,)),
        ((4, 1, 3), (5, 3), (), (), (4, 5)),
        ((2, 3, 4, 3), (3,), (), (4,), (2, 3, 4)),
        ((3,), (3,), (), (6,), (6,)),
        ((3,), (3,), (2, 1), (3,), (2, 3)),
        ((0, 3), (3,), (), (), (0,)),
        ((1, 3), (0, 3), (), (), (0,)),
        ((3,), (3,), (), (0,), (0,)),
    ],
)
def test_results_have_the_broadcast_leading_shape(scene, origins, directions, t_min, t_max, lead):
    o = np.broadcast_to((0.5, 0.5, 5.0), origins)
    d = np.broadcast_to(DOWN, directions)
    hits = scene.intersect(o, d, np.zeros(t_min), np.full(t_max, 9.0))
    assert hits.shape == hits.t.shape == hits.hit.shape == hits.primitive_id.shape == lead
    assert hits.shape_id.shape == hits.instance_id.shape == lead
    assert hits.uv.shape == (*lead, 2)
    assert hits.position.shape == hits.normal.shape == (*lead, 3)
    assert (hits.t == 4).all()
    shadowed = scene.occluded(o, d, np.zeros(t_min), np.full(t_max, 9.0))
    assert shadowed.shape == lead
    assert shadowed.dtype == np.bool_
    assert shadowed.all()
    assert scene.count_hits(o, d, np.zeros(t_min), np.full(t_max, 9.0)).shape == lead
    assert scene.intersect_all(o, d, np.zeros(t_min), np.full(t_max, 9.0)).shape == lead
    assert scene.traversal_cost(o, d, np.zeros(t_min), np.full(t_max, 9.0)).nodes.shape == lead


def test_interval_is_closed_and_per_ray(scene):
    limits = np.array([3.5, np.nextafter(4.0, 0), 4.0, np.inf])
    assert np.array_equal(scene.occluded((0.5, 0.4, 5), DOWN, t_max=limits), [False, False, True, True])
    starts = np.array([0.0, 4.0, 4.5, 5.0, 5.5])
    assert np.array_equal(scene.intersect((0.5, 0.4, 5), DOWN, t_min=starts).t, [4, 4, 5, 5, np.inf])


def test_distance_counts_lengths_of_the_direction(scene):
    assert scene.intersect((0.5, 0.4, 5), (0, 0, -8)).t == 0.5


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("part", ["origins", "directions"])
def test_rays_that_are_not_finite_miss(scene, part, bad):
    rays = {"origins": np.full((4, 3), (0.5, 0.4, 5.0)), "directions": np.full((4, 3), DOWN)}
    rays[part][[0, 1, 2], [0, 1, 2]] = bad
    hits = scene.intersect(**rays)
    assert np.array_equal(hits.hit, [False, False, False, True])
    assert np.array_equal(hits.t, [np.inf, np.inf, np.inf, 4.0])
    assert np.array_equal(scene.occluded(**rays), hits.hit)


def test_zero_directions_miss(scene):
    assert not scene.intersect((0.5, 0.5, 0.5), (0, 0, 0)).hit
    assert not scene.occluded((0.5, 0.5, 0.5), (0.0, -0.0, 0))


@pytest.mark.parametrize("ask", ["intersect", "occluded", "intersect_all", "count_hits", "traversal_cost"])
@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (((0, 0), DOWN), ValueError, r"origins must have shape \(\.\.\., 3\), got \(2,\)"),
        ((5.0, DOWN), ValueError, r"origins must have shape \(\.\.\., 3\), got \(\)"),
        (
            ((0, 0, 0), np.zeros((3, 4))),
            ValueError,
            r"directions must have shape \(\.\.\., 3\), got \(3, 4\)",
        ),
        (
            ((0, 0, 0), [(1, 2, 3), (1, 2)]),
            ValueError,
            r"directions must be a rectangular array, got ragged list",
        ),
        (
            (np.zeros((2, 3)), np.zeros((5, 3))),
            ValueError,
            r"do not broadcast: origins \(2,\), directions \(5,\)",
        ),
        (((0, 0, 0), np.zeros((4, 3)), 0, np.ones(3)), ValueError, r"do not broadcast: .*t_max \(3,\)"),
        ((np.zeros(3, complex), DOWN), TypeError, r"origins must be real numbers, got dtype complex128"),
        (
            ((0, 0, 0), np.array(["a", "b", "c"])),
            TypeError,
            r"directions must be real numbers, got dtype <U1",
        ),
        (
            ((0, 0, 0), np.array([1, 2, None])),
            TypeError,
            r"directions must be real numbers, got dtype object",
        ),
        ((None, DOWN), TypeError, r"origins must be real numbers, got None"),
        (((True, False, True), DOWN), TypeError, r"origins must be real numbers, got tuple of dtype bool"),
        (((0, 0, 0), DOWN, np.nan), ValueError, r"t_min must not be NaN"),
        (((0, 0, 0), DOWN, 0, np.array([1, np.nan])), ValueError, r"t_max must not be NaN"),
        (((0, 0, 0), DOWN, "near"), TypeError, r"t_min must be real numbers, got 'near'"),
        (((0, 0, 0), DOWN, 0, 1, 0), ValueError, r"threads must be at least 1, got 0"),
        (((0, 0, 0), DOWN, 0, 1, 1.5), TypeError, r"threads must be an integer, got 1.5"),
        (
            (np.ma.array([(0.0, 0, 1), (0, 0, 2)], mask=[(False,) * 3, (True,) * 3]), DOWN),
            ValueError,
            r"origins must have no masked entries, got 3: fill them",
        ),
        (
            ((0, 0, 0), DOWN, 0, np.ma.array([1.0, 2], mask=[True, False])),
            ValueError,
            r"t_max must have no masked entries, got 1",
        ),
    ],
)
def test_bad_rays_are_refused_in_one_line(scene, ask, arguments, error, message):
    with pytest.raises(error, match=message) as caught:
        getattr(scene, ask)(*arguments)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("part", ["t_min", "t_max"])
@pytest.mark.parametrize("size", [1e300, np.inf])
def test_rays_asked_for_nothing_leave_their_neighbors_alone(part, size):
    # Sixty-four squares, one below the other, and rays straight down, from the first or the eighth.
    square = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    depth = np.arange(64)[:, None]
    vertices = (square - depth[..., None] * (0, 0, 1)).reshape(-1, 3)
    faces = (4 * depth + (0, 1, 2, 0, 2, 3)).reshape(-1, 3)
    directions = np.stack([np.linspace(0.001, 0.002, 64), np.full(64, 0.003), np.full(64, -1.0)], axis=-1)
    t_min, t_max = np.where(np.arange(64) % 16 < 8, 0.5, 7.5), np.full(64, np.inf)
    nothing = np.arange(64) % 16 == 8
    if part == "t_min":
        t_min[nothing] = size
    else:
        t_min[nothing], t_max[nothing] = -np.inf, -size
    hits = rw.Scene(rw.Mesh(vertices, faces)).intersect((0, 0, 1), directions, t_min, t_max)
    expected = np.where(np.arange(64) % 16 < 8, 1.0, 8.0)
    expected[nothing] = np.inf
    assert np.array_equal(hits.t, expected)


@pytest.mark.parametrize("shape", [(5000,), (70, 75), (3, 5, 401)])
@pytest.mark.parametrize(
    "dtypes", [(np.float32, np.float32), (np.float32, np.float64), (np.float64, np.float32)]
)
def test_each_ray_of_a_large_batch_gets_its_own_answer(shape, dtypes):
    scene = rw.Scene(rw.scenes.torus_knot(along=60, around=8))
    rng = np.random.default_rng(3)
    origins, directions = (rng.normal(size=(*shape, 3)).astype(dtype) for dtype in dtypes)
    t_max = rng.uniform(0.5, 3, shape)
    hits = scene.intersect(origins, directions, t_max=t_max)
    occluded = scene.occluded(origins, directions, t_max=t_max)
    found = [
        a.reshape(-1, *a.shape[len(shape) :]) for a in (hits.t, hits.shape_id, hits.primitive_id, hits.uv)
    ]
    rays = origins.reshape(-1, 3), directions.reshape(-1, 3), t_max.reshape(-1)
    assert hits.hit.any()
    for start in range(0, t_max.size, 7):
        some = slice(start, start + 7)
        few = scene.intersect(rays[0][some], rays[1][some], t_max=rays[2][some])
        for whole, part in zip(found, (few.t, few.shape_id, few.primitive_id, few.uv), strict=True):
            assert np.array_equal(whole[some], part)
        assert np.array_equal(occluded.reshape(-1)[some], few.hit)


@pytest.mark.parametrize("count", [256, 999, 5000, 40_001])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("one", ["origins", "directions", None])
def test_rays_that_go_much_the_same_way_keep_their_places(count, dtype, one):
    scene = rw.Scene(rw.scenes.torus_knot(along=60, around=8))
    # From points of a wavy floor, row by row, to a lamp; or from one point; or all in one direction.
    x, y = np.arange(count) % 173 / 86 - 1, np.arange(count) // 173 * 173 / count - 0.5
    floor = np.stack([2 * x, 2 * y, 0.2 * np.sin(9 * x) - 2], axis=-1)
    lamp = np.array([0.3, 0.2, 4.0])
    origins = (lamp if one == "origins" else floor).astype(dtype)
    directions = (floor - lamp if one == "origins" else lamp if one == "directions" else lamp - floor).astype(
        dtype
    )
    t_max = 0.5 + 0.5 * (np.arange(count) % 7)
    whole = scene.intersect(origins, directions, t_max=t_max)
    occluded = scene.occluded(origins, directions, t_max=t_max)
    assert whole.hit.any()
    assert not whole.hit.all()
    assert np.array_equal(occluded, whole.hit)
    # Too few to be reordered.
    origins, directions = np.broadcast_arrays(origins, directions)
    for start in range(0, count, 200):
        some = slice(start, start + 200)
        few = scene.intersect(origins[some], directions[some], t_max=t_max[some])
        assert np.array_equal(whole.t[some], few.t)
        assert np.array_equal(whole.primitive_id[some], few.primitive_id)
        assert np.array_equal(whole.uv[some], few.uv)
        assert np.array_equal(whole.shape_id[some], few.shape_id)


# The last one would exhaust memory if that many threads started.
@pytest.mark.parametrize("threads", [1, 2, 5, 10**30])
def test_threads_do_not_change_the_answer(threads):
    scene = rw.Scene(rw.scenes.torus_knot(along=60, around=8))
    rng = np.random.default_rng(2)
    origins, directions = rng.normal(size=(2, 3000, 3))
    expected = scene.intersect(origins, directions)
    assert expected.hit.any()
    assert scene.intersect(origins, directions, threads=threads) == expected
    assert np.array_equal(scene.occluded(origins, directions, threads=threads), expected.hit)


def test_a_scene_may_be_asked_from_many_threads(box):
    scene, answers = rw.Scene(box), []
    origins = np.full((2000, 3), (0.5, 0.4, 5.0))
    workers = [
        threading.Thread(target=lambda: answers.append(scene.intersect(origins, DOWN))) for _ in range(8)
    ]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(answers) == 8
    assert all((answer.t == 4).all() for answer in answers)
    assert len({id(answer._compiled) for answer in answers}) == 1
