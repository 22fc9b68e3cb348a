"""The closest point of shapes that are no meshes, and how far inside or outside it is."""

import re

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


# A shape, dense points of it, and what is 0 on it.
SHAPES = {
    "sphere": (
        rw.Sphere((0, 0, 0), 1.5),
        ball((1.5, 1.5, 1.5)),
        lambda p: np.linalg.norm(p, axis=1) - 1.5,
    ),
    "ellipsoid": (
        rw.Ellipsoid((0, 0, 0), (2, 0.5, 1)),
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
        rw.Paraboloid((0, 0, 0), (0, 0, 2), 1.0),
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
# One that turns, mirrors and scales evenly, and one that does not.
EVEN = np.eye(4)
EVEN[:3, :3] = 2.5 * np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, -1]])
EVEN[:3, 3] = 3, -1, 0.5
UNEVEN = np.eye(4)
UNEVEN[:3, :3] = [[1.5, 0.4, 0], [0, 0.5, 0.2], [0.1, 0, -2]]
UNEVEN[:3, 3] = 3, -1, 0.5
STRETCHED = ("sphere", "ellipsoid", "box")


def moved(points, transform):
    return points @ transform[:3, :3].T + transform[:3, 3]


def under(shape, transform):
    """The same shape, moved."""
    kept = {name: value for name, value in vars(shape).items() if not name.startswith("_")}
    kept = {name: value for name, value in kept.items() if name not in ("transform", "name")}
    return type(shape)(**kept, transform=transform)


CASES = [(name, np.eye(4)) for name in SHAPES] + [(name, EVEN) for name in SHAPES]
CASES += [(name, UNEVEN) for name in STRETCHED]


@pytest.mark.parametrize(("name", "transform"), CASES)
def test_nothing_is_nearer_and_the_point_is_on_the_surface(name, transform):
    shape, dense, residual = SHAPES[name]
    if not np.array_equal(transform, np.eye(4)):
        shape = under(shape, transform)
    dense = moved(dense, transform)
    points = moved(np.random.default_rng(1).uniform(-3, 3, (60, 3)), transform)
    closest = rw.Scene(shape).closest_point(points)
    brute = np.linalg.norm(dense[None] - points[:, None], axis=-1).min(axis=1)
    assert (closest.distance <= brute + 1e-12).all()
    # Steps of the dense points are at most 0.1 long, and so is what they miss by.
    assert (closest.distance >= brute - 0.2).all()
    told = np.linalg.norm(points - closest.position, axis=1)
    assert np.allclose(closest.distance, told, rtol=1e-13, atol=0)
    own = np.linalg.solve(transform[:3, :3], (closest.position - transform[:3, 3]).T).T
    assert np.abs(residual(own)).max() < 1e-13
    assert np.allclose(np.linalg.norm(closest.normal, axis=1), 1, rtol=0, atol=1e-14)
    assert (closest.primitive == 0).all()
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
    # What has no inside is outside everywhere.
    assert (rw.Scene(rw.Disk()).signed_distance(points) > 0).all()
    squeezed = rw.Scene(rw.Plane((0, 0, 0), (1, 0, 1), transform=np.diag([2.0, 1, 1, 1])))
    expected = np.abs(points @ (0.5, 0, 1)) / np.sqrt(1.25)
    assert np.allclose(squeezed.closest_point(points).distance, expected, rtol=0, atol=2e-15)


def test_at_the_centre_any_of_the_nearest_will_do():
    centre = np.zeros(3)
    for shape, expected in [
        (rw.Sphere((0, 0, 0), 2), 2.0),
        (rw.Ellipsoid((0, 0, 0), (3, 0.5, 0.5)), 0.5),
        (rw.Torus((0, 0, 0), (0, 0, 1), 1, 0.25), 0.75),
        (rw.Cylinder((0, 0, -2), (0, 0, 2), 1), 1.0),
        (rw.Box((-1, -2, -1), (1, 2, 1)), 1.0),
        (rw.Disk((0, 0, 0), (0, 0, 1), 2, 0.5), 0.5),
        (rw.Cone((0, 0, 0), (0, 0, 2), 1, 0), 0.0),
    ]:
        closest = rw.Scene(shape).closest_point(centre)
        assert closest.distance == pytest.approx(expected, rel=1e-15, abs=1e-15)
        assert np.isfinite(closest.position).all()
        assert np.isfinite(closest.normal).all()
    # On the plane of the longer axes, on both sides of where it stops to matter.
    flat = rw.Scene(rw.Ellipsoid((0, 0, 0), (2, 2, 1)))
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
    for accelerator in (rw.BVH(), rw.BruteForce(), rw.KdTree(), rw.Grid(), rw.Octree(), rw.BSP()):
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
    assert not scene.occluded(*closest.leave(closest.normal)).any()


@pytest.mark.parametrize(
    ("shape", "told"),
    [
        (rw.Implicit("x*x + y*y + z*z - 0.5"), "on Implicit, which shape 1 is"),
        (rw.Instance(rw.Sphere((0, 0, 0), 1), np.eye(4)), "on Instance, which shape 1 is"),
        (
            rw.Cylinder((0, 0, 0), (0, 0, 1), 1, transform=np.diag([2.0, 1, 1, 1])),
            "on a Cylinder under a transform that scales some lengths more than others, which shape 1 is",
        ),
    ],
)
def test_what_is_not_found_is_refused_by_name(shape, told):
    scene = rw.Scene([rw.Sphere((0, 0, 0), 1), shape])
    for ask in (scene.closest_point, scene.signed_distance):
        with pytest.raises(ValueError, match=re.escape(f"closest points are not found {told}")):
            ask((0, 0, 0))
