"""`t` of a mesh in an instance is the float64 nearest to the exact one, and the ends are compared with it."""

from fractions import Fraction

import numpy as np
import pytest
import trimesh

import raywright as rw


def turn(rng):
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


def matrix(linear, shift=(0, 0, 0)):
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = linear, shift
    return result


#: What is put where, from the inside outwards.
MAPS = {
    "whole": [matrix(np.eye(3), (3, -2, 5))],
    "tenths": [matrix(np.eye(3), (0.1, 0.3, -0.7))],
    "three": [matrix(3 * np.eye(3), (1, 2, 3))],
    "tenth": [matrix(np.eye(3) * 0.1)],
    "quarter": [matrix([[0, -1, 0], [1, 0, 0], [0, 0, 1]], (1, 2, 3))],
    "turned": [matrix(turn(np.random.default_rng(1)), (1, 2, 3))],
    "uneven": [matrix(turn(np.random.default_rng(2)) * (0.1, 2, 7), (0.4, 2.5, -3))],
    "mirrored": [matrix(np.diag((-1, 2, 0.3)), (1, 0, 0))],
    "sheared": [matrix([[1, 0.3, 0], [0, 1, -2.1], [0.7, 0, 1]], (1e3, 0.2, 0))],
    "nested": [
        matrix(turn(np.random.default_rng(3)) * (0.5, 2, 3), (0.1, 0.2, 0.3)),
        matrix(turn(np.random.default_rng(4)), (-7.7, 0, 1)),
        matrix(np.eye(3) / 3, (0.1, 0, 0)),
    ],
}

SHAPES = {
    "mesh": rw.Mesh((ball := trimesh.creation.icosphere(subdivisions=1)).vertices, ball.faces),
    "sphere": rw.Sphere((0, 0, 0), 1),
    "cylinder": rw.Cylinder((0, 0, -1), (0, 0, 1), 0.8),
}


def placed(shape, maps):
    for m in maps:
        shape = rw.Instance(shape, m)
    return shape


def rays_to(maps, count, seed):
    """Rays from some sizes away to where a shape of radius 1 about the origin is put, of several lengths."""
    rng = np.random.default_rng(seed)
    total = np.eye(4)
    for m in maps:
        total = m @ total
    size = np.linalg.norm(total[:3, :3], axis=1).max()
    origins = total[:3, 3] + rng.normal(size=(count, 3)) * size * rng.choice([0.1, 3.0, 100.0], (count, 1))
    targets = rng.uniform(-0.5, 0.5, (count, 3)) @ total[:3, :3].T + total[:3, 3]
    return origins, (targets - origins) * rng.choice([1e-5, 0.3, 1.0, 8.0], (count, 1))


def exact_t(origin, direction, corners):
    o, d = ([Fraction(x) for x in v] for v in (origin, direction))
    a, e, f = corners[0], *([x - y for x, y in zip(c, corners[0], strict=True)] for c in corners[1:])
    n = [e[i - 2] * f[i - 1] - e[i - 1] * f[i - 2] for i in range(3)]
    return sum(n[i] * (a[i] - o[i]) for i in range(3)) / sum(n[i] * d[i] for i in range(3))


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("maps", MAPS.values(), ids=MAPS)
def test_t_is_the_f64_nearest_to_that_of_the_map_as_given(maps, precision):
    mesh = SHAPES["mesh"]
    vertices = mesh.vertices.astype(np.float32) if precision == "single" else mesh.vertices
    corners = [[Fraction(float(x)) for x in v] for v in vertices]
    for m in maps:
        rows = [[Fraction(float(x)) for x in row] for row in m[:3]]
        corners = [[sum(r[i] * v[i] for i in range(3)) + r[3] for r in rows] for v in corners]
    origins, directions = rays_to(maps, 150, 5)
    hits = rw.Scene(placed(mesh, maps), precision=precision).intersect(origins, directions)
    assert hits.hit.sum() > 100
    for i in np.flatnonzero(hits.hit):
        face = mesh.faces[hits.primitive_id[i]]
        assert hits.t[i] == float(exact_t(origins[i], directions[i], [corners[k] for k in face]))


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
@pytest.mark.parametrize("maps", MAPS.values(), ids=MAPS)
def test_the_ends_of_a_ray_are_compared_with_the_t_that_is_told(maps, shape):
    scene = rw.Scene([placed(shape, maps), rw.Sphere((1e6, 0, 0), 1)])
    origins, directions = rays_to(maps, 1500, 6)
    hits = scene.intersect(origins, directions)
    met = hits.hit & (hits.shape_id == 0)
    rays, t, primitive = (origins[met], directions[met]), hits.t[met], hits.primitive_id[met]
    below, above = np.nextafter(t, -np.inf), np.nextafter(t, np.inf)
    assert len(t) > 1000
    np.testing.assert_array_equal(scene.occluded(*rays), True)
    for t_min, t_max in ((0, t), (t, np.inf), (t, t), (below, above), (-np.inf, t)):
        again = scene.intersect(*rays, t_min, t_max)
        assert (again.t <= t).all() if np.ndim(t_min) == 0 and t_min < 0 else np.array_equal(again.t, t)
        assert scene.occluded(*rays, t_min, t_max).all()
        assert scene.intersect(*rays, t_min, t_max, shapes=[True, False]).hit.all()
        every = scene.intersect_all(*rays, t_min, t_max)
        starts = every.ray_splits[:-1]
        np.testing.assert_array_equal(every.t[starts], again.t)
        np.testing.assert_array_equal(scene.count_hits(*rays, t_min, t_max), np.diff(every.ray_splits))
    np.testing.assert_array_equal(scene.intersect(*rays, t, t).primitive_id, primitive)
    assert not scene.occluded(*rays, 0, below).any()
    assert not scene.intersect(*rays, 0, below).hit.any()
    assert not scene.count_hits(*rays, 0, below).any()
    assert (scene.intersect(*rays, above).t > t).all()
    beyond = scene.intersect_all(*rays, above)
    assert (beyond.t >= above[beyond.ray]).all()


@pytest.mark.parametrize(("scale", "shift"), [(1, 0.1), (3, 0), (0.1, 7), (0.7, -0.3)])
def test_a_flat_face_is_met_where_it_stands(scale, shift):
    square = rw.Mesh([(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], [(0, 1, 2), (0, 2, 3)])
    scene = rw.Scene(rw.Instance(square, matrix(np.eye(3) * scale, (0, 0, shift))))
    rng = np.random.default_rng(0)
    origins = np.c_[rng.uniform(0, scale, (2000, 2)), rng.uniform(10, 1000, 2000)]
    face = Fraction(scale) + Fraction(shift)
    t = np.array([float(Fraction(z) - face) for z in origins[:, 2]])
    down = (0, 0, -1)
    np.testing.assert_array_equal(scene.intersect(origins, down).t, t)
    assert scene.occluded(origins, down, t_max=t).all()
    assert scene.occluded(origins, down, t_min=t).all()
    assert not scene.occluded(origins, down, t_max=np.nextafter(t, 0)).any()
    assert not scene.occluded(origins, down, t_min=np.nextafter(t, np.inf)).any()
