"""Nothing leaks: no ray from inside a closed mesh gets out, least of all through a vertex or an edge."""

import itertools

import numpy as np
import pytest
import trimesh

import raywright as rw

TYPES = [np.float32, np.float64]
# (scale, offset in scales): far from the origin the vertices of an f32 mesh move, but stay one and the same
# for all faces that share them.
PLACES = [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1000.0), (1e-6, 30.0), (1e6, -200.0)]


def sphere():
    mesh = trimesh.creation.icosphere(subdivisions=4)
    return mesh.vertices, mesh.faces


def noisy_sphere():
    """Radii from 0.6 to 1.4 at random: spikes, slivers and hollows; the center stays inside."""
    vertices, faces = sphere()
    rng = np.random.default_rng(0)
    return vertices * rng.uniform(0.6, 1.4, (len(vertices), 1)), faces


def cube():
    """Each face in 32 triangles, so that vertices lie on edges of the cube and in its faces."""
    mesh = trimesh.creation.box((2, 2, 2)).subdivide().subdivide()
    return mesh.vertices, mesh.faces


def torus():
    mesh = trimesh.creation.torus(1.0, 0.4, major_sections=64, minor_sections=32)
    return mesh.vertices, mesh.faces


# Each with a ball's radius around points that are inside it: the center, or for the torus, a circle.
MESHES = {
    "sphere": (sphere, 0.9),
    "noisy sphere": (noisy_sphere, 0.1),
    "cube": (cube, 0.9),
    "torus": (torus, 0.3),
}


def placed(name, scale, offset):
    make, room = MESHES[name]
    vertices, faces = make()
    mesh = rw.Mesh(((vertices + offset) * scale).astype(np.float32), faces)
    edges = np.sort(mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all(), "a closed mesh"
    return mesh, room


def inside(rng, name, room, count):
    """Points inside: in a ball around the center, in one around points of the torus's circle."""
    ways = rng.normal(size=(count, 3))
    points = ways / np.linalg.norm(ways, axis=1, keepdims=True) * room * rng.uniform(0, 1, (count, 1))
    points[: count // 10] = 0.0
    if name == "torus":
        turn = rng.uniform(0, 2 * np.pi, count)
        points += np.stack([np.cos(turn), np.sin(turn), np.zeros(count)], axis=1)
    return points


def targets(rng, mesh, count):
    """A third each: vertices, midpoints of edges, points anywhere on edges."""
    ends = mesh.vertices.astype(np.float64)[mesh.faces[rng.integers(len(mesh.faces), size=count), :2]]
    along = rng.choice([0.0, 0.5, -1.0], (count, 1))
    along = np.where(along < 0, rng.uniform(0, 1, (count, 1)), along)
    return ends[:, 0] * (1 - along) + ends[:, 1] * along


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize(("scale", "offset"), PLACES)
def test_no_ray_from_inside_gets_out(name, scale, offset, dtype):
    rng = np.random.default_rng(1)
    mesh, room = placed(name, scale, offset)
    scene = rw.Scene(mesh)
    count = 4_000
    origins = ((inside(rng, name, room, count) + offset) * scale).astype(dtype)
    aimed = (targets(rng, mesh, count) - origins).astype(dtype)
    anyhow = rng.normal(size=(count, 3)).astype(dtype)
    for directions in (aimed, anyhow):
        hits = scene.intersect(origins, directions)
        assert np.count_nonzero(~hits.hit) == 0
        assert np.count_nonzero(~scene.occluded(origins, directions)) == 0


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("name", ["sphere", "cube"])
@pytest.mark.parametrize(("scale", "offset"), PLACES)
def test_rays_aimed_at_a_convex_mesh_stop_at_their_target(name, scale, offset, dtype):
    """From inside and from outside: nothing slips through the near wall to be stopped by the far one."""
    rng = np.random.default_rng(2)
    mesh, room = placed(name, scale, offset)
    scene = rw.Scene(mesh)
    goals = targets(rng, mesh, 4_000)
    centered = goals / scale - offset
    inner = inside(rng, name, room, len(goals))
    # Outside, within about 45 degrees of a normal: seen so, a target cannot be beyond the rim.
    sideways = rng.normal(size=inner.shape) * 0.3
    outer = centered * 3 + sideways
    for starts in (inner, outer):
        origins = ((starts + offset) * scale).astype(dtype)
        hits = scene.intersect(origins, (goals - origins).astype(dtype))
        assert hits.hit.all()
        # The target is off by a rounding of the coordinates, here up to 1001, in f32 at worst: 6e-5 of a size
        # of 1, over a distance of 0.1 at least and at angles that lengthen it tenfold at most. The far wall
        # is no nearer than t = 1.05.
        assert np.abs(hits.t - 1).max() < 1e-2


@pytest.mark.parametrize("zero", [0.0, -0.0])
def test_rays_within_the_faces_and_edges_of_a_closed_grid(zero):
    """Inside a cube of cells, along lines that run in the planes and edges of its faces' triangles."""
    vertices, faces = cube()
    scene = rw.Scene(rw.Mesh(vertices.astype(np.float32), faces))
    # All coordinates are multiples of a quarter: each line lies in the planes of the grid, and ends in its
    # corners.
    inner = np.array(list(itertools.product(np.arange(-3, 4) / 4, repeat=3)))
    ways = np.array([w for w in itertools.product((-1.0, zero, 1.0), repeat=3) if any(w)])
    origins, directions = np.repeat(inner, len(ways), axis=0), np.tile(ways, (len(inner), 1))
    hits = scene.intersect(origins, directions)
    # The nearest wall along each direction, in closed form.
    with np.errstate(divide="ignore", invalid="ignore"):
        walls = np.where(directions != 0, (np.sign(directions) - origins) / directions, np.inf).min(axis=1)
    assert np.array_equal(hits.t, walls)
    assert scene.occluded(origins, directions, walls, walls).all()
    assert not scene.occluded(origins, directions, 0.0, np.nextafter(walls, 0)).any()


@pytest.mark.parametrize("dtype", TYPES)
def test_a_hundred_thousand_rays_through_vertices_never_pass(dtype):
    rng = np.random.default_rng(3)
    mesh, room = placed("noisy sphere", 1.0, 0.0)
    vertices = mesh.vertices.astype(np.float64)
    count = 100_000
    origins = inside(rng, "noisy sphere", room, count).astype(dtype)
    directions = (vertices[np.arange(count) % len(vertices)] - origins).astype(dtype)
    assert rw.Scene(mesh).occluded(origins, directions).all()
    assert rw.Scene(mesh).intersect(origins, directions).hit.all()
