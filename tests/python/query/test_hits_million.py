"""Many rays in each stiff case, and no failure in any: facts about closed surfaces need no oracle.

There are a million each if `RAYWRIGHT_SLOW` is set, and an eighth otherwise.

From inside a closed surface every ray hits, and crosses it an odd number of times; from outside it crosses
an even number of times.
"""

import numpy as np
import pytest
import trimesh
from long_runs import part

import raywright as rw

pytestmark = pytest.mark.slow

BATCH = part(125_000, 8)
COUNT = 8 * BATCH


def ball():
    """A sphere, its vertices moved out at random by half the radius at most."""
    mesh = trimesh.creation.icosphere(subdivisions=4)
    rng = np.random.default_rng(0)
    return mesh.vertices * rng.uniform(1.0, 1.5, (len(mesh.vertices), 1)), mesh.faces


def placed(scale, offset, dtype):
    vertices, faces = ball()
    return rw.Mesh(((vertices + offset) * scale).astype(dtype), faces)


def goals(rng, mesh, count):
    """A third each: vertices, middles of edges, points anywhere on edges."""
    ends = mesh.vertices.astype(np.float64)[mesh.faces[rng.integers(len(mesh.faces), size=count), :2]]
    along = rng.choice([0.0, 0.5, -1.0], (count, 1))
    along = np.where(along < 0, rng.uniform(0, 1, (count, 1)), along)
    return ends[:, 0] * (1 - along) + ends[:, 1] * along


def ways(rng, count):
    directions = rng.normal(size=(count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def failures(scene, origins, directions, inside):
    """Count the rays whose answers cannot be, by themselves or beside another query's."""
    crossings = scene.count_hits(origins, directions)
    hit = scene.intersect(origins, directions).hit
    wrong = (crossings % 2 == 0) if inside else (crossings % 2 == 1)
    if inside:
        wrong |= ~hit
    wrong |= hit != (crossings > 0)
    wrong |= hit != scene.occluded(origins, directions)
    return np.count_nonzero(wrong)


@pytest.mark.parametrize(
    ("scale", "offset", "dtype"),
    [(scale, offset, np.float32) for scale in (1e-6, 1.0, 1e6) for offset in (0.0, 1e3, 1e5)]
    + [(1.0, 1e7, np.float64), (1e-6, 1e7, np.float64), (1e6, 1e7, np.float64)],
)
def test_vertices_edges_and_along_edges_at_any_scale_and_place(scale, offset, dtype):
    rng = np.random.default_rng(1)
    mesh = placed(scale, offset, dtype)
    # At 1e5 an f32 resolves the vertices to a hundredth: the surface differs, but is still closed.
    scene = rw.Scene(mesh, precision="double" if dtype is np.float64 else "single")
    center = (mesh.bounds[0] + mesh.bounds[1]) / 2
    failed = 0
    # Half of the rays from inside, half from outside.
    for _ in range(COUNT // BATCH // 2):
        targets = goals(rng, mesh, BATCH)
        inner = (center + 0.2 * scale * ways(rng, BATCH) * rng.uniform(0, 1, (BATCH, 1))).astype(dtype)
        failed += failures(scene, inner, (targets - inner).astype(dtype), inside=True)
        outer = (center + 4 * scale * ways(rng, BATCH)).astype(dtype)
        failed += failures(scene, outer, (targets - outer).astype(dtype), inside=False)
    # Along edges: from beyond one end of an edge towards the other.
    ends = mesh.vertices.astype(np.float64)[mesh.faces[rng.integers(len(mesh.faces), size=BATCH), :2]]
    along = ends[:, 1] - ends[:, 0]
    far = ends[:, 0] - along * np.exp2(rng.integers(8, 12, (BATCH, 1)))
    failed += failures(scene, far, along, inside=False)
    assert failed == 0


@pytest.mark.parametrize("aspect", [1e3, 1e4, 1e5, 1e6, 1e7, 1e8])
def test_slivers(aspect):
    """A box as long as it is wide, and one over the aspect high: its sides are slivers, seen from inside."""
    rng = np.random.default_rng(2)
    box = trimesh.creation.box((2, 2, 2)).subdivide()
    size = np.array([1.0, 1.0, 1.0 / aspect])
    mesh = rw.Mesh((box.vertices * size).astype(np.float32), box.faces)
    scene = rw.Scene(mesh)
    failed = 0
    for batch in range(COUNT // BATCH):
        dtype = (np.float32, np.float64)[batch % 2]
        origins = (rng.uniform(-0.9, 0.9, (BATCH, 3)) * size).astype(dtype)
        failed += failures(scene, origins, (goals(rng, mesh, BATCH) - origins).astype(dtype), inside=True)
    assert failed == 0


@pytest.mark.parametrize("angle", [1e-1, 1e-3, 1e-5, 1e-7])
def test_grazing_angles(angle):
    """Inside a box, at an angle to its floor; where the floor is met is known in closed form."""
    rng = np.random.default_rng(3)
    box = trimesh.creation.box((2, 2, 2)).subdivide().subdivide()
    scene = rw.Scene(rw.Mesh(box.vertices.astype(np.float32), box.faces))
    failed = 0
    for _ in range(COUNT // BATCH):
        # So low that the ray hits the floor within half of the box.
        height = angle * rng.uniform(0.1, 0.5, BATCH)
        turn = rng.uniform(0, 2 * np.pi, BATCH)
        origins = np.stack([*rng.uniform(-0.4, 0.4, (2, BATCH)), -1 + height], axis=1)
        directions = np.stack([np.cos(turn), np.sin(turn), np.full(BATCH, -angle)], axis=1)
        hits = scene.intersect(origins, directions)
        expected = (origins[:, 2] + 1) / angle
        failed += np.count_nonzero(~(np.abs(hits.t - expected) <= 1e-12 * (1 + expected)))
        failed += failures(scene, origins, directions, inside=True)
    assert failed == 0


@pytest.mark.parametrize("distance", [1e2, 1e4, 1e6, 1e8])
def test_origins_far_away(distance):
    """Rays towards points within the enclosed sphere hit, an even number of times."""
    rng = np.random.default_rng(4)
    mesh = placed(1.0, 0.0, np.float32)
    scene = rw.Scene(mesh)
    failed = 0
    for _ in range(COUNT // BATCH):
        origins = distance * ways(rng, BATCH)
        failed += failures(scene, origins, goals(rng, mesh, BATCH) - origins, inside=False)
        # The ray passes the target by a rounding of the distance: less than 1e-7.
        inner = 0.9 * ways(rng, BATCH) * rng.uniform(0, 1, (BATCH, 1))
        failed += np.count_nonzero(~scene.occluded(origins, inner - origins))
    assert failed == 0


@pytest.mark.parametrize("length", [1e-30, 1e-15, 1e15, 1e30])
def test_directions_of_any_length(length):
    rng = np.random.default_rng(5)
    mesh = placed(1.0, 0.0, np.float32)
    scene = rw.Scene(mesh)
    failed = 0
    for _ in range(COUNT // BATCH):
        origins = 0.2 * ways(rng, BATCH)
        failed += failures(scene, origins, (goals(rng, mesh, BATCH) - origins) * length, inside=True)
    assert failed == 0


@pytest.mark.parametrize("size", [1e-40, 1e-30, 1e-20, 1e-10, 1e10, 1e20, 1e30, 1e38])
def test_coordinates_of_any_size(size):
    rng = np.random.default_rng(6)
    # Subnormal f32 coordinates have steps of 1e-45: the surface differs, but is still closed.
    mesh = placed(size, 0.0, np.float32)
    scene = rw.Scene(mesh)
    failed = 0
    for _ in range(COUNT // BATCH):
        origins = 0.2 * size * ways(rng, BATCH)
        failed += failures(scene, origins, goals(rng, mesh, BATCH) - origins, inside=True)
    assert failed == 0


def test_triangles_without_area_in_the_way():
    rng = np.random.default_rng(7)
    vertices, faces = ball()
    closed = rw.Mesh(vertices.astype(np.float32), faces)
    # Points and lines, among them edges and vertices of the surface itself.
    corner, other = rng.integers(len(vertices), size=(2, 4000)).astype(np.uint32)
    nothing = np.concatenate([np.stack([corner, corner, other], axis=1), np.stack([corner] * 3, axis=1)])
    inner = np.concatenate([vertices, 0.5 * ways(rng, 4000)]).astype(np.float32)
    within = rng.integers(len(vertices), len(inner), size=4000).astype(np.uint32)
    nothing = np.concatenate([nothing, np.stack([within, within, corner], axis=1)])
    plain, strewn = rw.Scene(closed), rw.Scene(rw.Mesh(inner, np.concatenate([closed.faces, nothing])))
    failed = 0
    for _ in range(COUNT // BATCH):
        origins = 0.2 * ways(rng, BATCH)
        directions = goals(rng, closed, BATCH) - origins
        failed += failures(strewn, origins, directions, inside=True)
        a, b = plain.intersect(origins, directions), strewn.intersect(origins, directions)
        failed += np.count_nonzero((a.t != b.t) | (a.primitive_id != b.primitive_id))
    assert failed == 0


def test_rays_in_the_faces_of_boxes():
    """Cells of a closed grid, and rays that run in the planes of their faces; where they end is known."""
    rng = np.random.default_rng(8)
    box = trimesh.creation.box((2, 2, 2)).subdivide().subdivide().subdivide()
    scene = rw.Scene(rw.Mesh(box.vertices.astype(np.float32), box.faces))
    failed = 0
    for _ in range(COUNT // BATCH):
        origins = rng.integers(-7, 8, (BATCH, 3)) / 8
        directions = rng.integers(-1, 2, (BATCH, 3)).astype(float)
        directions[np.all(directions == 0, axis=1)] = [1.0, -0.0, 0.0]
        with np.errstate(divide="ignore", invalid="ignore"):
            walls = np.where(directions != 0, (np.sign(directions) - origins) / directions, np.inf)
        walls = walls.min(axis=1)
        failed += np.count_nonzero(scene.intersect(origins, directions).t != walls)
        failed += failures(scene, origins, directions, inside=True)
    assert failed == 0
