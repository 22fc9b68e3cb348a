"""Every hit of a ray: against exact arithmetic, and against the closest hit."""

import copy
import pickle
import signal
import sys
import threading
import time
from fractions import Fraction

import exact_hits
import numpy as np
import pytest
import trimesh

import raywright as rw

KNOT = rw.scenes.torus_knot(along=60, around=8)


def grid_sphere():
    """A closed mesh of small integers: a ball's shell of cubes, with edges and vertices on grid lines."""
    solid = np.zeros((7, 7, 7), bool)
    center = np.indices((5, 5, 5)) - 2
    solid[1:6, 1:6, 1:6] = (center**2).sum(axis=0) <= 5
    corners, faces = [], []
    for axis in range(3):
        for step, quad in ((1, ((0, 0), (1, 0), (1, 1), (0, 1))), (-1, ((0, 0), (0, 1), (1, 1), (1, 0)))):
            for cell in np.argwhere(solid & ~np.roll(solid, -step, axis)):
                base = cell.copy()
                base[axis] += step > 0
                start = len(corners)
                for u, v in quad:
                    corner = base.copy()
                    corner[(axis + 1) % 3] += u
                    corner[(axis + 2) % 3] += v
                    corners.append(corner)
                faces += [(start, start + 1, start + 2), (start, start + 2, start + 3)]
    return rw.Mesh(np.array(corners, np.float64), faces), solid


def integer_icosphere():
    ball = trimesh.creation.icosphere(subdivisions=1)
    return rw.Mesh(np.round(ball.vertices * 64), ball.faces)


def lattice_rays(rng, count, low, high, step=2):
    """Rays between lattice points, so that many go through edges and vertices."""
    origins = rng.integers(low, high + 1, (count, 3)).astype(np.float64)
    targets = rng.integers(low * step, high * step + 1, (count, 3)) / step
    directions = targets - origins
    return origins, np.where(directions.any(axis=1, keepdims=True), directions, (1.0, 0, 0))


def row(hits, i):
    return slice(*hits.ray_splits[i : i + 2])


def check(mesh, origins, directions, t_min=0.0, t_max=np.inf):
    """Hold all hits against the oracle; give how many points are shared by several faces."""
    scene = rw.Scene(mesh)
    hits = scene.intersect_all(origins, directions, t_min, t_max)
    assert hits == rw.Scene(mesh, accelerator=rw.BruteForce()).intersect_all(
        origins, directions, t_min, t_max
    )
    assert np.array_equal(hits.count, scene.count_hits(origins, directions, t_min, t_max))
    triangles, shared = exact_hits.rounded(mesh, "double"), 0
    for i, found in enumerate(exact_hits.candidates(triangles, origins, directions)):
        t, primitive, uv = (array[row(hits, i)] for array in (hits.t, hits.primitive_id, hits.uv))
        assert list(zip(t, primitive, strict=True)) == sorted(zip(t, primitive, strict=True))
        known = {c.primitive: c for c in found if t_min <= c.nearest <= t_max}
        for one, its_t, its_uv in zip(primitive, t, uv, strict=True):
            candidate = known[one]
            assert its_t == candidate.nearest
            for computed, wanted in zip(its_uv, candidate.uv, strict=True):
                assert abs(Fraction(float(computed)) - wanted) <= candidate.uv_slack
        points = {}
        for candidate in known.values():
            points.setdefault(candidate.t, []).append(candidate)
        for there in points.values():
            told = {c.primitive: np.count_nonzero(primitive == c.primitive) for c in there}
            on_edges = [c for c in there if min(*c.uv, 1 - sum(c.uv)) == 0]
            assert all(told.pop(c.primitive) == 1 for c in there if c not in on_edges)
            # Surfaces crossed, or else twice the surfaces touched.
            expected = crossed(triangles, on_edges, origins[i], directions[i]) or 2
            assert sum(told.values()) == (expected if on_edges else 0)
            shared += len(on_edges) > 1
    return shared


def crossed(triangles, on_edges, origin, direction):
    """How many triangles of those that a ray meets on an edge it crosses when it is moved a little."""
    count = 0
    # A perturbation of the line, infinitesimal along y and again along z: any direction is right for closed
    # surfaces, but if faces are edge-on, the crossed edges depend on it.
    shift = [Fraction(1, 2**100), Fraction(1, 2**200), Fraction(1, 2**300)]
    start = [Fraction(x) + s for x, s in zip(origin.tolist(), shift, strict=True)]
    way = [Fraction(x) for x in direction.tolist()]
    for candidate in on_edges:
        corners = [[Fraction(x) for x in p] for p in triangles[candidate.primitive].tolist()]
        a, b, c = (exact_hits.minus(p, start) for p in corners)
        cross, dot = exact_hits.cross, exact_hits.dot
        signs = {x > 0 for x in (dot(way, cross(b, c)), dot(way, cross(c, a)), dot(way, cross(a, b)))}
        count += len(signs) == 1
    return count


def test_all_hits_of_lattice_rays_are_those_of_exact_arithmetic():
    mesh, _ = grid_sphere()
    shared = check(mesh, *lattice_rays(np.random.default_rng(1), 400, 0, 7))
    assert shared > 200


def test_all_hits_of_a_ball_of_integers_are_those_of_exact_arithmetic():
    mesh = integer_icosphere()
    rng = np.random.default_rng(2)
    origins = np.concatenate([rng.integers(-90, 91, (150, 3)), rng.integers(-20, 21, (150, 3))]).astype(float)
    vertices = mesh.vertices[mesh.faces[rng.integers(0, len(mesh.faces), 300)]]
    targets = np.where(rng.random((300, 1)) < 0.5, vertices[:, 0], vertices[:, :2].mean(axis=1))
    assert check(mesh, origins, targets - origins) > 250


def test_an_interval_cuts_all_hits_at_both_ends():
    mesh, _ = grid_sphere()
    rays = lattice_rays(np.random.default_rng(3), 150, 0, 7)
    assert check(mesh, *rays, 0.25, 1.0) > 20


@pytest.mark.parametrize("accelerator", [rw.BVH(), rw.BruteForce()])
def test_a_closed_surface_is_crossed_evenly_from_outside_and_oddly_from_inside(accelerator):
    mesh, solid = grid_sphere()
    scene = rw.Scene(mesh, accelerator=accelerator)
    rng = np.random.default_rng(4)
    cells = rng.integers(0, 7, (20_000, 3))
    _, directions = lattice_rays(rng, 20_000, -3, 3)
    counts = scene.count_hits(cells + 0.5, directions)
    assert np.array_equal(counts % 2 == 1, solid[tuple(cells.T)])
    assert solid[tuple(cells.T)].sum() > 3000


def test_an_edge_is_crossed_once_and_what_is_touched_told_twice(triangle):
    quad = rw.Scene(rw.Mesh([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)], [(0, 1, 2), (0, 2, 3)]))
    assert quad.count_hits((1, 1, 1), (0, 0, -1)) == 1
    roof = rw.Scene(rw.Mesh([(0, 0, 1), (2, 0, 1), (1, 3, 0), (1, -3, 0)], [(0, 1, 2), (1, 0, 3)]))
    assert roof.count_hits((1, -5, 1), (0, 1, 0)) == 2
    # Slightly along x, or along y where x does not matter, is the surface or its end.
    counts = rw.Scene(triangle).count_hits([(0.5, 0, 1), (0, 0.5, 1), (0.5, 0.5, 1), (0, 0, 1)], (0, 0, -1))
    assert np.array_equal(counts, [1, 1, 2, 1])
    hits = rw.Scene(triangle).intersect_all((0.5, 0.5, 1), (0, 0, -1))
    assert np.array_equal(hits.t, [1, 1])
    assert np.array_equal(hits.uv, [(0.5, 0.5)] * 2)


def test_faces_upon_each_other_are_all_told(triangle):
    twice = rw.Scene([triangle, rw.Mesh(triangle.vertices, [(0, 1, 2), (2, 1, 0)])])
    hits = twice.intersect_all((0.2, 0.3, 1), (0, 0, -1))
    assert np.array_equal(hits.shape_id, [0, 1, 1])
    assert np.array_equal(hits.primitive_id, [0, 0, 1])
    assert np.array_equal(hits.t, [1, 1, 1])


@pytest.fixture(scope="module")
def knot_rays():
    rng = np.random.default_rng(5)
    vertices = KNOT.vertices[rng.integers(0, len(KNOT.vertices), (40, 50))]
    origins = rng.normal(size=(40, 50, 3))
    return origins, np.where(rng.random((40, 50, 1)) < 0.5, vertices - origins, rng.normal(size=(40, 50, 3)))


def test_the_first_of_all_hits_is_the_closest_bit_for_bit(knot_rays):
    scene = rw.Scene(KNOT)
    closest, every = scene.intersect(*knot_rays), scene.intersect_all(*knot_rays)
    assert np.array_equal(every.count > 0, closest.hit)
    assert closest.hit.sum() > 1000
    first = every.ray_splits[:-1].reshape(closest.shape)[closest.hit]
    for name in ("t", "shape_id", "primitive_id", "uv", "position", "normal"):
        assert np.array_equal(getattr(every, name)[first], getattr(closest, name)[closest.hit])


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_neither_threads_nor_batches_nor_tiles_change_all_hits(knot_rays, threads):
    scene = rw.Scene(KNOT)
    origins, directions = (x.reshape(-1, 3) for x in knot_rays)
    expected = scene.intersect_all(origins, directions)
    assert expected.t.size > 3000
    image = scene.intersect_all(*knot_rays, threads=threads)
    assert image.shape == (40, 50)
    for name in ("ray_splits", "t", "primitive_id", "uv", "ray"):
        assert np.array_equal(getattr(image, name), getattr(expected, name))
    assert np.array_equal(scene.count_hits(*knot_rays, threads=threads), expected.count.reshape(40, 50))
    for i in (0, 7, 1999):
        alone = scene.intersect_all(origins[i], directions[i], threads=threads)
        assert np.array_equal(alone.t, expected.t[row(expected, i)])
        assert np.array_equal(alone.primitive_id, expected.primitive_id[row(expected, i)])


def test_all_hits_know_their_rays(scene):
    origins = np.array([[(0.3, 0.4, 5), (9, 9, 9)], [(0.3, 0.4, 0.5), (0.6, 0.2, -1)]])
    directions = np.array([[(0, 0, -1.0), (0, 0, 1)], [(0, 0, 2), (0, 0, 0.5)]])
    hits = scene.intersect_all(origins, directions)
    assert len(hits) == 2
    assert hits.t.size == 5
    assert hits.shape == (2, 2)
    assert np.array_equal(hits.ray_splits, [0, 2, 2, 3, 5])
    assert np.array_equal(hits.ray, [0, 0, 2, 3, 3])
    assert np.array_equal(hits.count, [[2, 0], [1, 2]])
    assert np.array_equal(hits.t, [4, 5, 0.25, 2, 4])
    expected = origins.reshape(-1, 3)[hits.ray] + hits.t[:, None] * directions.reshape(-1, 3)[hits.ray]
    assert np.allclose(hits.position, expected, rtol=0, atol=1e-15)
    assert np.array_equal(hits.normal[:, 2], [1, -1, 1, -1, 1])
    assert np.array_equal(hits.instance_id, np.full(5, -1))
    assert repr(hits) == "AllHits(shape=(2, 2), 5 hits of 4 rays)"
    types = {"ray_splits": "i8", "ray": "i8", "t": "f8", "shape_id": "i4", "primitive_id": "i4", "uv": "f8"}
    for name, dtype in {**types, "count": "i8", "position": "f8", "normal": "f8"}.items():
        assert getattr(hits, name).dtype == dtype
        assert getattr(hits, name).flags.writeable == (dtype == "f8")
        assert getattr(hits, name) is getattr(hits, name)
    with pytest.raises(AttributeError):
        hits.t = None


def test_no_rays_have_no_hits(scene):
    hits = scene.intersect_all(np.zeros((0, 4, 3)), (0, 0, 1.0))
    assert (len(hits), hits.shape) == (0, (0, 4))
    assert np.array_equal(hits.ray_splits, [0])
    assert hits.position.shape == (0, 3)
    nothing = rw.Scene([]).intersect_all(np.zeros((3, 3)), (0, 0, 1.0))
    assert np.array_equal(nothing.ray_splits, [0, 0, 0, 0])


def test_rays_that_are_not_finite_have_no_hits(scene):
    origins = np.array([(0.3, 0.4, 5), (np.nan, 0, 0), (0, np.inf, 0)])
    assert np.array_equal(scene.count_hits(origins, (0, 0, -1)), [2, 0, 0])
    assert np.array_equal(scene.count_hits((0.3, 0.4, 5), [(0, 0, 0), (0, 0, -np.inf)]), [0, 0])


@pytest.mark.parametrize(
    "again", [lambda h: pickle.loads(pickle.dumps(h)), copy.deepcopy], ids=["pickle", "copy"]
)
def test_pickled_hits_keep_all_they_knew(scene, again):
    hits = scene.intersect_all([[(0.3, 0.4, 5.0)], [(0.6, 0.2, -1)]], (0, 0, -1.0))
    assert np.isfinite([hits.position, hits.normal]).all()  # a pickle keeps what was asked for
    back = again(hits)
    assert back == hits
    assert back.shape == (2, 1)
    assert np.array_equal(back.position, hits.position)
    assert np.array_equal(back.normal, hits.normal)
    assert back.t.flags.writeable
    assert not back.primitive_id.flags.writeable


def test_equality_is_by_content(scene):
    rays = ((0.5, 0.4, 5), (0, 0, -1))
    assert scene.intersect_all(*rays) == scene.intersect_all(*rays)
    assert scene.intersect_all(*rays) != scene.intersect_all([rays[0]], rays[1])
    assert scene.intersect_all(*rays) != scene.intersect_all((0.5, 0.4, 6), rays[1])
    assert scene.intersect_all(*rays) != scene.intersect(*rays)


@pytest.mark.skipif(sys.platform == "win32", reason="signals differ there")
@pytest.mark.parametrize("ask", ["intersect_all", "count_hits"])
def test_ctrl_c_ends_a_query_at_once(ask):
    rng = np.random.default_rng(6)
    soup = rw.Mesh(rng.normal(size=(30_000, 3)), np.arange(30_000).reshape(-1, 3))
    scene = rw.Scene(soup, accelerator=rw.BruteForce())
    origins, directions = rng.normal(size=(2, 1_000_000, 3))
    scene.intersect(origins[:10], directions[:10])
    timer = threading.Timer(0.3, signal.raise_signal, (signal.SIGINT,))
    start = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        getattr(scene, ask)(origins, directions)
    assert time.monotonic() - start < 2.0
