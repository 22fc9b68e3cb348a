"""Scenes as arrays without pointers: what their bytes are promised to be, and a walk by nothing else."""

import numpy as np
import pytest

import raywright as rw

KNOT = rw.scenes.torus_knot(along=40, around=8)
SCENES = {
    "knot": [KNOT],
    "far and small": [rw.Mesh(KNOT.vertices * 1e-3 + np.array([1e4, 0, 0]), KNOT.faces)],
    "parted": rw.scenes.diagonal_wall(boards=40),
    "several": [rw.Mesh(KNOT.vertices + 2.0, KNOT.faces), rw.Sphere((0, 0, 0), 1), KNOT],
    "one": [rw.Mesh([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])],
    "nothing": [],
}


def after(nodes, i):
    """Return the node after all that is below a node."""
    return i + 1 if nodes["count"][i] else int(nodes["index"][i])


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("builder", ["binned", "spatial", "median"])
def test_arrays_are_what_they_are_said_to_be(name, builder):
    scene = rw.Scene(SCENES[name], accelerator=rw.BVH(builder=builder))
    flat = scene.gpu_arrays()
    nodes, triangles = flat.nodes, flat.triangles
    assert nodes.dtype.itemsize == 32
    assert triangles.dtype.itemsize == 48
    assert [nodes.dtype.fields[f][1] for f in nodes.dtype.names] == [0, 12, 16, 28]
    assert [triangles.dtype.fields[f][1] for f in triangles.dtype.names] == [0, 12, 16, 28, 32, 44]
    assert not nodes.flags.writeable
    assert not triangles.flags.writeable
    assert flat.bytes == 32 * len(nodes) + 48 * len(triangles)
    assert flat.own == len(nodes)
    if not scene.shapes:
        assert (len(nodes), len(triangles), flat.depth) == (0, 0, 0)
        return
    # Every node precedes its children, siblings are adjacent, and so are leaves.
    behind = np.where(nodes["count"], np.arange(len(nodes)) + 1, nodes["index"])
    inner, leaves = np.flatnonzero(nodes["count"] == 0), np.flatnonzero(nodes["count"])
    first = inner + 1
    second = behind[first]
    assert behind[0] == len(nodes)
    np.testing.assert_array_equal(behind[second], behind[inner])
    for child in (first, second):
        assert (nodes["lower"][child] >= nodes["lower"][inner]).all()
        assert (nodes["upper"][child] <= nodes["upper"][inner]).all()
    depth = np.zeros(len(nodes), int)
    for i, *children in zip(inner, first, second, strict=True):
        depth[children] = depth[i] + 1
    assert depth.max() == flat.depth
    counts = nodes["count"][leaves].astype(int)
    np.testing.assert_array_equal(nodes["index"][leaves], np.cumsum(counts) - counts)
    assert counts.sum() == len(triangles)
    lower, upper = (np.repeat(nodes[end][leaves], counts, axis=0) for end in ("lower", "upper"))
    is_face = triangles["largest"] >= 0
    if builder != "spatial" and name != "parted":
        for edge in (0, triangles["edge"], triangles["other"]):
            point = (triangles["corner"] + edge)[is_face]
            assert (point >= lower[is_face] - 1e-6).all()
            assert (point <= upper[is_face] + 1e-6).all()
        assert (triangles["corner"] >= lower)[~is_face].all()
        assert (triangles["edge"] <= upper)[~is_face].all()
    # Every primitive is in some leaf, and in one only unless split.
    assert set(triangles["primitive"]) == set(range(flat.first[-1]))
    if builder == "median":
        assert len(triangles) == flat.first[-1]
    assert len(flat.first) == len(scene.shapes) + 1


@pytest.mark.parametrize("name", ["knot", "far and small", "several"])
def test_triangles_are_those_of_the_scene(name):
    scene = rw.Scene(SCENES[name], precision="double")
    flat = scene.gpu_arrays()
    assert np.log2(flat.scale) % 1 == 0
    for shape, first in zip(scene.shapes, flat.first, strict=False):
        if not isinstance(shape, rw.Mesh):
            (box,) = flat.triangles[flat.triangles["primitive"] == first]
            assert box["largest"] == -1
            lower, upper = (box[end] / flat.scale + flat.center for end in ("corner", "edge"))
            assert lower == pytest.approx(-np.ones(3), abs=1e-5)
            assert upper == pytest.approx(np.ones(3), abs=1e-5)
            continue
        corners = np.asarray(shape.vertices, float)[shape.faces]
        number = flat.triangles["primitive"].astype(int) - first
        mine = (number >= 0) & (number < len(corners))
        corners, some = corners[number[mine]], flat.triangles[mine]
        # Starting at the corner of the shortest edge.
        edges = np.roll(corners, -1, axis=1) - corners
        shortest = np.argmin((edges**2).sum(axis=-1), axis=1)
        a, b, c = (corners[np.arange(len(corners)), (shortest + i) % 3] for i in range(3))
        # Differences come before any rounding.
        assert (some["corner"] == ((a - flat.center) * flat.scale).astype(np.float32)).all()
        assert (some["edge"] == ((b - a) * flat.scale).astype(np.float32)).all()
        assert (some["other"] == ((c - a) * flat.scale).astype(np.float32)).all()
        edges = np.abs(np.concatenate([some["edge"], some["other"]], axis=1))
        assert (some["largest"] == edges.max(axis=1)).all()
        assert np.abs(some["corner"]).max() <= 2


def walked(flat, start, direction, i, end, best=(np.inf, ())):
    """Return t and the primitive that a ray in box units hits first, by the arrays alone, without a stack."""
    while i < end:
        node = flat.nodes[i]
        ends = (np.stack([node["lower"], node["upper"]]) - start) / direction
        near, far = ends.min(axis=0).max(), ends.max(axis=0).min()
        if near > far + 1e-5 or far < 0 or near > best[0]:
            i = after(flat.nodes, i)
            continue
        for one in flat.triangles[node["index"] : node["index"] + node["count"]] if node["count"] else ():
            if one["instance"]:
                copy = flat.instances[one["instance"] - 1]
                assert copy["primitive"] == one["primitive"]
                turn, shift = copy["matrix"][:, :3].astype(float), copy["matrix"][:, 3]
                within = (turn @ start + shift, turn @ direction, int(copy["node"]), int(copy["end"]))
                t, inner = walked(flat, *within, (best[0], ()))
                best = (t, (int(one["primitive"]), *inner)) if inner else best
                continue
            edges = np.stack([one["edge"], one["other"], -direction], axis=1).astype(float)
            u, v, t = np.linalg.solve(edges, start - one["corner"])
            if u >= 0 and v >= 0 and u + v <= 1 and 0 <= t < best[0]:
                best = t, (int(one["primitive"]),)
        i += 1
    return best


def test_a_walk_of_a_few_lines_finds_what_the_scene_does():
    scene = rw.Scene(KNOT)
    random = np.random.default_rng(4)
    origins = random.uniform(-4, 4, (60, 3))
    directions = random.uniform(-1, 1, (60, 3)) - origins
    flat = scene.gpu_arrays()
    local = (origins - flat.center) * flat.scale
    found = [walked(flat, *ray, 0, flat.own)[1] for ray in zip(local, directions, strict=True)]
    hits = scene.intersect(origins, directions)
    assert hits.hit.sum() > 15
    assert found == [(p,) if p >= 0 else () for p in hits.primitive_id.tolist()]


def test_copies_are_entered_by_their_matrices():
    random = np.random.default_rng(7)
    moves = np.tile(np.eye(4), (5, 1, 1))
    moves[:, :3, :3] += random.uniform(-0.4, 0.4, (5, 3, 3))
    moves[:, :3, 3] = random.uniform(-4, 4, (5, 3))
    # Also nested, and the same one twice.
    inner = rw.Instance([KNOT], moves[:2])
    pair = rw.Instance([inner, rw.Mesh(KNOT.vertices + 3, KNOT.faces)], moves[2:4])
    scene = rw.Scene([rw.Instance([KNOT], moves), KNOT, pair])
    flat = scene.gpu_arrays()
    assert flat.instances.dtype.itemsize == 64
    assert [flat.instances.dtype.fields[f][1] for f in flat.instances.dtype.names] == [0, 48, 52, 56, 60]
    # Five and two in the scene, two in the pair; the knot's tree exists once.
    assert len(flat.instances) == 9
    assert len({int(one["node"]) for one in flat.instances}) == 2
    assert flat.own == after(flat.nodes, 0) < len(flat.nodes)
    hits = scene.intersect(*(rays := random_aimed(random, moves)))
    assert len(set(hits.shape_id.tolist())) == 4
    local = (rays[0] - flat.center) * flat.scale
    for i, (origin, direction) in enumerate(zip(local, rays[1], strict=True)):
        t, found = walked(flat, origin, direction, 0, flat.own)
        assert bool(found) == hits.hit[i]
        if found:
            shape, number = hits.shape_id[i], found[0] - flat.first[hits.shape_id[i]]
            assert t == pytest.approx(hits.t[i] * flat.scale, rel=1e-4)
            assert number == (hits.primitive_id[i] if shape == 1 else hits.instance_id[i])


def random_aimed(random, moves, count=80):
    """Return rays from about copies to where they may be."""
    at = moves[random.integers(0, len(moves), count), :3, 3] + random.uniform(-2, 2, (count, 3))
    origins = random.uniform(-12, 12, (count, 3))
    return origins, at - origins


def test_what_has_no_end_stands_apart():
    flat = rw.Scene([rw.Plane((0, 0, 0), (0, 0, 1)), KNOT]).gpu_arrays()
    assert flat.unbounded.tolist() == [0]
    assert flat.triangles["primitive"].min() == 1
    assert (
        repr(flat)
        == f"GpuArrays({len(flat.nodes)} nodes, {len(flat.triangles)} triangles, depth {flat.depth})"
    )


def test_other_accelerators_have_flat_arrays_too():
    flat = rw.Scene(KNOT, accelerator=rw.accelerators.Grid()).gpu_arrays()
    assert flat.nodes.tobytes() == rw.Scene(KNOT).gpu_arrays().nodes.tobytes()
