"""Hits are those of exact arithmetic: which rays hit, what they hit, and where to within a proven bound."""

import itertools
import warnings

import numpy as np
import pytest
import trimesh
from exact_hits import check
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import raywright as rw

TYPES = [np.float32, np.float64]


def fixed(examples):
    """The same examples at every run."""
    slow = [HealthCheck.too_slow, HealthCheck.data_too_large]
    return settings(
        max_examples=examples, derandomize=True, deadline=None, database=None, suppress_health_check=slow
    )


def soup(rng, count, size=0.5, scale=1.0):
    """Triangles of about `size` in the cube from -1 to 1, times `scale`, no two sharing a vertex."""
    centers = rng.uniform(-1, 1, (count, 1, 3))
    corners = (centers + rng.uniform(-size, size, (count, 3, 3))) * scale
    return rw.Mesh(corners.reshape(-1, 3).astype(np.float32), np.arange(3 * count).reshape(-1, 3))


def corners_of(mesh):
    return mesh.vertices.astype(np.float32)[mesh.faces]


def points_on(rng, triangles, count):
    """A third each: vertices, points on edges, and centroids, of random triangles, in float64."""
    chosen = triangles[rng.integers(len(triangles), size=count)].astype(np.float64)
    a, b, c = (chosen[:, i] for i in range(3))
    along = rng.uniform(0, 1, (count, 1))
    kind = rng.integers(3, size=(count, 1))
    return np.where(kind == 0, a, np.where(kind == 1, a + (b - a) * along, (a + b + c) / 3))


def unit(rng, count):
    v = rng.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize(("count", "size"), [(8, 1.0), (60, 0.5), (400, 0.2)])
def test_random_rays_at_random_triangles(dtype, count, size):
    rng = np.random.default_rng(count)
    outcome = check(
        soup(rng, count, size),
        rng.uniform(-1.5, 1.5, (1000, 3)).astype(dtype),
        rng.normal(size=(1000, 3)).astype(dtype),
    )
    assert outcome.hits > 50


@pytest.mark.parametrize("dtype", TYPES)
def test_rays_aimed_at_vertices_edges_and_centroids(dtype):
    rng = np.random.default_rng(1)
    mesh = soup(rng, 80)
    origins = rng.uniform(-3, 3, (2000, 3)).astype(dtype)
    targets = points_on(rng, corners_of(mesh), 2000)
    outcome = check(mesh, origins, (targets - origins).astype(dtype))
    assert outcome.hits > 1000


@pytest.mark.parametrize("dtype", TYPES)
def test_rays_that_start_on_vertices_and_leave_along_edges(dtype):
    rng = np.random.default_rng(2)
    mesh = soup(rng, 80)
    a, b, c = np.moveaxis(corners_of(mesh).astype(np.float64), 1, 0)
    origins = np.concatenate([a, a, a - 2 * (b - a), a])
    ways = np.concatenate([b - a, rng.normal(size=a.shape), b - a, (b + c) / 2 - a])
    for t_min in (-10.0, 0.0, 5e-324):
        outcome = check(mesh, origins.astype(dtype), ways.astype(dtype), t_min=t_min)
        assert outcome.hits > 150


@pytest.mark.parametrize("dtype", TYPES)
def test_rays_along_the_axes(dtype):
    rng = np.random.default_rng(3)
    mesh = soup(rng, 100)
    targets = points_on(rng, corners_of(mesh), 600).astype(np.float32).astype(np.float64)
    for axis, sign, zeros in itertools.product(range(3), (1.0, -1.0), (0.0, -0.0)):
        way = np.full(3, zeros)
        way[axis] = sign
        # Moved back along the axis alone, so the line goes through the target without any error.
        origins = targets.copy()
        origins[:, axis] -= 4.0 * sign
        outcome = check(mesh, origins[axis::3].astype(dtype), way.astype(dtype))
        assert outcome.hits > 150


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("seed", range(4))
def test_small_integers_leave_nothing_to_rounding(dtype, seed):
    # Coordinates up to 3: many coplanar, edge-on, doubled and zero-area triangles, and many equal t.
    rng = np.random.default_rng(seed)
    mesh = rw.Mesh(rng.integers(-3, 4, (40, 3)).astype(np.float32), rng.integers(0, 40, (120, 3)))
    origins = rng.integers(-6, 7, (400, 3)).astype(dtype)
    directions = rng.integers(-2, 3, (400, 3)).astype(dtype)
    outcome = check(mesh, origins, directions)
    assert outcome.hits > 60
    assert outcome.choices > 60


def test_both_ends_of_the_interval_are_asked_for():
    rng = np.random.default_rng(5)
    mesh = rw.Mesh(rng.integers(-3, 4, (40, 3)).astype(np.float32), rng.integers(0, 40, (120, 3)))
    origins = rng.integers(-4, 5, (700, 3)).astype(np.float64)
    # Along the axes, and lengths of a power of two, many t are small dyadic numbers, and so are the ends.
    directions = np.eye(3)[rng.integers(3, size=700)] * rng.choice([-2.0, -1.0, 0.5, 1.0, 4.0], (700, 1))
    t_min = rng.integers(-8, 9, 700) / 2
    t_max = t_min + rng.integers(-1, 5, 700) / 2
    outcome = check(mesh, origins, directions, t_min, t_max)
    assert outcome.hits > 70
    whole = rw.Scene(mesh).intersect(origins, directions, -np.inf, np.inf)
    hit = whole.hit
    again = rw.Scene(mesh).intersect(origins[hit], directions[hit], whole.t[hit], whole.t[hit])
    assert np.array_equal(again.t, whole.t[hit])
    assert np.array_equal(again.primitive_id, whole.primitive_id[hit])


STRUCTURES = [
    rw.BVH(),
    rw.BVH(traversal="stack"),
    rw.accelerators.KdTree(),
    rw.accelerators.Grid(),
    rw.accelerators.Octree(),
    rw.accelerators.BSP(),
    rw.BruteForce(),
]


def repr_of(accelerator):
    return f"{type(accelerator).__name__}-{getattr(accelerator, 'traversal', '')}"


@pytest.mark.parametrize("accelerator", STRUCTURES, ids=repr_of)
@pytest.mark.parametrize("scale", [1.0, 0.3, 1e-7])
def test_a_hit_at_an_end_of_a_ray_counts(accelerator, scale):
    # Over a flat face at 1: t is exactly the height less 1.
    square = rw.Mesh([(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], [(0, 1, 2), (0, 2, 3)])
    scene = rw.Scene(square, accelerator=accelerator)
    heights = np.random.default_rng(0).integers(2**20, 2**27, 3000) / 2**20
    origins = np.c_[np.random.default_rng(1).uniform(0.01, 0.99, (3000, 2)), heights]
    way = (0, 0, -(2.0 ** round(np.log2(scale))))
    t = (heights - 1) / -way[2]
    for t_min, t_max, is_met in (
        (0, t, True),
        (t, np.inf, True),
        (t, t, True),
        (0, np.nextafter(t, 0), False),
        (np.nextafter(t, np.inf), np.inf, False),
    ):
        hits = scene.intersect(origins, way, t_min, t_max)
        assert np.array_equal(hits.t, t if is_met else np.full(3000, np.inf))
        assert (scene.occluded(origins, way, t_min, t_max) == is_met).all()
        # On the diagonal both faces are hit, and count once.
        assert (scene.count_hits(origins, way, t_min, t_max) == is_met).all()
        every = scene.intersect_all(origins, way, t_min, t_max)
        assert np.array_equal(every.t, t if is_met else [])
        assert (scene.intersect(origins, way, t_min, t_max, shapes=[True]).hit == is_met).all()


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("accelerator", STRUCTURES, ids=repr_of)
def test_what_a_ray_is_told_it_meets_it_meets_at_either_end(accelerator, precision):
    rng = np.random.default_rng(2)
    ball = trimesh.creation.icosphere(subdivisions=2)
    far = rng.choice([0.1, 3.0, 300.0, 1e5], (3000, 1))
    origins = rng.normal(size=(3000, 3)) * far
    ways = (rng.normal(size=(3000, 3)) * 0.5 - origins) * 10.0 ** rng.integers(-8, 8, (3000, 1))
    mesh = rw.Mesh(ball.vertices + np.array((0.1, 0.2, 0.3)), ball.faces)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = rw.Scene(mesh, accelerator=accelerator, precision=precision)
        hits = scene.intersect(origins, ways)
    origins, ways, t = origins[hits.hit], ways[hits.hit], hits.t[hits.hit]
    assert len(t) > 1000
    for t_min, t_max in ((0, t), (t, np.inf), (t, t)):
        again = scene.intersect(origins, ways, t_min, t_max)
        assert np.array_equal(again.t, t)
        assert np.array_equal(again.primitive_id, hits.primitive_id[hits.hit])
        assert scene.occluded(origins, ways, t_min, t_max).all()
    assert not scene.occluded(origins, ways, 0, np.nextafter(t, 0)).any()
    # From the next number on this hit is excluded, and the other side of the ball remains.
    beyond = scene.intersect(origins, ways, np.nextafter(t, np.inf), np.inf)
    assert (beyond.primitive_id != hits.primitive_id[hits.hit]).all()


@pytest.mark.parametrize("dtype", TYPES)
def test_hits_at_exactly_t_max_count_and_beyond_do_not(dtype):
    rng = np.random.default_rng(6)
    scene = rw.Scene(soup(rng, 300))
    origins = rng.uniform(-1.5, 1.5, (4000, 3)).astype(dtype)
    directions = rng.normal(size=(4000, 3)).astype(dtype)
    hits = scene.intersect(origins, directions)
    rays = origins[hits.hit], directions[hits.hit]
    t = hits.t[hits.hit]
    assert len(t) > 1000
    assert np.array_equal(scene.intersect(*rays, t, t).t, t)
    assert np.array_equal(scene.intersect(*rays, 0.0, t).t, t)
    assert scene.occluded(*rays, 0.0, t).all()
    # `t` is the least: just below it there is no hit.
    assert not scene.occluded(*rays, 0.0, np.nextafter(t, -np.inf)).any()
    assert not (scene.intersect(*rays, np.nextafter(t, np.inf)).t <= t).any()


def box(size):
    """A cube of small integer coordinates whose faces are grids of squares halved into triangles."""
    faces, vertices = [], []
    for axis, side in itertools.product(range(3), (0, size)):
        for i, j in itertools.product(range(size), repeat=2):
            square = []
            for x, y in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                corner = [x, y]
                corner.insert(axis, side)
                square.append(corner)
            faces += [[len(vertices) + k for k in f] for f in ((0, 1, 2), (0, 2, 3))]
            vertices += square
    return rw.Mesh(np.array(vertices, np.float32), np.array(faces))


@pytest.mark.parametrize("zero", [0.0, -0.0])
def test_rays_in_the_faces_and_along_the_edges_of_a_box(zero):
    # Coordinates are multiples of a half: in faces, on their edges, through corners, and on the diagonals.
    grid = np.array(list(itertools.product((-1.0, 0.0, 0.5, 1.0, 2.0), repeat=3)))
    ways = np.array([w for w in itertools.product((-1.0, zero, 1.0), repeat=3) if any(w)])
    origins, directions = np.repeat(grid, len(ways), axis=0), np.tile(ways, (len(grid), 1))
    outcome = check(box(2), origins, directions)
    assert outcome.hits > 1000
    assert outcome.choices > 1000


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("aspect", [1e3, 1e4, 1e6, 1e8])
def test_slivers(dtype, aspect):
    rng = np.random.default_rng(7)
    a = rng.uniform(-1, 1, (60, 3))
    along, across = unit(rng, 60), unit(rng, 60)
    across -= along * (across * along).sum(axis=1, keepdims=True)
    corners = np.stack([a, a + along, a + along / 2 + across / aspect], axis=1).astype(np.float32)
    mesh = rw.Mesh(corners.reshape(-1, 3), np.arange(180).reshape(-1, 3))
    origins = rng.uniform(-3, 3, (1500, 3)).astype(dtype)
    chosen = corners[rng.integers(60, size=1500)].astype(np.float64)
    weights = rng.dirichlet([0.5, 0.5, 0.5], 1500)
    # Some just outside.
    weights[::3] += rng.normal(size=(500, 3)) * 1e-3
    directions = (np.einsum("ni,nij->nj", weights, chosen) - origins).astype(dtype)
    outcome = check(mesh, origins, directions)
    # Rounded directions hit such thin triangles by chance; f64 is fine enough for all of them.
    assert outcome.hits > (500 if dtype == np.float64 else 30 if aspect < 1e5 else -1)


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("angle", [1e-2, 1e-4, 1e-6, 1e-7])
def test_grazing_rays(dtype, angle):
    rng = np.random.default_rng(8)
    mesh = soup(rng, 50)
    chosen = corners_of(mesh)[rng.integers(50, size=600)].astype(np.float64)
    targets = np.einsum("ni,nij->nj", rng.dirichlet([1, 1, 1], 600), chosen)
    normals = np.cross(chosen[:, 1] - chosen[:, 0], chosen[:, 2] - chosen[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    flat = np.cross(normals, unit(rng, 600))
    ways = flat / np.linalg.norm(flat, axis=1, keepdims=True) - angle * normals
    origins = (targets - 2 * ways).astype(dtype)
    outcome = check(mesh, origins, (targets - origins).astype(dtype))
    assert outcome.hits > 320


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("distance", [1e2, 1e4, 1e6, 1e7, 1e8])
@pytest.mark.parametrize("aimed_from", ["afar", "near"])
def test_far_origins(dtype, distance, aimed_from):
    rng = np.random.default_rng(9)
    mesh = soup(rng, 60)
    targets = points_on(rng, corners_of(mesh), 300)
    ways = unit(rng, 300).astype(dtype).astype(np.float64)
    origins = (targets - distance * ways).astype(dtype)
    if aimed_from == "afar":
        ways = targets - origins
    outcome = check(mesh, origins, ways.astype(dtype))
    # In f32 such far origins are rounded to steps of several scenes, unless the ray is aimed afterwards.
    if dtype == np.float64 or (aimed_from == "afar" and distance < 1e6):
        assert outcome.hits > 150


@pytest.mark.parametrize(
    "distance", [1e15, 1e30, 1e37, 1e38, 5e38, 1e40, 1e42, 1e44, 1e60, 1e100, 1e155, 1e300, 1.5e308]
)
def test_origins_as_far_as_numbers_go(distance):
    rng = np.random.default_rng(10)
    mesh = soup(rng, 61)
    # With a slope that matters over this distance: from a point on an axis to anywhere in the scene.
    targets = points_on(rng, corners_of(mesh), 150)
    origins = np.eye(3)[rng.integers(3, size=150)] * rng.choice([-distance, distance], (150, 1))
    ways = (targets - origins) / distance
    assert check(mesh, origins, ways).hits > (30 if distance < 1e300 else 0)
    ways = np.array([w for w in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(w)])
    # Along axes and diagonals through the origin a ray returns to the scene without rounding, at any
    # distance.
    outcome = check(mesh, -distance * ways, ways)
    near = check(mesh, -4.0 * ways, ways)
    assert outcome.hits == near.hits > 5


@pytest.mark.parametrize(
    ("dtype", "length"),
    [(np.float32, x) for x in (1e-44, 1e-38, 1e-30, 1e-10, 1e10, 1e30, 1e38)]
    + [(np.float64, x) for x in (1e-307, 1e-300, 1e-150, 1e-30, 1e30, 1e150, 1e300, 1e308)],
)
def test_directions_of_any_length(dtype, length):
    rng = np.random.default_rng(11)
    mesh = soup(rng, 60, scale=1e-3 if length < 1e-306 else 1.0)
    scale = np.abs(mesh.vertices).max()
    origins = (rng.uniform(-2, 2, (300, 3)) * scale).astype(dtype)
    ways = points_on(rng, corners_of(mesh), 300) - origins
    ways = (ways / np.abs(ways).max(axis=1, keepdims=True) * length).astype(dtype)
    outcome = check(mesh, origins, ways)
    assert outcome.hits > (5 if length < 1e-40 else 100)


def test_directions_at_the_end_of_the_range():
    # One step of 2⁻¹⁰²² and more along each axis or diagonal, in a scene so small that `t` fits an f64;
    # shorter ones are no directions. Starting in the faces and outside, on the grid of the box.
    small = rw.Mesh(box(2).vertices * np.float32(2.0**-60), box(2).faces)
    ways = np.array([w for w in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(w)]) * 2.0**-1022
    starts = np.array([(0.5, 0.5, -1), (0, 0, 0), (3, 2, 2), (1, 0, 1), (1.25, 2.5, 0.75)]) * 2.0**-60
    for steps in (1.0, 3.0, 2.0**40):
        # A component 2⁵² times smaller is subnormal, and still a slope.
        for slope in (0.0, 1.0, 2.0**-52):
            directions = ways * steps + slope * np.roll(ways, 1, axis=1)
            outcome = check(small, np.repeat(starts, 26, axis=0), np.tile(directions, (5, 1)))
            assert outcome.hits > 20
    assert not rw.Scene(small).occluded(starts[:, None], ways / 2).any()


# Around 1e-22 and 1e20 the products of coordinates exceed the range of f32.
SCALES = [1e-44, 1e-40, 1e-38, 1e-30, 1e-23, 1e-22, 1e-21, 1e-20, 1e-19, 1e-13, 1e-6]
SCALES += [1e6, 1e12, 1e13, 1e18, 2e19, 1e20, 1e21, 4e21, 2e22, 1e30, 1e38]


@pytest.mark.parametrize("scale", SCALES)
def test_coordinates_of_any_size(scale):
    rng = np.random.default_rng(12)
    mesh = soup(rng, 60, scale=scale)
    origins = rng.uniform(-2, 2, (500, 3)) * scale
    ways = points_on(rng, corners_of(mesh), 500) - origins
    # Most rays nearly along an axis, so that huge coordinates meet small parts of the direction.
    squeezed = np.eye(3)[rng.integers(3, size=500)] + rng.choice([1.0, 1e-3, 1e-6], (500, 1))
    origins = origins + ways * (1 - squeezed)
    ways = ways * squeezed
    ways[:250] /= np.abs(ways[:250]).max(axis=1, keepdims=True)
    outcome = check(mesh, origins.astype(np.float32) if scale < 1e38 else origins, ways)
    assert outcome.hits > 40


def test_sizes_mixed_in_one_scene():
    rng = np.random.default_rng(13)
    parts = [corners_of(soup(rng, 12, scale=10.0**k)).reshape(-1, 3) for k in range(-42, 39, 5)]
    vertices = np.concatenate(parts)
    mesh = rw.Mesh(vertices, np.arange(len(vertices)).reshape(-1, 3))
    triangles = corners_of(mesh)
    origins = points_on(rng, triangles, 600) * rng.choice([-1.5, 1e-3, 0.5, 3.0], (600, 1))
    ways = points_on(rng, triangles, 600) - origins
    ways /= np.abs(ways).max(axis=1, keepdims=True)
    outcome = check(mesh, origins, ways)
    assert outcome.hits > 300


def test_triangles_without_area_are_never_hit():
    rng = np.random.default_rng(14)
    real = corners_of(soup(rng, 20))
    a, b = rng.integers(-8, 9, (2, 40, 3)) / np.float32(8)
    middle = (a + b) / 2
    # Points, doubled corners and collinear ones (exactly: dyadic coordinates), in every order.
    flat = np.stack(
        [
            np.stack(order, axis=1)
            for order in ((a, a, a), (a, a, b), (a, b, a), (a, middle, b), (b, a, middle))
        ]
    )
    flat = flat.reshape(-1, 3, 3)
    triangles = np.concatenate([flat, real]).astype(np.float32)
    mesh = rw.Mesh(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))
    origins = rng.integers(-16, 17, (600, 3)) / 8
    targets = np.concatenate([points_on(rng, flat, 400), points_on(rng, real, 200)])
    outcome = check(mesh, origins, targets - origins)
    assert outcome.hits > 160
    hits = rw.Scene(mesh).intersect(origins, targets - origins)
    assert hits.primitive_id[hits.hit].min() >= len(flat)


def test_triangles_seen_edge_on_are_never_hit():
    # A fan of triangles through the z axis; from any point of a triangle's plane, looking within it.
    turns = np.arange(-4, 5)
    fan = np.array(
        [[(0, 0, -4), (0, 0, 4), (x, y, 0)] for x in turns for y in turns if (x, y) != (0, 0)], np.float32
    )
    rng = np.random.default_rng(15)
    chosen = rng.integers(len(fan), size=500)
    a, b, c = np.moveaxis(fan[chosen].astype(np.float64), 1, 0)
    i, j, k, m = rng.integers(-6, 7, (4, 500, 1)) / 4
    origins, directions = a + i * (b - a) + j * (c - a), k * (b - a) + m * (c - a)
    for n in range(0, 500, 25):
        single = rw.Mesh(fan[chosen[n]], [(0, 1, 2)])
        assert not rw.Scene(single).occluded(origins[n], directions[n], -np.inf).any()
    mesh = rw.Mesh(fan.reshape(-1, 3), np.arange(3 * len(fan)).reshape(-1, 3))
    check(mesh, origins, directions, -np.inf)


@pytest.mark.parametrize("dtype", TYPES)
def test_rays_that_are_not_rays_hit_nothing_and_spoil_nothing(dtype):
    rng = np.random.default_rng(16)
    mesh = soup(rng, 50)
    origins = rng.uniform(-1, 1, (900, 3)).astype(dtype)
    directions = rng.normal(size=(900, 3)).astype(dtype)
    good = rw.Scene(mesh).intersect(origins, directions)
    bad = np.arange(900) % 3 == 0
    poisons = itertools.cycle(itertools.product((np.nan, np.inf, -np.inf), (origins, directions), range(3)))
    for i in np.flatnonzero(bad)[:-60]:
        value, array, axis = next(poisons)
        array[i, axis] = value
    directions[np.flatnonzero(bad)[-60:]] = [0.0, -0.0, 0.0]
    outcome = check(mesh, origins, directions)
    hits = rw.Scene(mesh).intersect(origins, directions)
    assert not hits.hit[bad].any()
    assert np.array_equal(hits.t[~bad], good.t[~bad])
    assert outcome.hits == good.hit[~bad].sum() > 100


def test_faces_that_are_not_finite_are_never_hit():
    rng = np.random.default_rng(17)
    vertices = corners_of(soup(rng, 60)).reshape(-1, 3).copy()
    for i, value in enumerate((np.nan, np.inf, -np.inf) * 5):
        vertices[3 * i + i % 3, i % 2] = value
    mesh = rw.Mesh(vertices, np.arange(180).reshape(-1, 3))
    origins, directions = rng.uniform(-1, 1, (800, 3)), rng.normal(size=(800, 3))
    with pytest.warns(RuntimeWarning, match="15 of 60 faces"):
        outcome = check(mesh, origins, directions)
    assert outcome.hits > 100


smalls = st.integers(-3, 3).map(float)
singles = st.floats(width=32, allow_nan=False, allow_infinity=False)
near = st.floats(-1, 1, width=32)
# Just beside each other: the last bits decide.
beside = st.builds(lambda x, k: float(np.float32(x) * np.float32(1 + k * 2**-23)), smalls, st.integers(-2, 2))
doubles = st.floats(allow_nan=False, allow_infinity=False)


def point(*numbers):
    return st.tuples(*[st.one_of(*numbers)] * 3)


@fixed(150)
@given(
    st.lists(st.tuples(*[point(smalls, near, beside, singles)] * 3), min_size=1, max_size=12),
    st.lists(
        st.tuples(point(smalls, near, beside, doubles), point(smalls, near, beside, doubles)),
        min_size=1,
        max_size=12,
    ),
)
def test_any_triangles_and_any_rays(triangles, rays):
    mesh = rw.Mesh(
        np.array(triangles, np.float32).reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
    )
    origins, directions = np.moveaxis(np.array(rays), 1, 0)
    check(mesh, origins, directions)


@fixed(100)
@given(
    st.lists(st.tuples(*[point(smalls, near, beside)] * 3), min_size=1, max_size=30),
    st.lists(
        st.tuples(
            point(smalls, beside), st.integers(0, 29), st.sampled_from([0, 1, 2, 3]), st.integers(-60, 60)
        ),
        min_size=1,
        max_size=20,
    ),
)
def test_rays_aimed_at_corners_of_any_triangles(triangles, rays):
    corners = np.array(triangles, np.float32)
    mesh = rw.Mesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    origins, ways = [], []
    for origin, which, part, exponent in rays:
        triangle = corners[which % len(corners)].astype(np.float64)
        target = triangle[part] if part < 3 else (triangle[0] + triangle[1]) / 2
        origins.append(origin)
        ways.append((target - origin) * 2.0**exponent)
    check(mesh, np.array(origins), np.array(ways))
