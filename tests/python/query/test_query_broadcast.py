"""Rays that are broadcast: answered as if each stood in an array of its own, in memory for the answer."""

import math
import subprocess
import sys

import numpy as np
import pytest

import raywright as rw

RNG = np.random.default_rng(5)


def scenes():
    knot = rw.scenes.torus_knot(along=40, around=8)
    turn = np.eye(4)
    turn[0, 3] = 0.5
    return {
        "mesh": rw.Scene(knot),
        "curved": rw.Scene([knot, rw.Sphere((1.0, 0, 0), 0.7), rw.Instance(knot, np.eye(4), turn)]),
    }


SCENES = scenes()
# Leading shapes of origins, directions, t_min and t_max.
SHAPES = [
    ((1, 70), (60, 1), (), ()),
    ((70,), (60, 1), (60, 1), (70,)),
    ((5, 1, 7), (4, 1), (), (5, 1, 1)),
    ((3, 1, 5, 1), (4, 1, 6), (1, 1, 1, 6), (3, 4, 5, 6)),
    ((3, 1, 1), (1, 40, 30), (), ()),
    ((1, 1), (2, 9), (1, 1), (9,)),
    ((1,), (8, 1), (), ()),
    ((), (), (3, 1), (5,)),
    ((0, 1), (1, 5), (), ()),
]


def rays(shapes, kind):
    starts, ways, near, far = shapes
    return (
        RNG.normal(0, 1.5, (*starts, 3)).astype(kind),
        RNG.normal(0, 1, (*ways, 3)).astype(kind),
        RNG.uniform(0, 0.3, near),
        RNG.uniform(1, 4, far),
    )


def whole(parts):
    """The same rays, each in an array of its own."""
    lead = np.broadcast_shapes(*(part.shape[:-1] for part in parts[:2]), *(part.shape for part in parts[2:]))
    full = [np.array(np.broadcast_to(part, (*lead, 3))) for part in parts[:2]]
    return *full, *(np.array(np.broadcast_to(part, lead)) for part in parts[2:])


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("shapes", SHAPES, ids=repr)
@pytest.mark.parametrize("name", SCENES)
def test_every_call_answers_as_if_nothing_were_broadcast(name, shapes, kind):
    scene = SCENES[name]
    parts = rays(shapes, kind)
    full = whole(parts)
    time = RNG.uniform(0, 1, parts[1].shape[:-1])
    mask, some = (RNG.random(shape) < 0.8 for shape in (full[2].shape, parts[1].shape[:-1]))
    for options, expanded in (
        ({}, {}),
        ({"time": time}, {"time": np.array(np.broadcast_to(time, full[2].shape))}),
        ({"mask": mask}, {"mask": mask}),
        ({"mask": some}, {"mask": np.array(np.broadcast_to(some, full[2].shape))}),
        ({"mask": False}, {"mask": np.zeros(full[2].shape, np.bool_)}),
        ({"cull": "back"}, {"cull": "back"}),
    ):
        hits, wanted = scene.intersect(*parts, **options), scene.intersect(*full, **expanded)
        assert hits == wanted
        assert np.array_equal(hits.position, wanted.position, equal_nan=True)
        assert hits.surface == wanted.surface
        assert np.array_equal(scene.occluded(*parts, **options), wanted.hit)
        assert scene.intersect_all(*parts, **options) == scene.intersect_all(*full, **expanded)
    assert np.array_equal(scene.count_hits(*parts, time=time), scene.count_hits(*full, time=time))
    out = np.empty(full[2].shape, np.bool_)
    assert scene.occluded(*parts, out=out) is out
    assert np.array_equal(out, scene.occluded(*full))
    if len(full[2]):
        some = scene.intersect(*parts)[0]
        assert some.surface == scene.intersect(*(part[0] for part in full)).surface


def test_views_that_numpy_has_broadcast_are_rays_too():
    scene = SCENES["curved"]
    parts = rays(((40, 1), (1, 50), (), ()), np.float64)
    full = whole(parts)
    views = [np.broadcast_to(part, (40, 50, 3)) for part in parts[:2]]
    assert scene.intersect(*views) == scene.intersect(*full[:2])
    # Any strides, also reversed ones and those of columns.
    turned = [view.transpose(1, 0, 2)[::-1] for view in views]
    assert scene.intersect(*turned) == scene.intersect(*(part.transpose(1, 0, 2)[::-1] for part in full[:2]))
    strided = np.broadcast_to(np.asfortranarray(parts[0][::2]), (20, 50, 3))
    assert scene.intersect(strided, views[1][::2]) == scene.intersect(full[0][::2], full[1][::2])


def test_memory_is_that_of_the_answer():
    """Two thousand by two thousand rays have an answer of 4 MB; as arrays of their own they are 192 MB."""
    code = """
import resource
import numpy as np
import raywright as rw
scene = rw.Scene(rw.scenes.torus_knot(along=20, around=6))
points = np.random.default_rng(1).normal(0, 2, (2000, 3))
scene.occluded(points, (0, 0, 1.0))
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
hidden = scene.occluded(points[None], points[:, None], mask=points[:, :1] < 9)
counts = scene.count_hits(points[None], points[:, None], t_max=np.full((2000, 1), 9.0))
after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
assert np.array_equal(hidden, counts > 0) or (hidden >= (counts > 0)).all()
print(hidden.nbytes + counts.nbytes, 1024 * (after - before))
"""
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    answer, taken = map(int, told.split())
    assert answer == 20_000_000
    assert taken < answer + 40_000_000


def laid_out(array):
    """Return arrays of the same numbers that numpy stores or names in other ways."""
    unaligned = np.frombuffer(b"x" + array.tobytes(), np.uint8)[1:].view(array.dtype).reshape(array.shape)
    return [
        np.asfortranarray(array),
        np.repeat(array, 2, axis=0)[::2],
        array.astype(array.dtype.newbyteorder()),
        unaligned,
        array.view(np.recarray),
        np.ma.masked_array(array),
        array.tolist(),
    ]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_arrays_of_any_layout_get_the_same_answer(dtype):
    scene = rw.Scene(rw.scenes.torus_knot(along=60, around=8))
    scene.build()
    # Multiples of an eighth, which lists keep.
    rng = np.random.default_rng(3)
    origins = (rng.integers(-8, 9, (40, 3)) / 8 + [0, 0, 5]).astype(dtype)
    directions = (rng.integers(-4, 5, (40, 3)) / 8 - [0, 0, 4]).astype(dtype)
    hits, occluded = scene.intersect(origins, directions), scene.occluded(origins, directions)
    assert 5 < occluded.sum() < 35
    for others in zip(laid_out(origins), laid_out(directions), strict=True):
        for o, d in ((others[0], directions), (origins, others[1]), others):
            again = scene.intersect(o, d)
            assert type(again.t) is np.ndarray
            assert again == hits
            assert np.array_equal(again.t, hits.t)
            assert np.array_equal(scene.occluded(o, d), occluded)
    alone = scene.intersect(origins[7], directions[7])
    assert alone.t.shape == ()
    assert alone.t == hits.t[7]
    assert np.array_equal(scene.intersect(origins, directions, 0, math.inf).t, hits.t)
    for wrong in (origins[:, :2], origins[:3], origins[0, 0], origins > 0, origins * 1j):
        with pytest.raises((ValueError, TypeError), match=r"origins|broadcast"):
            scene.intersect(wrong, directions)
        with pytest.raises((ValueError, TypeError), match=r"origins|broadcast"):
            scene.occluded(wrong, directions)
    with pytest.raises(ValueError, match="t_max must not be NaN"):
        scene.intersect(origins, directions, t_max=math.nan)
