"""Shapes that are no meshes, in scenes: found, told and shining as they should, among meshes and alone."""

import math
import pickle

import numpy as np
import pytest
import trimesh

import raywright as rw


def one_of_each():
    ball = trimesh.creation.icosphere(2)
    return [
        rw.Sphere((0, 0, 0), 1),
        rw.Disk((4, 0, 0), (0, 1, 1), 1.2, inner_radius=0.3),
        rw.Cylinder((8, -1, 0), (8.5, 1, 0.5), 0.6),
        rw.Cone((12, -1, 0), (12, 1, 0), 1.0, 0.25),
        rw.Box((15, -1, -1), (17, 1, 1)),
        rw.shapes.Ellipsoid((20, 0, 0), (1, 0.4, 0.8)),
        rw.shapes.Paraboloid((24, -1, 0), (24, 1, 0), 0.9),
        rw.Torus((28, 0, 0), (0, 1, 1), 0.9, 0.3),
        rw.Polygon([(31, -1, 0), (33, -1, 0), (33, 1, 0), (32, 0, 0), (31, 1, 0)]),
        rw.shapes.Implicit(
            "(x - 36)**2 + y**2 + z**2 - 1 + 0.2 * sin(5 * x)", (34.5, -1.5, -1.5), (37.5, 1.5, 1.5)
        ),
        rw.Mesh(ball.vertices + np.array([40, 0, 0]), ball.faces),
    ]


def rays(count, seed=0):
    """Rays from all around, aimed at where the shapes are."""
    rng = np.random.default_rng(seed)
    targets = np.stack([rng.uniform(-1, 41, count), *rng.uniform(-1, 1, (2, count))], axis=1)
    origins = targets + 8 * rng.normal(size=(count, 3))
    return origins, targets - origins


def test_each_is_hit_where_it_is_told_and_by_its_number():
    shapes = one_of_each()
    scene = rw.Scene(shapes)
    origins, directions = rays(4000)
    hits = scene.intersect(origins, directions)
    assert set(hits.shape_id) == set(range(-1, len(shapes)))
    on = hits.hit
    along = origins + hits.t[:, None] * directions
    # Points are on the surface, and points along rays next to it.
    assert np.abs(along - hits.position)[on].max() < 1e-12 * 50
    assert np.allclose(np.linalg.norm(hits.normal[on], axis=1), 1, atol=1e-14)
    for i, shape in enumerate(shapes):
        mine = hits.shape_id == i
        alone = rw.Scene(shape).intersect(origins[mine], directions[mine])
        assert np.array_equal(alone.t, hits.t[mine])
        low, high = shape.bounds
        assert ((hits.position[mine] >= low - 1e-12) & (hits.position[mine] <= high + 1e-12)).all()


def test_all_questions_agree():
    scene = rw.Scene([*one_of_each(), rw.Plane((0, -1.5, 0), (0.1, 1, 0))])
    origins, directions = rays(3000, 1)
    hits = scene.intersect(origins, directions)
    assert np.array_equal(scene.occluded(origins, directions), hits.hit)
    every = scene.intersect_all(origins, directions)
    first = every.ray_splits[:-1][hits.hit]
    for name in ("t", "shape_id", "primitive_id", "uv", "position", "normal"):
        assert np.array_equal(getattr(every, name)[first], getattr(hits, name)[hits.hit]), name
    assert np.array_equal(every.count, scene.count_hits(origins, directions))
    assert np.array_equal(every.count > 0, hits.hit)
    # Both ends of the interval count.
    t = hits.t[hits.hit]
    assert np.array_equal(scene.intersect(origins[hits.hit], directions[hits.hit], t, t).t, t)
    assert (scene.traversal_cost(origins, directions).primitives > 0).any()


@pytest.mark.parametrize(
    "accelerator",
    [rw.BVH("spatial"), rw.accelerators.Grid(), rw.accelerators.NestedGrid(), rw.BruteForce()],
    ids=lambda a: type(a).__name__,
)
def test_every_accelerator_gives_the_same(accelerator):
    shapes = [*one_of_each(), rw.Plane((0, -1.5, 0), (0.1, 1, 0))]
    origins, directions = rays(2000, 2)
    wanted, scene = rw.Scene(shapes), rw.Scene(shapes, accelerator=accelerator)
    assert scene.intersect(origins, directions) == wanted.intersect(origins, directions)
    assert scene.intersect_all(origins, directions) == wanted.intersect_all(origins, directions)
    assert np.array_equal(scene.occluded(origins, directions), wanted.occluded(origins, directions))


def test_closed_shapes_contain_their_insides():
    scene = rw.Scene([shape for shape in one_of_each() if type(shape) not in (rw.Disk, rw.Polygon)])
    rng = np.random.default_rng(3)
    points = np.stack([rng.uniform(-1.2, 41.2, 6000), *rng.uniform(-1.2, 1.2, (2, 6000))], axis=1)
    x, y, z = points.T
    ball = x**2 + y**2 + z**2 < 1
    box = (np.abs(points - [16, 0, 0]) < 1).all(axis=1)
    egg = ((points - [20, 0, 0]) ** 2 / np.array([1, 0.4, 0.8]) ** 2).sum(axis=1) < 1
    bump = (x - 36) ** 2 + y**2 + z**2 - 1 + 0.2 * np.sin(5 * x) < 0
    inside = scene.contains(points)
    for region, truth in (
        ((-1.2, 1.2), ball),
        ((14.8, 17.2), box),
        ((18.8, 21.2), egg),
        ((34.6, 37.4), bump),
    ):
        here = (x > region[0]) & (x < region[1])
        assert np.array_equal(inside[here], truth[here])


def test_derivatives_are_those_of_positions():
    """A step along the surface changes the position by dp, and the normal by dn, to first order."""
    sphere = rw.Sphere((1, 2, 3), 2.0, transform=[[1, 0.5, 0, 0], [0, 2, 0, 0], [0, 0, 1, 1], [0, 0, 0, 1]])
    scene = rw.Scene(sphere)
    origins, directions = np.array([1.0, 3.0, 30.0]), np.array([0.1, 0.05, -1.0])
    near = directions + np.array([[0, 0, 0], [1e-6, 0, 0], [0, 1e-6, 0]])
    hits = scene.intersect(origins, near)
    s = hits.surface
    for k in (1, 2):
        du, dv = hits.uv[k] - hits.uv[0]
        assert np.allclose(s.position[k] - s.position[0], du * s.dp_du[0] + dv * s.dp_dv[0], atol=1e-8)
        assert np.allclose(s.normal[k] - s.normal[0], du * s.dn_du[0] + dv * s.dn_dv[0], atol=1e-9)
    assert np.array_equal(s.position, hits.position)
    assert np.array_equal(s.normal, hits.normal)
    assert 0 < s.error.min() <= s.error.max() < 1e-13
    assert pickle.loads(pickle.dumps(hits)) == hits
    assert pickle.loads(pickle.dumps(hits)).surface == s


@pytest.mark.parametrize("accelerator", [rw.BVH(), rw.BruteForce()])
def test_an_empty_box_around_what_has_no_end(accelerator):
    scene = rw.Scene(rw.Plane((0, 0, 1), (0, 0, 1)), accelerator=accelerator)
    assert scene.bounds is None
    hits = scene.intersect([[0, 0, 3], [5e8, 0, -2], [0, 0, 3]], [[0, 0, -1], [0, 0, 1], [1, 0, 0]])
    assert np.array_equal(hits.t, [2, 3, np.inf])


def test_a_sphere_lights_a_floor_as_its_closed_form_says():
    """Irradiance below a sphere of radiance L: pi L (r / d)^2, which a white floor sends back over pi."""
    radiance, radius, height = 3.0, 0.5, 2.0
    scene = rw.Scene(
        [
            rw.Plane((0, 0, 0), (0, 0, 1), material=rw.Diffuse(0.5)),
            rw.Sphere((0, 0, height), radius, material=rw.Diffuse(0.0), emission=radiance),
        ]
    )
    camera = rw.Camera((0.3, 0, 0.2), (0, 0, 0), fov=0.01, width=4, height=4)
    image = rw.render(scene, camera, rw.Path(max_depth=1), samples=512, progress=False)
    expected = 0.5 * radiance * (radius / height) ** 2
    assert abs(image.rgb.mean() - expected) < 4 * float(np.sqrt((image.standard_error**2).sum())) / 48 + 1e-4
    assert image.rgb.mean() == pytest.approx(expected, rel=2e-3)


def test_a_ball_in_a_furnace_is_not_seen():
    """Albedo 1 in constant light of 1 gives back 1 everywhere, whatever the shape and its transform."""
    turned = [[0.0, -1.0, 0, 0], [2.0, 0, 0, 0], [0, 0, 0.5, 0], [0, 0, 0, 1]]
    for shape in (
        rw.Sphere((0, 0, 0), 1, material=rw.Diffuse(1.0), transform=turned),
        rw.shapes.Ellipsoid((0, 0, 0), (1, 0.5, 0.7), material=rw.Diffuse(1.0)),
        rw.Box((-1, -1, -1), (1, 1, 1), material=rw.Diffuse(1.0)),
    ):
        scene = rw.Scene(shape, environment=1.0)
        image = rw.render(
            scene, rw.Camera((0, 0, 4), (0, 0, 0), width=24, height=24), samples=32, progress=False
        )
        assert np.abs(image.rgb - 1).max() < 1e-5


def test_a_shape_in_an_instance_is_told_as_one_that_is_transformed_itself():
    """All about the points, for a curved shape in a copy that is sheared, mirrored and moved."""
    matrix = [[1, 0.5, 0, 4], [0, -2, 0, 0], [0.25, 0, 1, -1], [0, 0, 0, 1]]
    ball = rw.Sphere((0.5, 0, 0), 1.5)
    copied = rw.Scene(rw.Instance([ball, rw.Torus((0, 5, 0), (0, 0, 1), 1, 0.5)], matrix))
    itself = rw.Scene(rw.Sphere((0.5, 0, 0), 1.5, transform=matrix))
    rng = np.random.default_rng(5)
    targets = np.array([4.5, 0, -1]) + rng.uniform(-1, 1, (500, 3))
    origins = targets + 10 * rng.normal(size=(500, 3))
    a, b = copied.intersect(origins, targets - origins), itself.intersect(origins, targets - origins)
    mine = b.hit & (a.primitive_id == 0)
    assert mine.sum() > 300
    assert np.allclose(a.t[mine], b.t[mine], rtol=1e-13)
    for name in ("position", "normal", "shading_normal", "dp_du", "dp_dv", "dn_du", "dn_dv"):
        of_copy, own = getattr(a.surface, name)[mine], getattr(b.surface, name)[mine]
        assert np.allclose(of_copy, own, atol=1e-7), name
    assert (a.instance_id[mine] == 0).all()
    assert (b.instance_id == -1).all()


def test_one_ray_alone():
    hits = rw.Scene(rw.Sphere((0, 0, 0), 1)).intersect([0, 0, 3], [0, 0, -1])
    assert hits.position.tolist() == pytest.approx([0, 0, 1])
    assert hits.surface.error.shape == ()
    assert hits.surface.dp_du.shape == (3,)
    mesh = rw.Scene(trimesh.creation.box()).intersect([0.1, 0.2, 3], [0, 0, -1])
    assert np.array_equal(mesh.surface.normal, mesh.normal)


def test_what_cannot_be_is_told():
    scene = rw.Scene([rw.Sphere((0, 0, 0), 1)])
    with pytest.raises(ValueError, match="vertices must be None for shapes other than meshes, got a Sphere"):
        scene.refit(np.zeros((3, 3)))
    with pytest.raises(ValueError, match=r"vertices\[1\] must be None"):
        rw.Scene([trimesh.creation.box(), rw.Sphere((0, 0, 0), 1)]).refit([None, np.zeros((3, 3))])
    assert scene.refit([None]) == 1.0
    assert math.isinf(rw.Plane((0, 0, 0), (0, 0, 1)).area)


def test_lists_may_be_nested_deep_but_not_contain_themselves():
    ball = rw.Sphere()
    deep = ball
    for _ in range(5000):
        deep = [deep]
    assert rw.Scene([deep, (ball, [ball])]).shapes == (ball,) * 3
    twice = [ball]
    assert rw.Scene([twice, twice]).shapes == (ball, ball)
    for outer in ([], [ball]):
        inner = [outer]
        outer.append(inner)
        with pytest.raises(ValueError, match="shapes must not be a list that contains itself"):
            rw.Scene(outer)
