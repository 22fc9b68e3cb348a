"""Answers written over earlier ones."""

import numpy as np
import pytest

import raywright as rw

BALL = rw.Sphere(radius=1.0)
SQUARE = rw.Mesh(
    np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32), np.array([[0, 1, 2], [0, 2, 3]])
)


def fan(seed, shape=(5, 7)):
    rng = np.random.default_rng(seed)
    return np.array([0.1, 0.2, 3.0]), rng.normal(size=(*shape, 3)) * (0.4, 0.4, 0.1) - (0, 0, 1)


def scenes():
    copies = rw.Instance(SQUARE, np.eye(4))
    return {"mesh": rw.Scene(SQUARE), "ball": rw.Scene(BALL), "copies": rw.Scene([SQUARE, copies])}


@pytest.mark.parametrize("kind", ["mesh", "ball", "copies"])
def test_hits_take_over_the_arrays_of_earlier_ones(kind):
    scene = scenes()[kind]
    out = scene.intersect(*fan(1))
    arrays = out.t, out.shape_id, out.primitive_id, out.uv
    # Results computed from hits are cached, and must be dropped with them.
    _ = out.hit, out.position, out.normal, out.surface, out.instance_id
    wanted = scene.intersect(*fan(2))
    assert out != wanted
    assert scene.intersect(*fan(2), out=out) is out
    assert out == wanted
    assert all(a is b for a, b in zip(arrays, (out.t, out.shape_id, out.primitive_id, out.uv), strict=True))
    for name in ("hit", "position", "normal", "instance_id"):
        np.testing.assert_array_equal(getattr(out, name), getattr(wanted, name))
    np.testing.assert_array_equal(out.surface.normal, wanted.surface.normal)
    writable = [array.flags.writeable for array in (*arrays, out.hit)]
    assert writable == [True, False, False, True, True]


def test_another_scene_may_answer():
    each = scenes()
    for kind in each:
        for other in each:
            out = each[kind].intersect(*fan(1))
            assert each[other].intersect(*fan(3), out=out) == each[other].intersect(*fan(3))


def test_what_is_occluded_is_written_where_it_should():
    for scene in scenes().values():
        out = np.ones((5, 7), bool)
        assert scene.occluded(*fan(2), out=out) is out
        np.testing.assert_array_equal(out, scene.intersect(*fan(2)).hit)


def test_what_cannot_be_written_to_is_refused():
    scene = scenes()["mesh"]
    origin, ways = fan(1)
    hits = scene.intersect(origin, ways)
    before = hits.t.copy()
    with pytest.raises(TypeError, match="out must be Hits or arrays by name, got ndarray"):
        scene.intersect(origin, ways, out=np.zeros(3))
    with pytest.raises(ValueError, match=r"out has shape \(5, 7\), expected \(7,\)"):
        scene.intersect(origin, ways[0], out=hits)
    with pytest.raises(ValueError, match=r"out\.t cannot be written to"):
        scene.intersect(origin, ways, t_max=hits.t, out=hits)
    with pytest.raises(ValueError, match="t_min must not be NaN"):
        scene.intersect(origin, ways, t_min=np.nan, out=hits)
    np.testing.assert_array_equal(hits.t, before)
    assert not hits.primitive_id.flags.writeable
    with pytest.raises(TypeError, match="out must be an array of bool, got dtype float64"):
        scene.occluded(origin, ways, out=np.zeros((5, 7)))
    with pytest.raises(TypeError, match="out must be an array of bool, got list"):
        scene.occluded(origin, ways, out=[])
    with pytest.raises(ValueError, match=r"out has shape \(5,\), expected \(5, 7\)"):
        scene.occluded(origin, ways, out=np.zeros(5, bool))
    for bad in (np.zeros((7, 5), bool).T, np.broadcast_to(False, (5, 7))):
        with pytest.raises(ValueError, match="out must be C-contiguous and writable"):
            scene.occluded(origin, ways, out=bad)
