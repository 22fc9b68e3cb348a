"""Copies of shapes against the same shapes moved."""

import pickle

import numpy as np
import pytest
import trimesh

import raywright as rw

TURNS = [np.eye(3)[list(order)] for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2))]


def soup(count: int, seed: int = 0) -> rw.Mesh:
    """Triangles whose corners are multiples of 1/256."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1, 1, (count, 1, 3)) + rng.normal(size=(count, 3, 3)) * 0.2
    vertices = (np.round(corners * 256) / 256).reshape(-1, 3).astype(np.float32)
    return rw.Mesh(vertices, np.arange(3 * count).reshape(-1, 3))


def exact_transforms(count: int, seed: int = 1) -> np.ndarray:
    """Quarter turns, mirrors, powers of two and whole numbers: nothing rounds."""
    rng = np.random.default_rng(seed)
    result = np.tile(np.eye(4), (count, 1, 1))
    for i, matrix in enumerate(result):
        matrix[:3, :3] = TURNS[i % 4] * rng.choice([-1, 1], 3) * 2.0 ** rng.integers(-2, 3)
        matrix[:3, 3] = rng.integers(-8, 9, 3)
    return result


def rays(count: int, seed: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Rays through the middle whose numbers are multiples of 1/16, so that few products round."""
    rng = np.random.default_rng(seed)
    origins = np.round(rng.uniform(-20, 20, (count, 3)) * 16) / 16
    return origins, np.round((rng.uniform(-8, 8, (count, 3)) - origins) * 16) / 16


def flat(shapes: list[rw.Mesh]) -> rw.Scene:
    return rw.Scene(shapes, precision="double")


def test_copies_are_as_shapes_that_are_moved_where_nothing_rounds() -> None:
    mesh, transforms = soup(300), exact_transforms(20)
    copies, moved = rw.Scene(rw.Instance(mesh, transforms)), flat([mesh.transformed(m) for m in transforms])
    origins, directions = rays(10_000)
    got, wanted = copies.intersect(origins, directions), moved.intersect(origins, directions)
    assert got.hit.mean() > 0.5
    np.testing.assert_array_equal(got.t, wanted.t)
    np.testing.assert_array_equal(got.instance_id, wanted.shape_id)
    np.testing.assert_array_equal(got.primitive_id, wanted.primitive_id)
    np.testing.assert_array_equal(got.shape_id, np.where(got.hit, 0, -1))
    np.testing.assert_allclose(got.position, wanted.position, rtol=0, atol=1e-14)
    np.testing.assert_allclose(got.normal, wanted.normal, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(copies.occluded(origins, directions), got.hit)
    every, each = copies.intersect_all(origins, directions), moved.intersect_all(origins, directions)
    for name in ("ray_splits", "t", "primitive_id"):
        np.testing.assert_array_equal(getattr(every, name), getattr(each, name))
    np.testing.assert_array_equal(every.instance_id, each.shape_id)
    np.testing.assert_allclose(every.position, each.position, rtol=0, atol=1e-14)
    first = every.ray_splits[:-1][got.hit.reshape(-1)]
    np.testing.assert_array_equal(every.instance_id[first], got.instance_id[got.hit])
    np.testing.assert_array_equal(copies.count_hits(origins, directions), every.count)


@pytest.mark.parametrize(
    ("size", "far"), [(1e-6, 0.0), (1.0, 0.0), (1e6, 0.0), (1e-6, 10.0), (1.0, 1e7), (1e6, 1e7)]
)
def test_any_transform_puts_a_point_where_it_says(size: float, far: float) -> None:
    rng = np.random.default_rng(int(np.log10(size)) + 10)
    mesh = soup(50)
    transforms = np.tile(np.eye(4), (30, 1, 1))
    transforms[:, :3, :3] = (rng.normal(size=(30, 3, 3)) + 2 * np.eye(3)) * size
    transforms[:, :3, 3] = rng.uniform(-1, 1, (30, 3)) * far
    corners = mesh.vertices[mesh.faces].astype(np.float64)
    # Towards points of the triangles, from a distance of their own size.
    copy, face = rng.integers(0, 30, 4000), rng.integers(0, 50, 4000)
    weights = rng.dirichlet((1, 1, 1), 4000)
    inside = np.einsum("nk,nkd->nd", weights, corners[face])
    linear = transforms[copy, :3, :3]
    shift = transforms[copy, :3, 3]
    target = np.einsum("nij,nj->ni", linear, inside) + shift
    directions = rng.normal(size=(4000, 3)) * size
    scene = rw.Scene(rw.Instance(mesh, transforms))
    every = scene.intersect_all(target - directions, directions)
    ours = (every.instance_id == copy[every.ray]) & (every.primitive_id == face[every.ray])
    # In the group's space rounding moves a ray by this, and t by as much over the angle of incidence.
    error = 64 * np.finfo(np.float64).eps * (far / size + 10) * np.linalg.cond(linear)
    normal = np.cross(corners[face, 1] - corners[face, 0], corners[face, 2] - corners[face, 0])
    area = np.linalg.norm(normal, axis=1)
    way = np.linalg.solve(linear, directions[..., None])[..., 0]
    slope = np.abs(np.einsum("ni,ni->n", normal / area[:, None], way))
    edges = corners[face] - np.roll(corners[face], 1, axis=1)
    margin = weights.min(axis=1) * area / np.linalg.norm(edges, axis=2).max(axis=1)
    sure = margin * slope > error * (np.linalg.norm(way, axis=1) + slope)
    found = np.zeros(4000, bool)
    found[every.ray[ours]] = True
    assert found[sure].all()
    assert sure.mean() > 0.3
    near = np.abs(every.t[ours] - 1) * slope[every.ray[ours]] <= error[every.ray[ours]]
    assert near[sure[every.ray[ours]]].all()
    at = every.position[ours] - target[every.ray[ours]]
    along = np.abs(every.t[ours] - 1)[:, None] * np.abs(directions[every.ray[ours]])
    room = (error[every.ray[ours]] * size * 10)[:, None]
    assert (np.abs(at) <= along + room).all()


def test_instances_of_instances_are_numbered_flat() -> None:
    mesh, transforms = soup(40), exact_transforms(6)
    inner = rw.Instance([mesh, mesh], transforms[:3], accelerator=rw.BruteForce())
    outer = rw.Instance([mesh, inner], transforms[3:])
    scene = rw.Scene([outer, mesh])
    shapes, places = [], []
    for copy, m in enumerate(transforms[3:]):
        shapes.append(mesh.transformed(m))
        places.append((copy, (), 0))
        for number, k in enumerate(transforms[:3]):
            for which in range(2):
                shapes.append(mesh.transformed(m @ k))
                places.append((copy, ((1, number),), which))
    origins, directions = rays(4000)
    got, wanted = scene.intersect(origins, directions), flat([*shapes, mesh]).intersect(origins, directions)
    np.testing.assert_array_equal(got.t, wanted.t)
    assert outer.primitives == 40 + 3 * 80
    for i in np.flatnonzero(got.instance_id >= 0):
        told = outer.locate(got.primitive_id[i])
        assert (got.instance_id[i], told.path, told.shape_id) == places[wanted.shape_id[i]]
        assert told.face == wanted.primitive_id[i]
        assert told.shape is mesh
    rest = got.hit & (got.instance_id < 0)
    np.testing.assert_array_equal(got.primitive_id[rest], wanted.primitive_id[rest])
    np.testing.assert_array_equal(got.shape_id[rest], 1)
    for number in (-1, outer.primitives):
        with pytest.raises(ValueError, match="primitive_id must be"):
            outer.locate(number)


def test_closed_copies_hold_points_and_are_crossed_evenly(box: rw.Mesh) -> None:
    transforms = exact_transforms(5, seed=5)
    transforms[:, :3, 3] = np.arange(5)[:, None] * (16, 0, 0)
    scene = rw.Scene(rw.Instance(box, transforms))
    points = np.random.default_rng(0).uniform((-8, -8, -8), (72, 8, 8), (5000, 3))
    points[:500] = np.round(points[:500])
    local = np.linalg.solve(transforms[:, None, :3, :3], (points - transforms[:, None, :3, 3])[..., None])[
        ..., 0
    ]
    inside = ((local >= 0) & (local <= 1)).all(axis=-1).any(axis=0)
    assert inside.sum() > 30
    np.testing.assert_array_equal(scene.contains(points), inside)
    origins, directions = rays(5000)
    far = np.abs(origins).max(axis=1) > 10
    assert not (scene.count_hits(origins[far] * (1, 1, 8), directions[far]) % 2).any()
    # Along edges and through corners too.
    ways = np.array(
        [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) != (0, 0, 0)]
    )
    corners = np.einsum("kij,vj->kvi", transforms[:, :3, :3], box.vertices) + transforms[:, None, :3, 3]
    assert not (scene.count_hits(corners[:, :, None] - 100 * ways, ways) % 2).any()


def test_equal_shapes_are_compiled_once(box: rw.Mesh) -> None:
    mesh = soup(2000)
    one = rw.Scene(rw.Instance(mesh, np.eye(4))).bytes
    both = rw.Scene([rw.Instance(mesh, np.eye(4)), rw.Instance([mesh], exact_transforms(2))]).bytes
    assert both - one < 1000
    other = rw.Instance(mesh, np.eye(4), accelerator=rw.BruteForce())
    assert rw.Scene([rw.Instance(mesh, np.eye(4)), other]).bytes > 1.4 * one


def test_a_million_copies_take_160_bytes_each() -> None:
    count = 1_000_000
    transforms = np.tile(np.eye(4), (count, 1, 1))
    transforms[:, :3, 3] = np.random.default_rng(0).uniform(-100, 100, (count, 3))
    assert rw.Scene(rw.Instance(soup(10), transforms), quality="low").bytes <= 160 * count


def test_transforms_that_move_are_fitted() -> None:
    mesh, transforms = soup(60), exact_transforms(12)
    scene = rw.Scene([rw.Instance(mesh, transforms[:6]), mesh])
    origins, directions = rays(2000)
    before = scene.intersect(origins, directions)
    position = before.position.copy()
    scene.refit([transforms[6:], None])
    wanted = rw.Scene([rw.Instance(mesh, transforms[6:]), mesh]).intersect(origins, directions)
    assert scene.intersect(origins, directions) == wanted
    np.testing.assert_array_equal(before.position, position)
    with pytest.raises(ValueError, match="transform must have 6 matrices, got 2"):
        scene.refit([transforms[:2], None])


def test_copies_render_as_shapes_that_are_moved() -> None:
    matrix = np.diag((2.0, 2, 2, 1))
    matrix[:3, 3] = (1, 0, 0)
    floor = rw.Mesh([(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)], [(0, 1, 2), (0, 2, 3)])
    block = rw.Mesh(soup(30).vertices + 1, soup(30).faces, material=rw.Diffuse((0.9, 0.2, 0.1)))
    camera = rw.Camera((3, -9, 6), (1, 0, 0), up=(0, 0, 1), width=32, height=24)
    inside = rw.Scene([floor, rw.Instance(block, matrix)], environment=1.0)
    moved = rw.Scene([floor, block.transformed(matrix)], environment=1.0)
    # Paths among matte triangles and among instances use different numbers for roulette.
    a, b = (rw.render(scene, camera, rw.Direct(2), samples=8, seed=3) for scene in (inside, moved))
    np.testing.assert_allclose(a.rgb, b.rgb, rtol=1e-5)
    assert a.rgb.std() > 0.01


def test_instances_are_values(box: rw.Mesh) -> None:
    instance = rw.Instance([box], exact_transforms(3))
    same = pickle.loads(pickle.dumps(instance))
    assert same == instance
    assert hash(same) == hash(instance)
    assert instance != rw.Instance([box], exact_transforms(3), accelerator=rw.BruteForce())
    assert instance != rw.Instance([box], exact_transforms(3), exact_transforms(3))
    assert repr(instance) == "Instance(1 shape, 3 copies)"
    assert len(instance) == 3
    with pytest.raises(ValueError, match="read-only"):
        instance.transform[0] = 0
    hits = rw.Scene(instance).intersect(*rays(500))
    again = pickle.loads(pickle.dumps(hits))
    assert again == hits
    np.testing.assert_array_equal(again.instance_id, hits.instance_id)


def sheared(by: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:2, :2] = [[1, 1], [1, 1 + by]]
    return matrix


def test_rays_that_must_hit_do_up_to_the_condition_that_is_refused() -> None:
    rng = np.random.default_rng(9)
    ball = trimesh.creation.icosphere(subdivisions=1)
    mesh = rw.Mesh(ball.vertices, ball.faces)
    inside = 0.85 * ball.vertices[rng.integers(len(ball.vertices), size=500)]
    taken = []
    for power in (0, 2, 4, 5, 7, 9, 12, 16):
        turns = [np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(2)]
        for turned in (turns[1], np.eye(3)):
            matrix = np.eye(4)
            matrix[:3, :3] = turns[0] @ np.diag((1, 1, 10.0**-power)) @ turned
            matrix[:3, 3] = rng.normal(size=3)
            linear = matrix[:3, :3]
            condition = (abs(linear) @ abs(np.linalg.inv(linear))).sum(axis=1).max()
            if condition > 1.1 * 2**20:
                with pytest.raises(ValueError, match="its condition number is"):
                    rw.Instance(mesh, matrix)
                continue
            if condition > 0.9 * 2**20:
                continue
            scene = rw.Scene(rw.Instance(mesh, matrix))
            taken.append(power)
            for far in (3.0, 100.0):
                origins = rng.normal(size=(500, 3)) * far
                targets = inside @ matrix[:3, :3].T + matrix[:3, 3]
                assert scene.intersect(origins, targets - origins).hit.all()
    # A scale along its own axes followed by a rotation is well conditioned, whatever the scale.
    assert taken.count(4) == 2
    assert taken.count(16) == 1


@pytest.mark.parametrize(
    ("transform", "told"),
    [
        (np.eye(3), r"transform must have shape \(4, 4\) or \(N, 4, 4\), got \(3, 3\)"),
        (np.full((4, 4), np.nan), "transform must be finite"),
        (np.ones((4, 4)), r"transform must have \(0, 0, 0, 1\) as its last row, got \(1, 1, 1, 1\)"),
        (
            np.stack([np.eye(4), np.diag((1, 0, 1, 1.0))]),
            r"transform\[1\] must have an inverse: its determinant is 0",
        ),
        (
            np.diag((1e-320, 1, 1, 1)),
            "transform must have an inverse: its inverse overflows float64",
        ),
        (
            np.stack([np.eye(4), sheared(1e-15)]),
            r"transform\[1\] must have an inverse that keeps its digits: "
            r"its condition number is 3\.6e15, expected at most 1\.0e6",
        ),
        (sheared(1e-7), r"its condition number is 4\.0e7, expected at most 1\.0e6"),
    ],
)
def test_a_transform_that_cannot_be_says_why(box: rw.Mesh, transform: np.ndarray, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        rw.Instance(box, transform)


def test_what_cannot_be_is_refused(box: rw.Mesh) -> None:
    with pytest.raises(TypeError, match="accelerator must be"):
        rw.Instance(box, np.eye(4), accelerator="tree")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="shapes must be"):
        rw.Instance(3, np.eye(4))  # type: ignore[arg-type]
    many = rw.Instance(box, np.tile(np.eye(4), (20_000, 1, 1)))
    with pytest.raises(ValueError, match="fewer than 2\\^31 primitives, got 4800000000"):
        rw.Instance(rw.Instance(many, np.tile(np.eye(4), (20_000, 1, 1))), np.eye(4))
    assert not rw.Scene(rw.Instance([], np.eye(4))).intersect((0, 0, 0), (0, 0, 1)).hit
    assert not rw.Scene(rw.Instance(box, np.empty((0, 4, 4)))).intersect((0, 0, 0), (0, 0, 1)).hit


def test_a_ray_without_a_beginning_is_occluded_by_a_copy(box: rw.Mesh) -> None:
    scene = rw.Scene(rw.Instance([box], np.eye(4)))
    origins = np.array([[0.5, 0.4, 3.0], [0.5, 0.4, -3.0], [5.0, 5.0, 3.0]])
    for directions in ([0, 0, 1.0], [0, 0, -1.0], [0, 0, 3e-200]):
        hits = scene.intersect(origins, directions, t_min=-np.inf)
        assert hits.hit.tolist() == [True, True, False]
        np.testing.assert_array_equal(scene.occluded(origins, directions, t_min=-np.inf), hits.hit)
