"""Rays that are asked of some shapes alone, of what faces them, or not at all."""

import numpy as np
import pytest

import raywright as rw

KINDS = [
    rw.BVH(),
    rw.BVH(traversal="stack"),
    rw.accelerators.KdTree(),
    rw.accelerators.Octree(),
    rw.accelerators.BSP(),
    rw.accelerators.Grid(),
    rw.BruteForce(),
]
IDS = ["wide", "stack", "kdtree", "octree", "bsp", "grid", "brute"]


def soup(seed, count=300):
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1, 1, (count, 1, 3)) + rng.normal(scale=0.2, size=(count, 3, 3))
    return rw.Mesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3), name=f"soup {seed}")


def many():
    """Meshes, curved shapes and copies."""
    places = np.tile(np.eye(4), (3, 1, 1))
    places[:, :3, 3] = [(-0.5, 0.2, 0), (0.6, 0, 0.1), (0.1, -0.7, 0.3)]
    places[2, 0, 0] = -0.8
    return [
        soup(1),
        rw.Sphere((0.2, 0.1, 0), 0.5, name="ball"),
        soup(2),
        rw.Instance([soup(3, 40), rw.Torus((0, 0, 0), (0, 0, 1), 0.4, 0.1)], places, name="copies"),
        rw.Box((-0.3, -0.9, -0.4), (0.1, -0.2, 0.5)),
        rw.scenes.torus_knot(along=60, around=8),
    ]


def rays(count=1500, seed=9):
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(count, 3)) * 1.5
    return origins, rng.uniform(-1, 1, (count, 3)) - origins


SHAPES = many()
KEPT = np.array([False, True, True, True, False, True])


def as_alone(hits, kept):
    """The same of a scene of the kept shapes alone: shapes are numbered among all."""
    return np.append(np.flatnonzero(kept), -1)[hits.shape_id]


@pytest.mark.parametrize("accelerator", KINDS, ids=IDS)
def test_what_does_not_count_is_as_if_it_were_not_there(accelerator):
    every = rw.Scene(SHAPES, accelerator=accelerator)
    alone = rw.Scene(
        [shape for shape, counts in zip(SHAPES, KEPT, strict=True) if counts], accelerator=accelerator
    )
    found, wanted = every.intersect(*rays(), shapes=KEPT), alone.intersect(*rays())
    assert 300 < wanted.hit.sum() < 1500
    for name in ("t", "primitive_id", "uv", "instance_id"):
        assert np.array_equal(getattr(found, name), getattr(wanted, name)), name
    assert np.array_equal(found.shape_id, as_alone(wanted, KEPT))
    assert np.array_equal(found.position, wanted.position, equal_nan=True)
    assert np.array_equal(every.occluded(*rays(), shapes=KEPT), wanted.hit)
    all_found, all_wanted = every.intersect_all(*rays(), shapes=KEPT), alone.intersect_all(*rays())
    for name in ("ray_splits", "t", "primitive_id", "uv", "instance_id"):
        assert np.array_equal(getattr(all_found, name), getattr(all_wanted, name)), name
    assert np.array_equal(all_found.shape_id, as_alone(all_wanted, KEPT))
    # With all of them, results are unchanged.
    assert every.intersect(*rays(), shapes=np.ones(6, np.bool_)) == every.intersect(*rays())
    assert not every.occluded(*rays(), shapes=np.zeros(6, np.bool_)).any()


@pytest.mark.parametrize("accelerator", KINDS, ids=IDS)
def test_back_faces_are_left_out(accelerator):
    """The first hit is the first of all hits whose normal is against the ray."""
    scene = rw.Scene(SHAPES, accelerator=accelerator)
    origins, ways = rays()
    every = scene.intersect_all(origins, ways)
    front = (every.normal * ways[every.ray]).sum(axis=1) < 0
    first = np.full(len(ways), -1)
    first[every.ray[front][::-1]] = np.flatnonzero(front)[::-1]
    found = scene.intersect(origins, ways, cull="back")
    assert np.array_equal(found.hit, first >= 0)
    assert 100 < found.hit.sum() < scene.intersect(origins, ways).hit.sum()
    for name in ("t", "shape_id", "primitive_id", "uv", "instance_id"):
        assert np.array_equal(getattr(found, name)[found.hit], getattr(every, name)[first[found.hit]]), name
    assert np.array_equal(scene.occluded(origins, ways, cull="back"), found.hit)
    culled = scene.intersect_all(origins, ways, cull="back")
    assert np.array_equal(culled.ray, every.ray[front])
    for name in ("t", "shape_id", "primitive_id", "uv"):
        assert np.array_equal(getattr(culled, name), getattr(every, name)[front])
    assert culled.first == found


def test_no_ray_slips_through_edges_that_face_it(box):
    """Rays at the edges and corners of a closed mesh from outside meet a face that faces them, as near
    as any.
    """
    knot = rw.scenes.torus_knot(along=40, around=7)
    scene = rw.Scene(knot, precision="double")
    corners = knot.vertices[knot.faces].astype(np.float64)
    aims = np.concatenate([corners.reshape(-1, 3), corners.mean(axis=1), (corners[:, 0] + corners[:, 1]) / 2])
    eye = np.array([7.0, 5.0, 9.0])
    plain, culled = scene.intersect(eye, aims - eye), scene.intersect(eye, aims - eye, cull="back")
    assert culled.hit.sum() > 500
    # From outside, a closed surface shows its front first, except at outlines, where both sides coincide.
    assert np.array_equal(culled.hit, plain.hit)
    # At an edge, another of its faces may be the hit, with another rounding of t.
    assert np.allclose(culled.t, plain.t, rtol=1e-12)
    inside = rw.Scene(box).intersect(
        (0.5, 0.5, 0.5), np.array([(1, 1, 1), (1, 0, 0), (1, 1, 0)]) * 0.5, cull="back"
    )
    assert not inside.hit.any()


def test_the_other_way_round_it_is_the_back():
    """With every triangle turned round, what was met from behind is met from the front: together they
    are all.
    """
    mesh = soup(5)
    turned = rw.Mesh(mesh.vertices, mesh.faces[:, ::-1])
    one, other = (rw.Scene(m).intersect_all(*rays(), cull="back") for m in (mesh, turned))
    every = rw.Scene(mesh).intersect_all(*rays())
    assert one.t.size + other.t.size == every.t.size
    assert one.t.size > 500
    # A reversed triangle has another rounding of t.
    assert np.allclose(np.sort(np.concatenate([one.t, other.t])), np.sort(every.t), rtol=1e-12)


def test_rays_may_be_left_out():
    scene = rw.Scene(SHAPES)
    origins, ways = rays()
    which = np.arange(1500) % 3 == 0
    plain, masked = (
        scene.intersect(origins, ways, t_max=0.8),
        scene.intersect(origins, ways, t_max=0.8, mask=which),
    )
    assert np.array_equal(masked.t, np.where(which, plain.t, np.inf))
    assert np.array_equal(masked.primitive_id, np.where(which, plain.primitive_id, -1))
    assert np.array_equal(scene.occluded(origins, ways, mask=which), scene.occluded(origins, ways) & which)
    both = scene.intersect_all(origins, ways, mask=which, shapes=KEPT, cull="back")
    assert set(both.ray.tolist()) <= set(np.flatnonzero(which).tolist())
    assert not scene.intersect(origins, ways, mask=False).hit.any()
    grid = origins.reshape(30, 50, 3), ways.reshape(30, 50, 3)
    row = np.arange(50) < 20
    far = np.linspace(0.1, 2, 1500).reshape(30, 50)
    assert np.array_equal(
        scene.intersect(*grid, t_max=far, mask=row).t,
        np.where(row, scene.intersect(*grid, t_max=far).t, np.inf),
    )


def test_shapes_are_named():
    scene = rw.Scene(SHAPES)
    names = ("soup 1", "ball", "soup 2", "copies", "", "")
    assert scene.names == names
    hits = scene.intersect(*rays())
    assert np.array_equal(hits.names, np.array([*names, ""])[hits.shape_id])
    assert not hits.names.flags.writeable
    ball = scene.intersect(*rays(), shapes="ball")
    assert set(ball.names[ball.hit]) == {"ball"}
    two = scene.intersect(*rays(), shapes=["ball", "soup 2"])
    assert two == scene.intersect(*rays(), shapes=[False, True, True, False, False, False])
    again = np.zeros(1500)
    out = scene.intersect(*rays())
    assert scene.intersect(*rays(), out=out, shapes="ball") is out
    assert out == ball
    flags = np.zeros(1500, np.bool_)
    assert scene.occluded(*rays(), out=flags, shapes="ball") is flags
    assert np.array_equal(flags, ball.hit)
    assert again.shape == flags.shape


@pytest.mark.parametrize(
    ("arguments", "error", "told"),
    [
        ({"cull": "front"}, ValueError, """cull must be "back" or None, got 'front'"""),
        (
            {"shapes": "cube"},
            ValueError,
            "shapes has 'cube', which is not the name of a shape of the scene: its names are",
        ),
        ({"shapes": [True]}, ValueError, r"shapes must have shape \(6,\), one bool a shape, got \(1,\)"),
        (
            {"shapes": [0, 1]},
            TypeError,
            r"shapes must be bool, one for each shape, or names, got dtype int.*np.isin",
        ),
        (
            {"mask": [True, False]},
            ValueError,
            r"mask has shape \(2,\), which does not broadcast to rays of \(1500,\)",
        ),
        ({"mask": np.ones(1500)}, TypeError, "mask must be bool, one for each ray, got dtype float64"),
    ],
)
def test_wrong_masks_get_one_line(arguments, error, told):
    scene = rw.Scene(SHAPES)
    for ask in (scene.intersect, scene.occluded, scene.intersect_all):
        with pytest.raises(error, match=told):
            ask(*rays(), **arguments)
    with pytest.raises(ValueError, match="not the name of a shape of the scene: none has a name"):
        rw.Scene(rw.Sphere()).intersect((0, 0, 3), (0, 0, -1), shapes="ball")
