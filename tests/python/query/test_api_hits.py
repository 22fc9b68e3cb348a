"""Hits coming out: what they hold, and that they are what they say."""

import copy
import dataclasses
import pickle

import numpy as np
import pytest

import raywright as rw


@pytest.fixture
def hits(scene):
    """Rays down onto the unit cube: some hit its top, some miss."""
    grid = np.stack(np.meshgrid(np.linspace(-0.45, 1.4, 6), np.linspace(-0.4, 1.45, 5)), axis=-1)
    origins = np.concatenate([grid, np.full((5, 6, 1), 3.0)], axis=-1)
    return scene.intersect(origins, (0, 0, -2.0))


@pytest.mark.parametrize(
    ("name", "dtype", "miss"),
    [
        ("hit", np.bool_, False),
        ("t", np.float64, np.inf),
        ("shape_id", np.int32, -1),
        ("primitive_id", np.int32, -1),
        ("instance_id", np.int32, -1),
        ("uv", np.float64, None),
        ("position", np.float64, np.nan),
        ("normal", np.float64, np.nan),
    ],
)
def test_arrays_have_their_types_and_say_what_missed(hits, name, dtype, miss):
    array = getattr(hits, name)
    assert array.dtype == dtype
    assert array.shape[:2] == (5, 6)
    assert array.flags.writeable == (dtype != np.int32)
    assert 0 < hits.hit.sum() < hits.hit.size
    if miss is not None:
        assert np.array_equal(
            array[~hits.hit], np.full_like(array[~hits.hit], miss), equal_nan=dtype == np.float64
        )


def test_hits_agree_with_each_other(hits, box):
    faces = box.faces[hits.primitive_id[hits.hit]]
    a, b, c = (box.vertices[faces[:, i]] for i in range(3))
    u, v = hits.uv[hits.hit].T[..., np.newaxis]
    assert (u >= 0).all()
    assert (v >= 0).all()
    assert (u + v <= 1 + 1e-12).all()
    assert np.allclose(hits.position[hits.hit], (1 - u - v) * a + u * b + v * c, atol=1e-14)
    assert np.array_equal(hits.t[hits.hit], np.ones(hits.hit.sum()))
    assert np.array_equal(hits.position[hits.hit][:, 2], np.ones(hits.hit.sum()))
    assert np.array_equal(hits.normal[hits.hit], np.broadcast_to((0.0, 0, 1), (hits.hit.sum(), 3)))
    assert (hits.shape_id[hits.hit] == 0).all()


def test_normal_follows_the_winding_from_both_sides(triangle):
    flipped = rw.Mesh(triangle.vertices, triangle.faces[:, ::-1])
    for z, way in ((1.0, -1.0), (-1.0, 1.0)):
        ray = ((0.2, 0.3, z), (0, 0, way))
        assert np.array_equal(rw.Scene(triangle).intersect(*ray).normal, (0, 0, 1))
        assert np.array_equal(rw.Scene(flipped).intersect(*ray).normal, (0, 0, -1))


def test_uv_are_weights_of_the_second_and_third_corner(triangle):
    hit = rw.Scene(triangle).intersect((0.25, 0.5, 1), (0, 0, -1))
    assert np.allclose(hit.uv, (0.25, 0.5), rtol=0, atol=1e-15)


def test_lazy_arrays_are_worked_out_once(hits):
    for name in ("hit", "instance_id", "position", "normal"):
        assert getattr(hits, name) is getattr(hits, name)


def test_shape_and_length(hits, scene):
    assert hits.shape == (5, 6)
    assert len(hits) == 5
    single = scene.intersect((0.5, 0.5, 5), (0, 0, -1))
    assert single.shape == ()
    assert bool(single.hit)
    with pytest.raises(TypeError):
        len(single)


def test_repr_counts_hits(scene):
    hits = scene.intersect([(0.5, 0.5, 5), (2, 2, 5)], (0, 0, -1))
    assert repr(hits) == "Hits(shape=(2,), 1 of 2 rays hit)"


def test_hits_have_no_other_arrays(hits):
    with pytest.raises(AttributeError):
        hits.t = np.zeros(3)


@pytest.mark.parametrize(
    "again", [lambda h: pickle.loads(pickle.dumps(h)), copy.deepcopy], ids=["pickle", "copy"]
)
def test_pickled_hits_keep_all_they_knew(hits, again):
    assert hits.position.shape == hits.normal.shape  # a pickle keeps what was asked for
    back = again(hits)
    assert back == hits
    assert np.array_equal(back.position, hits.position, equal_nan=True)
    assert np.array_equal(back.normal, hits.normal, equal_nan=True)
    assert back.t.flags.writeable
    assert back.normal.flags.writeable
    assert not back.primitive_id.flags.writeable


def test_equality_is_by_content(scene):
    rays = ((0.5, 0.4, 5), (0, 0, -1))
    assert scene.intersect(*rays) == scene.intersect(*rays)
    assert scene.intersect(*rays) != scene.intersect((0.5, 0.4, 6), (0, 0, -1))
    assert scene.intersect(*rays) != "hits"


def test_asdict_gives_the_arrays_and_nothing_of_the_scene(scene, hits):
    rays = (0.5, 0.4, 3.0), (0.0, 0.0, -2.0)
    corner = ("shape_id", "primitive_id", "uv", "instance_id")
    found = [
        (hits, {"t", *corner}),
        (scene.intersect(*rays), {"t", *corner}),
        (scene.intersect_all(*rays), {"ray_splits", "t", "shape", *corner}),
        (scene.closest_point([(2.0, 3.0, 4.0)]), {"distance", *corner}),
        (scene.traversal_cost(*rays), {"nodes", "primitives"}),
        (hits.surface, {"position", "error", "normal", "shading_normal", "dp_du", "dp_dv", "dn_du", "dn_dv"}),
        (scene.faces_in_cone(*rays, 10.0), {"cone_splits", "shape_id", "primitive_id", "distance", "shape"}),
    ]
    for points, names in [*found, *((pickle.loads(pickle.dumps(points)), names) for points, names in found)]:
        told = dataclasses.asdict(points)
        assert set(told) == names
        for name, value in told.items():
            kept = getattr(points, name)
            assert type(value) is type(kept)
            assert np.array_equal(value, kept, equal_nan=np.asarray(kept).dtype.kind == "f")
    # Copies of read-only arrays may be written to, and the hits stay unchanged.
    told = dataclasses.asdict(hits)
    told["t"][:] = 0
    assert hits.t.any()


def test_instances_are_among_what_asdict_gives():
    ball = rw.Instance(rw.scenes.torus_knot(along=30, around=6), [np.eye(4), np.diag([2.0, 2, 2, 1])])
    hits = rw.Scene([ball]).intersect(*rw.Camera((0, 0, 9), (0, 0, 0), width=9, height=9).rays())
    told = dataclasses.asdict(hits)["instance_id"]
    assert np.array_equal(told, hits.instance_id)
    assert set(told.ravel().tolist()) > {-1}


def test_all_about_points_is_told_whatever_was_asked_before(scene):
    down = ([[0.1, 0.2, 3.0], [9.0, 9.0, 3.0]], (0, 0, -2.0))
    asked, other = scene.intersect(*down), scene.intersect(*down)
    assert (asked.instance_id == -1).all()
    np.testing.assert_array_equal(asked.surface.normal, other.surface.normal)
