"""Scenes whose vertices are kept in f64."""

import exact_hits
import numpy as np
import pytest
import trimesh

import raywright as rw

PLACES = [(1.0, 0.0), (1.0, 1e7), (1e-6, 0.0), (1e-6, 1.0), (1e6, 1e12)]


def ball(scale=1.0, offset=0.0, subdivisions=1):
    sphere = trimesh.creation.icosphere(subdivisions=subdivisions)
    return rw.Mesh(sphere.vertices * scale + offset * np.array([1.0, -0.7, 0.3]), sphere.faces)


def aimed(mesh, rng, count, inside=False):
    """Rays at vertices, middles of edges and anywhere on faces, as exactly as f64 can aim."""
    low, high = mesh.bounds
    center, size = (low + high) / 2, (high - low).max()
    start = rng.normal(size=(count, 3))
    start *= size * (0.2 if inside else 1.5) / np.linalg.norm(start, axis=1, keepdims=True)
    corners = mesh.vertices[mesh.faces[rng.integers(0, len(mesh.faces), count)]]
    weights = rng.dirichlet((1.0, 1, 1), count)
    weights[::3] = (1, 0, 0)
    weights[1::3] = (0.5, 0.5, 0)
    origins = center + start
    return origins, (weights[..., None] * corners).sum(axis=1) - origins


@pytest.mark.parametrize(("scale", "offset"), PLACES)
def test_hits_are_those_of_exact_arithmetic_on_the_given_vertices(scale, offset):
    mesh = ball(scale, offset)
    assert (mesh.vertices.astype(np.float32) != mesh.vertices).any()
    outcome = exact_hits.check(mesh, *aimed(mesh, np.random.default_rng(1), 250), precision="double")
    assert outcome.hits > 150
    assert outcome.choices > 100


@pytest.mark.parametrize(("scale", "offset"), PLACES)
def test_no_ray_from_inside_gets_out(scale, offset):
    mesh = ball(scale, offset, subdivisions=3)
    scene = rw.Scene(mesh, precision="double")
    rays = aimed(mesh, np.random.default_rng(2), 30_000, inside=True)
    assert scene.intersect(*rays).hit.all()
    assert (scene.count_hits(*rays) % 2 == 1).all()
    assert scene.contains(rays[0]).all()
    outside = aimed(mesh, np.random.default_rng(3), 30_000)
    assert (scene.count_hits(*outside) % 2 == 0).all()
    assert not scene.contains(outside[0]).any()


def test_slivers_far_away():
    rng = np.random.default_rng(4)
    start = 1e7 + rng.normal(size=(60, 3))
    along, across = rng.normal(size=(2, 60, 3))
    mesh = rw.Mesh(
        np.stack([start, start + along, start + along / 2 + 1e-7 * across], axis=1).reshape(-1, 3),
        np.arange(180).reshape(-1, 3),
    )
    outcome = exact_hits.check(mesh, *aimed(mesh, rng, 200), precision="double")
    assert outcome.hits > 20


def test_what_single_precision_would_lose_is_kept():
    """Two sheets whose distance is a thousandth of f32's step."""
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0.0)])
    sheets = [rw.Mesh(square + np.array([0, 0, 1 + gap]), [(0, 1, 2), (0, 2, 3)]) for gap in (0, 1e-10)]
    hits = rw.Scene(sheets, precision="double").intersect_all((0.3, 0.4, 0), (0, 0, 1))
    assert np.allclose(hits.t, (1, 1 + 1e-10), rtol=1e-15, atol=0)
    assert rw.Scene(sheets).intersect_all((0.3, 0.4, 0), (0, 0, 1)) == hits
    single = rw.Scene(sheets, precision="single")
    assert np.array_equal(single.intersect_all((0.3, 0.4, 0), (0, 0, 1)).t, (1, 1))


def test_vertices_that_are_f32_cost_no_more():
    mesh = rw.scenes.torus_knot(along=40, around=6)
    single = rw.Mesh(mesh.vertices.astype(np.float32).astype(np.float64), mesh.faces)
    scenes = [rw.Scene(single, precision=p) for p in ("single", "double")]
    assert scenes[0].bytes == scenes[1].bytes
    assert scenes[0].accelerator_info.kind == scenes[1].accelerator_info.kind
    rays = np.random.default_rng(5).normal(size=(2, 2000, 3))
    assert scenes[0].intersect(*rays) == scenes[1].intersect(*rays)


def test_positions_are_on_the_given_faces():
    mesh = ball(1.0, 1e7)
    hits = rw.Scene(mesh, precision="double").intersect(*aimed(mesh, np.random.default_rng(6), 300))
    corners = mesh.vertices[mesh.faces[hits.primitive_id[hits.hit]]]
    u, v = hits.uv[hits.hit].T[..., None]
    wanted = (1 - u - v) * corners[:, 0] + u * corners[:, 1] + v * corners[:, 2]
    assert np.allclose(hits.position[hits.hit], wanted, rtol=1e-15, atol=0)
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    assert np.allclose(
        hits.normal[hits.hit], normal / np.linalg.norm(normal, axis=1, keepdims=True), atol=1e-15
    )
