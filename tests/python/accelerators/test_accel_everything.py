"""Every structure on every kind of scene, a hundred thousand rays each: all answer as brute force does."""

import numpy as np
import pytest

import raywright as rw
from raywright.accelerators import every

pytestmark = pytest.mark.slow

COUNT = 100_000


def soup(rng, count, size):
    corners = rng.uniform(-1, 1, (count, 1, 3)) + size * rng.normal(size=(count, 3, 3))
    return rw.Mesh(corners.reshape(-1, 3).astype(np.float32), np.arange(3 * count).reshape(-1, 3))


def curved():
    turned = [[0.8, -0.6, 0, 0.1], [1.2, 1.6, 0, 0], [0, 0, 0.5, -0.2], [0, 0, 0, 1]]
    return [
        rw.Sphere((0.5, 0, 0), 0.4),
        rw.Plane((0, -1.2, 0), (0.1, 1, 0)),
        rw.Disk((-0.5, 0.5, 0), (0, 1, 1), 0.5, inner_radius=0.2),
        rw.Cylinder((-1, -1, 0), (-0.7, 0.2, 0.5), 0.2, transform=turned),
        rw.Cone((0, 0.5, 0.5), (0, 1, 0.5), 0.3, 0.0),
        rw.Box((0.2, 0.2, -1), (0.6, 0.5, -0.5)),
        rw.shapes.Ellipsoid((0, -0.6, 0.5), (0.6, 0.1, 0.3)),
        rw.shapes.Paraboloid((0.8, -1, 0.8), (0.8, -0.4, 0.8), 0.3),
        rw.Torus((-0.3, 0, -0.6), (0, 1, 1), 0.4, 0.1),
        rw.Polygon([(-1, 0.9, -1), (1, 0.9, -1), (1, 0.9, 1), (0, 0.9, 0), (-1, 0.9, 1)]),
        rw.shapes.Implicit("x**2 + y**2 - z**2 - 0.02", (-0.4, -0.4, -0.4), (0.4, 0.4, 0.4)),
    ]


def scenes():
    rng = np.random.default_rng(0)
    flat = soup(rng, 300, 0.2)
    coplanar = rw.Mesh(flat.vertices * np.array([1, 1, 0], np.float32), flat.faces)
    one = soup(rng, 1, 0.5)
    mixed = [
        rw.Mesh(soup(rng, 40, 0.3).vertices * s, np.arange(120).reshape(-1, 3)) for s in (1e-6, 1e-3, 1, 1e3)
    ]
    moves = np.tile(np.eye(4), (20, 1, 1))
    moves[:, :3, 3] = rng.uniform(-1, 1, (20, 3))
    return {
        "empty": [],
        "single": [one],
        "coincident": [rw.Mesh(one.vertices, np.tile(one.faces, (200, 1)))],
        "coplanar": [coplanar],
        "huge and tiny": mixed,
        "soup": [soup(rng, 1000, 0.1)],
        "long and thin": [soup(rng, 300, np.array([1.0, 1.0, 1e-3]))],
        "curved": curved(),
        "curved among faces": [*curved(), soup(rng, 300, 0.1)],
        "copies": [rw.Instance([soup(rng, 20, 0.1), rw.Sphere((0, 0, 0), 0.1)], moves), soup(rng, 100, 0.1)],
    }


@pytest.mark.parametrize("name", scenes())
def test_no_structure_ever_disagrees(name):
    shapes = scenes()[name]
    rng = np.random.default_rng(1)
    origins = rng.uniform(-2, 2, (COUNT, 3))
    targets = rng.uniform(-1, 1, (COUNT, 3)) * rng.choice([1e-3, 1.0], (COUNT, 1))
    directions = targets - origins
    # A tenth each along an axis, and in a plane across one.
    tenth = COUNT // 10
    directions[:tenth] = np.eye(3)[rng.integers(0, 3, tenth)] * rng.choice([-1.0, 1.0], (tenth, 1))
    directions[tenth : 2 * tenth, rng.integers(0, 3)] = 0.0
    wanted = rw.Scene(shapes, accelerator=rw.BruteForce()).intersect(origins, directions)
    assert wanted.hit.any() == (name != "empty")
    for told, accelerator in every().items():
        scene = rw.Scene(shapes, accelerator=accelerator)
        hits = scene.intersect(origins, directions)
        wrong = (
            (hits.t != wanted.t)
            | (hits.shape_id != wanted.shape_id)
            | (hits.primitive_id != wanted.primitive_id)
        )
        wrong |= (hits.uv != wanted.uv).any(axis=-1) | (hits.instance_id != wanted.instance_id)
        wrong |= scene.occluded(origins, directions) != wanted.hit
        assert np.count_nonzero(wrong) == 0, told
