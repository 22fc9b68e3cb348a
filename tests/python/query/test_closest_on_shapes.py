"""The closest point of shapes that are no meshes, and how far inside or outside it is."""

import numpy as np
import pytest

import raywright as rw

U, V = (x.ravel() for x in np.meshgrid(np.linspace(0, 1, 401), np.linspace(0, 1, 201)))
ROUND = np.stack([np.cos(2 * np.pi * U), np.sin(2 * np.pi * U)], axis=-1)


def turned(radius, height):
    """Points at distances from the z axis and heights, around it."""
    return np.concatenate([ROUND * np.asarray(radius)[:, None], np.asarray(height)[:, None]], axis=-1)


def ball(semi_axes):
    return turned(np.sin(np.pi * V), np.cos(np.pi * V)) * semi_axes


L_SHAPE = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0)]


def faces(low, high):
    """Points of the six sides of a box."""
    low, high = np.array(low, float), np.array(high, float)
    sides = []
    for k in range(3):
        for end in (0.0, 1.0):
            share = np.insert(np.stack([U, V], axis=-1), k, end, axis=-1)
            sides.append(low + share * (high - low))
    return np.concatenate(sides)


def residual_of_cylinder(p):
    rho = np.hypot(p[:, 0], p[:, 1])
    side = np.hypot(rho - 0.5, np.maximum(np.abs(p[:, 2] - 1) - 1, 0))
    cap = np.hypot(np.minimum(np.abs(p[:, 2]), np.abs(p[:, 2] - 2)), np.maximum(rho - 0.5, 0))
    return np.minimum(side, cap)


# A shape, dense points on it, and its implicit function.
SHAPES = {
    "sphere": (
        rw.Sphere((0, 0, 0), 1.5),
        ball((1.5, 1.5, 1.5)),
        lambda p: np.linalg.norm(p, axis=1) - 1.5,
    ),
    "ellipsoid": (
        rw.shapes.Ellipsoid((0, 0, 0), (2, 0.5, 1)),
        ball((2, 0.5, 1)),
        lambda p: np.linalg.norm(p / (2, 0.5, 1), axis=1) - 1,
    ),
    "disk": (
        rw.Disk((0, 0, 0), (0, 0, 1), 1.5, 0.5),
        turned(0.5 + V, 0 * V),
        lambda p: (
            np.abs(p[:, 2]) + np.abs(np.clip(np.hypot(p[:, 0], p[:, 1]), 0.5, 1.5) - np.hypot(*p.T[:2]))
        ),
    ),
    "cylinder": (
        rw.Cylinder((0, 0, 0), (0, 0, 2), 0.5),
        np.concatenate([turned(0.5 + 0 * V, 2 * V), turned(0.5 * V, 0 * V), turned(0.5 * V, 2 + 0 * V)]),
        residual_of_cylinder,
    ),
    "tube": (
        rw.Cylinder((0, 0, 0), (0, 0, 2), 0.5, capped=False),
        turned(0.5 + 0 * V, 2 * V),
        lambda p: np.hypot(np.hypot(*p.T[:2]) - 0.5, np.clip(p[:, 2], 0, 2) - p[:, 2]),
    ),
    "cone": (
        rw.Cone((0, 0, 0), (0, 0, 2), 1.0, 0.25, capped=False),
        turned(1 - 0.75 * V, 2 * V),
        lambda p: np.hypot(np.hypot(*p.T[:2]) - 1 + 0.375 * p[:, 2], np.clip(p[:, 2], 0, 2) - p[:, 2]),
    ),
    "paraboloid": (
        rw.shapes.Paraboloid((0, 0, 0), (0, 0, 2), 1.0),
        turned(V, 2 * V**2),
        lambda p: np.hypot(p[:, 2] - 2 * (p[:, 0] ** 2 + p[:, 1] ** 2), np.clip(p[:, 2], 0, 2) - p[:, 2]),
    ),
    "torus": (
        rw.Torus((0, 0, 0), (0, 0, 1), 1.0, 0.25),
        turned(1 + 0.25 * np.cos(2 * np.pi * V), 0.25 * np.sin(2 * np.pi * V)),
        lambda p: np.hypot(np.hypot(p[:, 0], p[:, 1]) - 1, p[:, 2]) - 0.25,
    ),
    "box": (
        rw.Box((-1, -0.5, 0), (2, 1.5, 1)),
        faces((-1, -0.5, 0), (2, 1.5, 1)),
        lambda p: np.minimum(np.abs(p - (-1, -0.5, 0)), np.abs(p - (2, 1.5, 1))).min(axis=1),
    ),
    "polygon": (
        rw.Polygon(L_SHAPE),
        np.concatenate([np.stack([2 * U, V, 0 * U], -1), np.stack([U, 1 + V, 0 * U], -1)]),
        lambda p: np.abs(p[:, 2]) + np.maximum(np.minimum(p[:, 0] - 1, p[:, 1] - 1), 0),
    ),
}
IMPLICIT = {
    "implicit torus": (
        rw.shapes.Implicit("(sqrt(x**2 + y**2) - 1)**2 + z**2 - 0.0625", (-1.5, -1.5, -0.5), (1.5, 1.5, 0.5)),
        SHAPES["torus"][1],
        SHAPES["torus"][2],
    ),
    # Cut open by its box.
    "implicit bowl": (
        rw.shapes.Implicit("z - x**2 - y**2", (-1, -1, -0.5), (1, 1, 0.75)),
        turned(np.sqrt(0.75) * V, 0.75 * V**2),
        lambda p: np.abs(p[:, 2] - p[:, 0] ** 2 - p[:, 1] ** 2) + np.maximum(p[:, 2] - 0.75, 0),
    ),
}
# A rotation with mirroring and even scale, and an uneven scale.
EVEN = np.eye(4)
EVEN[:3, :3] = 2.5 * np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, -1]])
EVEN[:3, 3] = 3, -1, 0.5
UNEVEN = np.eye(4)
UNEVEN[:3, :3] = [[1.5, 0.4, 0], [0, 0.5, 0.2], [0.1, 0, -2]]
UNEVEN[:3, 3] = 3, -1, 0.5


def moved(points, transform):
    return points @ transform[:3, :3].T + transform[:3, 3]


def under(shape, transform):
    """The same shape, moved."""
    kept = {name: value for name, value in vars(shape).items() if not name.startswith("_")}
    kept = {name: value for name, value in kept.items() if name not in ("transform", "name")}
    return type(shape)(**kept, transform=transform)


CASES = [(name, np.eye(4)) for name in SHAPES] + [(name, EVEN) for name in SHAPES]
CASES += [(name, UNEVEN) for name in SHAPES]
CASES += [(name, transform) for name in IMPLICIT for transform in (np.eye(4), EVEN, UNEVEN)]


@pytest.mark.parametrize(("name", "transform"), CASES)
def test_nothing_is_nearer_and_the_point_is_on_the_surface(name, transform):
    shape, dense, residual = (SHAPES | IMPLICIT)[name]
    if not np.array_equal(transform, np.eye(4)):
        shape = under(shape, transform)
    dense = moved(dense, transform)
    points = moved(np.random.default_rng(1).uniform(-3, 3, (24, 3)), transform)
    closest = rw.Scene(shape).closest_point(points)
    # Products find the nearest dense point, and the difference gives its distance.
    nearest = (np.square(dense).sum(axis=1) - 2 * points @ dense.T).argmin(axis=1)
    brute = np.linalg.norm(dense[nearest] - points, axis=1)
    assert (closest.distance <= brute + 1e-12).all()
    # Dense points are at most 0.1 apart, which bounds the error.
    assert (closest.distance >= brute - 0.2).all()
    told = np.linalg.norm(points - closest.position, axis=1)
    assert np.allclose(closest.distance, told, rtol=1e-13, atol=0)
    own = np.linalg.solve(transform[:3, :3], (closest.position - transform[:3, 3]).T).T
    assert np.abs(residual(own)).max() < 1e-13
    assert np.allclose(np.linalg.norm(closest.normal, axis=1), 1, rtol=0, atol=1e-14)
    assert (closest.primitive_id == 0).all()
    assert ((closest.uv >= 0) & (closest.uv <= 1)).all()


@pytest.mark.parametrize("name", ["sphere", "ellipsoid", "torus", "paraboloid"])
def test_the_way_there_is_along_the_normal_where_it_is_smooth(name):
    shape, _, _ = SHAPES[name]
    points = np.random.default_rng(2).uniform(-3, 3, (300, 3))
    closest = rw.Scene(shape).closest_point(points)
    way = (points - closest.position) / closest.distance[:, None]
    smooth = np.ones(300, bool) if name != "paraboloid" else closest.position[:, 2] < 2 - 1e-9
    across = np.linalg.norm(np.cross(way, closest.normal), axis=1) * closest.distance
    assert smooth.sum() > 30
    assert across[smooth].max() < 1e-12


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_spheres_and_tori_have_their_closed_forms_at_any_scale(scale):
    points = np.random.default_rng(3).normal(size=(500, 3)) * scale
    sphere = rw.Scene(rw.Sphere((0, 0, 0), scale)).signed_distance(points)
    assert np.allclose(sphere, np.linalg.norm(points, axis=1) - scale, rtol=0, atol=2e-15 * scale * 4)
    torus = rw.Scene(rw.Torus((0, 0, 0), (0, 0, 1), scale, scale / 4)).signed_distance(points)
    tube = np.hypot(np.hypot(points[:, 0], points[:, 1]) - scale, points[:, 2]) - scale / 4
    assert np.allclose(torus, tube, rtol=0, atol=2e-15 * scale * 4)
    assert (sphere < 0).sum() > 50
    assert (torus < 0).sum() > 5


def test_boxes_and_planes_have_their_closed_forms():
    points = np.random.default_rng(4).uniform(-1, 2, (1000, 3))
    box = rw.Scene(rw.Box((0, 0, 0), (1, 1, 1))).signed_distance(points)
    out = np.linalg.norm(np.maximum(np.maximum(-points, points - 1), 0), axis=1)
    depth = np.minimum(points, 1 - points).min(axis=1)
    assert np.allclose(box, np.where(depth > 0, -depth, out), rtol=0, atol=1e-15)
    plane = rw.Scene(rw.Plane((0, 0, 0.5), (0, 3, 4)))
    expected = np.abs(points @ (0, 0.6, 0.8) - 0.4)
    assert np.allclose(plane.closest_point(points).distance, expected, rtol=0, atol=2e-15)
    # All points are outside of an open surface.
    assert (rw.Scene(rw.Disk()).signed_distance(points) > 0).all()
    squeezed = rw.Scene(rw.Plane((0, 0, 0), (1, 0, 1), transform=np.diag([2.0, 1, 1, 1])))
    expected = np.abs(points @ (0.5, 0, 1)) / np.sqrt(1.25)
    assert np.allclose(squeezed.closest_point(points).distance, expected, rtol=0, atol=2e-15)


def test_at_the_center_any_of_the_nearest_will_do():
    center = np.zeros(3)
    for shape, expected in [
        (rw.Sphere((0, 0, 0), 2), 2.0),
        (rw.shapes.Ellipsoid((0, 0, 0), (3, 0.5, 0.5)), 0.5),
        (rw.Torus((0, 0, 0), (0, 0, 1), 1, 0.25), 0.75),
        (rw.Cylinder((0, 0, -2), (0, 0, 2), 1), 1.0),
        (rw.Box((-1, -2, -1), (1, 2, 1)), 1.0),
        (rw.Disk((0, 0, 0), (0, 0, 1), 2, 0.5), 0.5),
        (rw.Cone((0, 0, 0), (0, 0, 2), 1, 0), 0.0),
    ]:
        closest = rw.Scene(shape).closest_point(center)
        assert closest.distance == pytest.approx(expected, rel=1e-15, abs=1e-15)
        assert np.isfinite(closest.position).all()
        assert np.isfinite(closest.normal).all()
    # In the plane of the longer axes, on both sides of the focal curve.
    flat = rw.Scene(rw.shapes.Ellipsoid((0, 0, 0), (2, 2, 1)))
    assert flat.closest_point((0.75, 0, 0)).distance == pytest.approx(np.sqrt(13 / 16), rel=1e-14)
    assert flat.closest_point((1.75, 0, 0)).distance == pytest.approx(0.25, rel=1e-14)


def test_far_away_nothing_is_lost():
    way = np.array([0.6, 0.0, 0.8])
    for name, (shape, dense, residual) in SHAPES.items():
        closest = rw.Scene(shape).closest_point(way * 1e7)
        reach = (dense @ way).max()
        assert abs(closest.distance - (1e7 - reach)) < 1e-3, name
        assert np.abs(residual(closest.position[None])).max() < 1e-12, name


def test_meshes_and_shapes_are_found_together():
    mesh = rw.scenes.torus_knot(along=40, around=6)
    shapes = [
        rw.Sphere((2, 0, 0), 0.5),
        mesh,
        rw.Cylinder((0, 0, 1), (0, 0, 2), 0.2),
        rw.Sphere((2, 0, 0), 0.5),
    ]
    points = np.random.default_rng(5).uniform(-2, 2, (400, 3))
    alone = np.stack([rw.Scene(shape).closest_point(points).distance for shape in shapes])
    for accelerator in (
        rw.BVH(),
        rw.BruteForce(),
        rw.accelerators.KdTree(),
        rw.accelerators.Grid(),
        rw.accelerators.Octree(),
        rw.accelerators.BSP(),
    ):
        closest = rw.Scene(shapes, accelerator=accelerator).closest_point(points)
        assert np.array_equal(closest.distance, alone.min(axis=0))
        assert np.array_equal(closest.shape_id, alone.argmin(axis=0))
        assert set(closest.shape_id) == {0, 1, 2}
    limited = rw.Scene(shapes).closest_point(points, 0.25)
    assert np.array_equal(limited.found, alone.min(axis=0) <= 0.25)
    assert 10 < limited.found.sum() < 390
    nowhere = rw.Scene(shapes[0]).closest_point([(np.nan, 0, 0), (0, np.inf, 0)])
    assert not nowhere.found.any()
    assert np.isnan(nowhere.normal).all()


def test_rays_that_leave_closest_points_miss_what_they_leave():
    scene = rw.Scene(rw.Sphere((0.3, 0.2, 0.1), 1.3))
    points = np.random.default_rng(6).uniform(-3, 3, (500, 3))
    closest = scene.closest_point(points)
    assert not scene.occluded(*closest.spawn_rays(closest.normal)).any()


def test_implicit_surfaces_have_their_closed_forms_where_they_have_one():
    points = np.random.default_rng(7).uniform(-2, 2, (80, 3))
    torus = rw.Scene(IMPLICIT["implicit torus"][0]).signed_distance(points)
    tube = np.hypot(np.hypot(points[:, 0], points[:, 1]) - 1, points[:, 2]) - 0.25
    assert np.allclose(torus, tube, rtol=0, atol=4e-15)
    # A plane, cut to a square by its box.
    square = rw.Scene(rw.shapes.Implicit("z - 0.25 * x", (-1, -1, -1), (1, 1, 1))).closest_point(points)
    along, across = np.array((1, 0, 0.25)), np.array((0, 1, 0))
    u, v = points @ along / (along @ along), points @ across
    expected = np.clip(u, -1, 1)[:, None] * along + np.clip(v, -1, 1)[:, None] * across
    assert np.abs(square.position - expected).max() < 1e-12
    # Two balls at different distances; and an empty surface.
    balls = "min(x**2 + (y - 1)**2 + z**2, x**2 + (y + 1)**2 + z**2) - 0.25"
    found = rw.Scene(rw.shapes.Implicit(balls, (-2, -2, -2), (2, 2, 2))).signed_distance(points)
    away = np.linalg.norm(points[:, None] - np.array([(0, 1, 0), (0, -1, 0)]), axis=-1).min(axis=1) - 0.5
    assert np.allclose(found, away, rtol=0, atol=4e-15)
    nothing = rw.Scene(rw.shapes.Implicit("x**2 + 1")).closest_point(points)
    assert not nothing.found.any()


@pytest.mark.parametrize("scale", [1e-6, 1e6])
@pytest.mark.parametrize(
    "name", ["disk", "cylinder", "cone", "paraboloid", "torus", "polygon", "implicit bowl"]
)
def test_uneven_transforms_lose_nothing_at_any_scale(name, scale):
    shape, _, residual = (SHAPES | IMPLICIT)[name]
    points = moved(np.random.default_rng(8).uniform(-3, 3, (40, 3)), UNEVEN)
    grow = np.diag([scale, scale, scale, 1])
    small = rw.Scene(under(shape, UNEVEN)).closest_point(points)
    large = rw.Scene(under(shape, grow @ UNEVEN)).closest_point(points * scale)
    assert np.allclose(large.distance, small.distance * scale, rtol=1e-9, atol=1e-13 * scale)
    own = np.linalg.solve(UNEVEN[:3, :3], (large.position / scale - UNEVEN[:3, 3]).T).T
    assert np.abs(residual(own)).max() < 1e-12


@pytest.mark.parametrize("name", [*SHAPES, *IMPLICIT])
def test_far_away_nothing_is_lost_under_uneven_transforms(name):
    shape, dense, residual = (SHAPES | IMPLICIT)[name]
    way = np.array([0.6, 0.0, 0.8])
    closest = rw.Scene(under(shape, UNEVEN)).closest_point(way * 1e7)
    reach = (moved(dense, UNEVEN) @ way).max()
    assert abs(closest.distance - (1e7 - reach)) < 1e-2
    own = np.linalg.solve(UNEVEN[:3, :3], closest.position - UNEVEN[:3, 3])
    assert np.abs(residual(own[None])).max() < 1e-12


def test_a_squashed_sphere_is_an_ellipsoid_whatever_it_is_made_of():
    squash = np.diag([2.0, 0.5, 1.0, 1.0])
    points = np.random.default_rng(9).uniform(-3, 3, (60, 3))
    ellipsoid = rw.Scene(rw.shapes.Ellipsoid((0, 0, 0), (2, 0.5, 1))).signed_distance(points)
    ball = "x**2 + y**2 + z**2 - 1"
    implicit = rw.shapes.Implicit(ball, (-1.25, -1.25, -1.25), (1.25, 1.25, 1.25), transform=squash)
    assert np.allclose(rw.Scene(implicit).signed_distance(points), ellipsoid, rtol=0, atol=1e-14)
    # An elliptic cylinder acts like its ellipse if its ends are far.
    tube = rw.Cylinder((0, 0, -50), (0, 0, 50), 1, capped=False, transform=squash)
    flat = points * (1, 1, 0)
    disk = rw.Disk((0, 0, 0), (0, 0, 1), 1 + 1e-12, 1, transform=squash)
    near = [rw.Scene(shape).closest_point(flat).distance for shape in (tube, disk)]
    assert np.allclose(*near, rtol=0, atol=1e-11)


MESH = rw.scenes.torus_knot(along=30, around=5)
GROUP = [MESH, rw.Sphere((1, 1, 1), 0.4), rw.Cylinder((-1, -1, 0), (-1, -1, 1), 0.2)]


def placed(count, uneven):
    rng = np.random.default_rng(10)
    matrices = np.zeros((count, 4, 4))
    for matrix in matrices:
        linear, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        stretch = rng.uniform(0.3, 2, 3) if uneven else rng.uniform(0.3, 2)
        matrix[:3, :3] = linear * stretch
        matrix[:3, 3] = rng.uniform(-9, 9, 3)
        matrix[3, 3] = 1
    return matrices


def laid_out(matrix):
    """What stands in an instance, as shapes of their own."""
    mesh = rw.Mesh(moved(np.asarray(MESH.vertices, float), matrix), MESH.faces)
    return [mesh, *(under(shape, matrix) for shape in GROUP[1:])]


@pytest.mark.parametrize("uneven", [False, True])
def test_instances_are_as_near_as_what_is_in_them(uneven):
    matrices = placed(40, uneven)
    points = np.random.default_rng(11).uniform(-12, 12, (80, 3))
    scene = rw.Scene([rw.Instance(GROUP, matrices), rw.Sphere((0, 0, 0), 9)], precision="double")
    closest = scene.closest_point(points)
    alone = np.stack(
        [
            rw.Scene(shape, precision="double").closest_point(points).distance
            for matrix in matrices
            for shape in laid_out(matrix)
        ]
    )
    ball = np.abs(np.linalg.norm(points, axis=1) - 9)
    assert np.allclose(closest.distance, np.minimum(alone.min(axis=0), ball), rtol=0, atol=1e-13)
    on_copies = closest.shape_id == 0
    assert 20 < on_copies.sum() < 80
    assert (closest.instance_id[~on_copies] == -1).all()
    which = alone.argmin(axis=0)[on_copies]
    assert np.array_equal(closest.instance_id[on_copies], which // 3)
    first = len(MESH.faces)
    told = closest.primitive_id[on_copies]
    assert np.array_equal(np.where(told < first, 0, told - first + 1), which % 3)
    # Normals agree with those of rays to the point.
    ways = (closest.position - points) / closest.distance[:, None]
    hits = scene.intersect(points, ways, t_max=closest.distance * 1.5)
    same = hits.hit & (np.abs(hits.t - closest.distance) < 1e-9) & (hits.primitive_id == closest.primitive_id)
    # Rims of cylinders have two.
    same &= (hits.shape_id != 0) | (hits.primitive_id != first + 1)
    assert same.sum() > 10
    assert np.abs(np.cross(hits.normal[same], closest.normal[same])).max() < 1e-9
    assert np.allclose(np.linalg.norm(closest.normal, axis=1), 1, rtol=0, atol=1e-14)
    assert not scene.occluded(*closest.spawn_rays(points - closest.position), t_max=0.999).any()


def test_copies_within_copies_are_stretched_twice():
    inner, outer = placed(5, True), placed(4, True)
    nested = rw.Scene(rw.Instance([rw.Instance(GROUP, inner)], outer), precision="double")
    points = np.random.default_rng(12).uniform(-20, 20, (40, 3))
    flat = rw.Scene(
        [rw.Instance(GROUP, np.concatenate([matrix @ inner for matrix in outer]))], precision="double"
    )
    a, b = nested.closest_point(points), flat.closest_point(points)
    assert np.allclose(a.distance, b.distance, rtol=0, atol=1e-13)
    assert np.allclose(a.position, b.position, rtol=0, atol=1e-12)
    each = len(MESH.faces) + 2
    assert np.array_equal(a.primitive_id, b.instance_id % 5 * each + b.primitive_id)
    assert np.array_equal(a.instance_id, b.instance_id // 5)


def test_signed_distance_of_copies_has_the_sign_of_the_side():
    matrices = placed(8, True)
    scene = rw.Scene(rw.Instance(rw.Box((-1, -1, -1), (1, 1, 1)), matrices))
    points = np.random.default_rng(13).uniform(-10, 10, (3000, 3))
    own = np.linalg.solve(matrices[:, None, :3, :3], (points - matrices[:, None, :3, 3])[..., None])[..., 0]
    inside = (np.abs(own) < 1).all(axis=-1).sum(axis=0) % 2 == 1
    signed = scene.signed_distance(points)
    assert inside.sum() > 20
    assert np.array_equal(signed < 0, inside)
    assert np.array_equal(np.abs(signed), scene.closest_point(points).distance)


def test_many_copies_are_looked_through_by_a_tree(monkeypatch):
    # A thousand points among a hundred thousand copies take no longer than among a few.
    rng = np.random.default_rng(14)
    matrices = np.zeros((100_000, 4, 4)) + np.eye(4)
    matrices[:, :3, 3] = rng.uniform(0, 100, (100_000, 3))
    points = rng.uniform(0, 100, (1000, 3))
    closest = rw.Scene(rw.Instance(rw.Sphere((0, 0, 0), 0.1), matrices)).closest_point(points)
    away = np.stack([np.linalg.norm(matrices[:, :3, 3] - point, axis=1) for point in points[:50]])
    assert np.allclose(closest.distance[:50], np.abs(away - 0.1).min(axis=1), rtol=0, atol=1e-12)
    assert np.array_equal(closest.instance_id[:50], np.abs(away - 0.1).argmin(axis=1))


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_copies_lose_nothing_at_any_scale(scale):
    matrices = placed(6, True)
    points = np.random.default_rng(15).uniform(-12, 12, (50, 3))
    grow = np.diag([scale, scale, scale, 1])
    one = rw.Scene(rw.Instance(GROUP, matrices), precision="double").closest_point(points)
    other = rw.Scene(rw.Instance(GROUP, grow @ matrices), precision="double").closest_point(points * scale)
    assert np.allclose(other.distance, one.distance * scale, rtol=1e-9, atol=1e-13 * scale)
    assert np.array_equal(other.instance_id, one.instance_id)
    assert np.array_equal(other.primitive_id, one.primitive_id)


def test_what_moves_is_where_it_is_as_the_shutter_opens():
    ends = np.stack([np.eye(4), np.eye(4)])
    ends[1, :3, 3] = 5, 0, 0
    moving = rw.Instance(rw.Sphere((0, 0, 0), 1), ends[0], ends[1])
    assert rw.Scene(moving).closest_point((0, 3, 0)).distance == 2
