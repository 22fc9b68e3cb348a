"""Rays that leave the points that others have found."""

import pickle

import numpy as np
import pytest
import trimesh

import raywright as rw

SIZES = [1e-6, 1e-3, 1.0, 1e3, 1e7]
PLACES = [0.0, 1.0, 1e3, 1e7]
ABOVE = np.array([0, 0, 4])


def sphere(count, seed):
    ways = np.random.default_rng(seed).normal(size=(count, 3))
    return ways / np.linalg.norm(ways, axis=-1, keepdims=True)


def to_side(ways, normal, outward):
    """Turn directions round that do not go to one side of the surface."""
    along = np.sign((ways * normal).sum(axis=-1, keepdims=True))
    return ways * along if outward else -ways * along


def block(size=1.0, at=0.0, sides=(1.0, 1.0, 1.0)):
    box = trimesh.creation.box(sides)
    return rw.Mesh(size * (box.vertices + at * np.array([1.0, -0.7, 0.3])), box.faces)


def hits_of(scene, count=30_000, seed=1):
    """Hits from all around, aimed at points of the box around the scene; and the same from within."""
    low, high = scene.bounds
    middle, reach = (low + high) / 2, np.linalg.norm(high - low)
    outside = middle + reach * sphere(count, seed)
    aims = np.random.default_rng(seed + 1).uniform(low, high, (count, 3))
    hits = scene.intersect(outside, aims - outside)
    assert hits.hit.mean() > 0.3
    return hits


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("at", PLACES)
def test_out_of_a_box_nothing_is_met_and_into_it_one_other_wall(size, at):
    scene = rw.Scene(block(size, at, (1.0, 2.0, 0.5)))
    hits = hits_of(scene)
    ways = sphere(hits.shape[0], 3)
    out = hits.spawn_rays(to_side(ways, hits.normal, outward=True))
    assert np.count_nonzero(scene.occluded(*out)) == 0
    into = hits.spawn_rays(to_side(ways, hits.normal, outward=False))
    assert np.array_equal(scene.count_hits(*into), hits.hit.astype(int))
    behind = scene.intersect(*into)
    walls = np.abs(np.einsum("ij,ij->i", behind.normal, hits.normal))
    # Not the same wall: opposite walls have opposite normals, others perpendicular ones.
    met = hits.hit
    same = (walls[met] > 0.5) & (np.einsum("ij,ij->i", behind.normal, hits.normal)[met] > 0)
    assert np.count_nonzero(same) == 0


def test_from_the_position_itself_half_of_the_rays_meet_what_they_leave():
    turned = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))
    scene = rw.Scene(block().transformed(turned))
    hits = hits_of(scene)
    out = to_side(sphere(hits.shape[0], 3), hits.normal, outward=True)[hits.hit]
    assert 0.2 < scene.occluded(hits.position[hits.hit], out).mean() < 0.8
    assert not scene.occluded(
        *hits.spawn_rays(to_side(sphere(hits.shape[0], 3), hits.normal, outward=True))
    ).any()


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("at", [0.0, 1.0, 1e3])
def test_a_thin_plate_does_not_leak(size, at):
    # A thickness of 1e-5 of its sides; at 1e3 a hundredth of that is left over rounding.
    scene = rw.Scene(block(size, at, (1.0, 1.0, 1e-5)), precision="double")
    hits = hits_of(scene, seed=5)
    ways = sphere(hits.shape[0], 6)
    assert not scene.occluded(*hits.spawn_rays(to_side(ways, hits.normal, outward=True))).any()
    # Rays inwards hit the other side, and straight ones at its distance.
    into = to_side(ways, hits.normal, outward=False)
    assert np.array_equal(scene.count_hits(*hits.spawn_rays(into)), hits.hit.astype(int))
    flat = np.abs(hits.normal[:, 2]) > 0.5
    through = scene.intersect(*hits.spawn_rays(-hits.normal))
    assert np.allclose(through.t[flat], 1e-5 * size, rtol=1e-3, atol=0)


@pytest.mark.parametrize("aspect", [1e3, 1e6, 1e8])
def test_slivers_are_left_too(aspect):
    rng = np.random.default_rng(8)
    start, along, across = rng.normal(size=(3, 300, 3))
    across -= along * ((along * across).sum(-1) / (along * along).sum(-1))[:, None]
    corners = np.stack([start, start + along, start + along / 2 + across / aspect], axis=1)
    for number, triangle in enumerate(corners):
        scene = rw.Scene(rw.Mesh(triangle, [(0, 1, 2)]), precision="double")
        aims = np.einsum("ij,jk->ik", rng.dirichlet((1.0, 1, 1), 50), triangle)
        origins = aims + sphere(50, number)
        hits = scene.intersect(origins, aims - origins)
        assert not scene.occluded(*hits.spawn_rays(sphere(50, 1000 + number))).any()


CURVED = {
    "sphere": lambda to: rw.Sphere((0.1, 0.2, 0.3), 1.1, transform=to),
    "ellipsoid": lambda to: rw.shapes.Ellipsoid((0, 0, 0), (1.0, 0.2, 3.0), transform=to),
    "cylinder": lambda to: rw.Cylinder((0, 0, -1), (0.3, 0, 1), 0.7, capped=True, transform=to),
    "cone": lambda to: rw.Cone((0, 0, -1), (0, 0.2, 1), 0.9, 0.3, capped=True, transform=to),
    "box": lambda to: rw.Box((-1, -2, -0.5), (1, 2, 0.5), transform=to),
}


@pytest.mark.parametrize("shape", CURVED)
@pytest.mark.parametrize(("size", "far"), [(1e-6, 0.0), (1.0, 0.0), (1.0, 1e6), (1e7, 1e7)])
def test_convex_shapes_are_left_for_good_outward_and_met_once_inward(shape, size, far):
    to = np.diag([size, size, size, 1.0])
    to[:3, 3] = far
    for scene in (rw.Scene(CURVED[shape](to)), rw.Scene(rw.Instance(CURVED[shape](None), to))):
        hits = hits_of(scene, 20_000)
        ways = sphere(hits.shape[0], 9)
        out = hits.spawn_rays(to_side(ways, hits.normal, outward=True))
        assert np.count_nonzero(scene.occluded(*out)) == 0
        into = hits.spawn_rays(to_side(ways, hits.normal, outward=False))
        assert np.array_equal(scene.count_hits(*into), hits.hit.astype(int))


def test_flat_shapes_and_copies_of_meshes_are_not_met_again():
    knot = rw.scenes.torus_knot(along=40, around=6)
    to = trimesh.transformations.rotation_matrix(0.4, (3, 1, 2)) @ np.diag([3.0, 0.1, 7.0, 1.0])
    to[:3, 3] = (5e5, -3e4, 12.0)
    for shapes in (
        rw.Disk((0.3, 0.2, 0.1), (1, 2, 3), 1.0),
        rw.Plane((0.3, 0.2, 0.1), (1, 2, 3)),
        rw.Mesh([(0.1, 0, 0), (1, 0.3, 0), (0, 1, 0.7)], [(0, 1, 2)]),
        rw.Instance(rw.Mesh([(0.1, 0, 0), (1, 0.3, 0), (0, 1, 0.7)], [(0, 1, 2)]), to),
        rw.Instance(rw.Instance(rw.Disk((0, 0, 0), (1, 2, 3), 1.0), np.diag([1, 2, 3, 1.0])), to),
    ):
        scene = rw.Scene(shapes)
        low, high = scene.bounds if scene.bounds is not None else np.array([[-1.0] * 3, [1.0] * 3])
        aims = np.random.default_rng(11).uniform(low, high, (5000, 3))
        origins = aims + np.linalg.norm(high - low) * sphere(5000, 12)
        hits = scene.intersect(origins, aims - origins)
        assert hits.hit.sum() > 500
        assert not scene.occluded(*hits.spawn_rays(sphere(5000, 13))).any()
        assert not scene.occluded(
            *hits.spawn_rays(np.random.default_rng(14).normal(size=(5000, 3)) * 1e-30)
        ).any()
    # A concave shape is hit where it blocks the ray, never at the origin.
    scene = rw.Scene(rw.Instance(knot, to))
    hits = hits_of(scene, 20_000)
    again = scene.intersect(*hits.spawn_rays(sphere(20_000, 15)))
    own = (again.primitive_id == hits.primitive_id) & (again.instance_id == hits.instance_id) & hits.hit
    assert np.count_nonzero(own) == 0
    assert 0.1 < again.hit[hits.hit].mean() < 0.9


def test_rays_start_on_the_side_to_which_they_go_and_very_near(scene):
    hits = scene.intersect((0.3, 0.4, 5), (0, 0, -1))
    for up in ((0, 0, 1), (0.9, 0, 1e-3), (5, 5, 1e-12), (1, 0, 0), (0, -1, 0)):
        origins, directions = hits.spawn_rays(up)
        assert 0 < origins[2] - 1 < 2e-14
        assert np.array_equal(origins[:2], hits.position[:2])
        assert np.array_equal(directions, up)
        assert 0 < 1 - hits.spawn_rays(np.negative(up)).origins[2] < 2e-14 or up[2] == 0
        assert not scene.occluded(origins, directions)
    assert hits.spawn_rays((0, 0, 1)).origins[2] - 1 == pytest.approx(8 * hits.surface.error, rel=0.1)


@pytest.mark.parametrize(
    ("points", "ways", "lead"),
    [
        ((), (), ()),
        ((), (7,), (7,)),
        ((5,), (), (5,)),
        ((5,), (5,), (5,)),
        ((5,), (3, 5), (3, 5)),
        ((5,), (3, 1), (3, 5)),
        ((4, 5), (5,), (4, 5)),
        ((4, 5), (2, 4, 5), (2, 4, 5)),
        ((4, 1), (1, 6), (4, 6)),
        ((4, 1), (2, 1, 6), (2, 4, 6)),
        ((1,), (6,), (6,)),
        ((0,), (3, 1), (3, 0)),
        ((5, 0), (), (5, 0)),
    ],
)
@pytest.mark.parametrize("dtype", [np.float64, np.float32, int])
def test_directions_and_points_broadcast(scene, points, ways, lead, dtype):
    rng = np.random.default_rng(16)
    hits = scene.intersect(rng.uniform(-0.2, 1.2, (*points, 3)) + ABOVE, (0, 0, -1))
    directions = rng.integers(-9, 9, (*ways, 3)).astype(dtype)
    left = hits.spawn_rays(directions)
    assert isinstance(left, rw.query.SpawnedRays)
    assert left.origins.shape == left.directions.shape == (*lead, 3)
    assert left.origins.dtype == np.float64
    assert left.directions.dtype == (np.float32 if dtype is np.float32 else np.float64)
    assert np.array_equal(left.directions, np.broadcast_to(directions, (*lead, 3)))
    position, normal = (np.broadcast_to(part, (*lead, 3)) for part in (hits.position, hits.normal))
    side = np.where((normal * left.directions).sum(axis=-1, keepdims=True) < 0, -1.0, 1.0)
    offset = 8 * np.broadcast_to(hits.surface.error, lead)[..., None] * normal * side
    assert np.array_equal(left.origins, position + offset, equal_nan=True)
    assert scene.intersect(*left).shape == lead


def test_misses_leave_nowhere(scene):
    hits = scene.intersect([(0.3, 0.4, 5), (9, 9, 9)], (0, 0, -1))
    left = hits.spawn_rays((0, 0, -1))
    assert np.array_equal(np.isnan(left.origins), [[False] * 3, [True] * 3])
    assert list(scene.occluded(*left)) == [True, False]
    assert list(hits.spawn_rays((np.nan, 0, 0)).origins[0]) == list(hits.spawn_rays((1, 0, 0)).origins[0])
    left.origins[0] = 0
    assert np.allclose(hits.spawn_rays((0, 0, -1)).origins[0, :2], (0.3, 0.4), rtol=0, atol=1e-12)


def test_every_hit_and_the_closest_points_are_left_alike(scene):
    every = scene.intersect_all([(0.3, 0.4, 5), (9, 9, 9), (0.6, 0.2, 7)], (0, 0, -1))
    assert np.array_equal(every.spawn_rays((0, 0, 1)).origins[:, 2] > every.position[:, 2], [True] * 4)
    assert list(scene.count_hits(*every.spawn_rays((0, 0, -1)))) == [1, 0, 1, 0]
    assert every.spawn_rays(np.ones((2, 4, 3))).origins.shape == (2, 4, 3)
    rng = np.random.default_rng(17)
    points = rng.uniform(-0.5, 1.5, (20_000, 3))
    nearest = scene.closest_point(points, max_distance=0.4)
    ways = sphere(20_000, 18)
    assert not scene.occluded(*nearest.spawn_rays(to_side(ways, nearest.normal, outward=True))).any()
    # From within a face; near an edge, a ray inwards by one face may leave by the other at once.
    within = nearest.found & (np.minimum(nearest.uv.min(axis=1), 1 - nearest.uv.sum(axis=1)) > 1e-6)
    assert within.sum() > 5000
    into = nearest.spawn_rays(to_side(ways, nearest.normal, outward=False))
    assert (scene.count_hits(*into)[within] == 1).all()
    ball = rw.Scene([rw.Sphere((0, 0, 0), 1.0), rw.Sphere((0, 0, 0), 2.0)])
    every = ball.intersect_all((0.1, 0.2, 5), (0, 0, -1))
    assert list(ball.count_hits(*every.spawn_rays((0.1, 0.3, -1)))) == [3, 2, 1, 0]


def test_old_hits_are_left_where_they_were_found(box, scene):
    hits, every = (ask((0.3, 0.4, 5), (0, 0, -1)) for ask in (scene.intersect, scene.intersect_all))
    wanted = rw.Scene(box).intersect((0.3, 0.4, 5), (0, 0, -1)).spawn_rays((0, 0, 1)).origins
    scene.refit(box.vertices + np.array([0, 0, 2]))
    assert np.array_equal(hits.spawn_rays((0, 0, 1)).origins, wanted)
    assert np.array_equal(every.spawn_rays((0, 0, 1)).origins[0], wanted)


@pytest.mark.parametrize("shapes", ["mesh", "sphere", "copies"])
def test_pickled_points_are_left_as_they_were(box, shapes):
    shape = {"mesh": box, "sphere": rw.Sphere((0, 0, 0), 1), "copies": rw.Instance(box, np.eye(4))}[shapes]
    scene = rw.Scene(shape)
    rays = np.random.default_rng(19).uniform(-0.2, 1.2, (50, 3)) + ABOVE, (0, 0, -1)
    ways = sphere(50, 20)
    found = [scene.intersect(*rays)]
    found += [scene.closest_point(rays[0])] if shapes == "mesh" else []
    for points in found:
        # Pickles keep computed attributes, and no scene to compute others.
        with pytest.raises(ValueError, match="is not in pickled hits"):
            pickle.loads(pickle.dumps(points)).spawn_rays(ways)
        left = points.spawn_rays(ways).origins
        back = pickle.loads(pickle.dumps(points))
        assert np.array_equal(back.spawn_rays(ways).origins, left, equal_nan=True)
        assert back == points
    every = scene.intersect_all(*rays)
    left = every.spawn_rays((1, 2, 3)).origins
    back = pickle.loads(pickle.dumps(every))
    assert np.array_equal(back.spawn_rays((1, 2, 3)).origins, left)


def test_rasterized_and_picked_hits_are_left_too(scene, camera):
    for hits in (scene.first_hits(camera), scene.pick(camera, np.arange(8), 3)):
        assert hits.hit.any()
        assert not scene.occluded(*hits.spawn_rays(hits.normal)).any()


def test_what_moves_is_left_at_its_time(box):
    there = np.eye(4)
    there[0, 3] = 10
    scene = rw.Scene(rw.Instance(box, np.eye(4), there))
    time = np.linspace(0, 1, 5)
    origins = np.stack([10 * time + 0.3, np.full(5, 0.4), np.full(5, 5.0)], axis=-1)
    hits = scene.intersect(origins, (0, 0, -1), time=time)
    assert hits.hit.all()
    assert not scene.occluded(*hits.spawn_rays((0.1, 0.2, 1)), time=time).any()
    assert (scene.count_hits(*hits.spawn_rays((0.1, 0.2, -1)), time=time) == 1).all()


@pytest.mark.parametrize(
    ("directions", "error", "message"),
    [
        (np.zeros((2, 4)), ValueError, r"^directions must have shape \(\.\.\., 3\), got \(2, 4\)$"),
        (1.0, ValueError, r"^directions must have shape \(\.\.\., 3\), got \(\)$"),
        (
            np.zeros((5, 3)),
            ValueError,
            r"^leading shapes do not broadcast: points \(2,\), directions \(5,\)$",
        ),
        (np.zeros((2, 3), bool), TypeError, r"^directions must be real numbers, got dtype bool$"),
        (np.zeros((2, 3), complex), TypeError, r"^directions must be real numbers, got dtype complex128$"),
        ("up", TypeError, r"^directions must be real numbers, got 'up'$"),
        (None, TypeError, r"^directions must be real numbers, got None$"),
    ],
)
def test_bad_directions_are_refused_in_one_line(scene, directions, error, message):
    hits = scene.intersect([(0.3, 0.4, 5), (9, 9, 9)], (0, 0, -1))
    with pytest.raises(error, match=message):
        hits.spawn_rays(directions)
