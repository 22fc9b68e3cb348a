"""Hits of which some parts are asked for, in arrays of the caller's."""

import copy
import itertools
import pickle

import numpy as np
import pytest

import raywright as rw

STORED = ("t", "shape_id", "primitive_id", "uv", "instance_id")
TYPES = {"t": np.float64, "uv": np.float64, "hit": bool}


def soup(count, seed):
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(count, 1, 3)) + 0.3 * rng.normal(size=(count, 3, 3))
    return rw.Mesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))


SOUP = soup(300, 1)
SCENES = {
    "mesh": rw.Scene([SOUP]),
    "meshes": rw.Scene([SOUP, soup(40, 2)]),
    "ball": rw.Scene([SOUP, rw.Sphere(radius=0.7)]),
    "copies": rw.Scene([SOUP, rw.Instance(soup(30, 3), np.stack([np.eye(4), np.diag([2.0, 2, 2, 1])]))]),
    "grid": rw.Scene([SOUP], accelerator=rw.accelerators.Grid()),
    "nothing": rw.Scene([]),
}
# A sequence, an image that is traced in tiles, rays that stand in no order, one ray, and none.
SHAPES = [(3000,), (24, 40), (2, 3, 50), (), (0, 7)]


def rays(shape, seed=4):
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(*shape, 3)) * 2
    return origins, rng.normal(size=(*shape, 3)) - origins


def images(width, height):
    return rw.Camera((0, 0, 5), (0, 0, 0), fov=50, width=width, height=height).rays()


@pytest.mark.parametrize("name", SCENES)
def test_each_choice_of_parts_is_that_of_all(name):
    scene = SCENES[name]
    for shape in SHAPES:
        some = images(40, 24) if shape == (24, 40) else rays(shape)
        whole = scene.intersect(*some)
        wanted = {part: getattr(whole, part) for part in (*STORED, "hit")}
        for count in (1, 2, 5, 6):
            for fields in itertools.combinations((*STORED, "hit"), count):
                found = scene.intersect(*some, fields=fields)
                assert found.shape == whole.shape
                for part in fields:
                    np.testing.assert_array_equal(getattr(found, part), wanted[part])
                for part in set(STORED) - set(fields):
                    with pytest.raises(AttributeError, match=part):
                        getattr(found, part)


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64, np.longdouble])
@pytest.mark.parametrize("name", SCENES)
def test_answers_go_into_arrays_of_any_float_type(name, kind):
    scene = SCENES[name]
    for some in (rays((777,)), images(40, 24)):
        whole = scene.intersect(*some)
        shape = whole.shape
        out = {"t": np.empty(shape, kind), "uv": np.empty((*shape, 2), kind), "hit": np.empty(shape, bool)}
        for _ in range(2):
            found = scene.intersect(*some, out=out)
            assert all(getattr(found, part) is array for part, array in out.items())
            np.testing.assert_array_equal(out["t"], whole.t.astype(kind))
            np.testing.assert_array_equal(out["uv"], whole.uv.astype(kind))
            np.testing.assert_array_equal(out["hit"], whole.hit)


def test_numbers_of_the_caller_stay_the_callers():
    scene, some = SCENES["copies"], rays((500,))
    whole = scene.intersect(*some)
    out = {part: np.empty(500, np.int32) for part in ("shape_id", "primitive_id", "instance_id")}
    for _ in range(2):
        found = scene.intersect(*some, out=out, fields=("t", *out))
        for part, array in out.items():
            assert getattr(found, part) is array
            assert array.flags.writeable
            np.testing.assert_array_equal(array, getattr(whole, part))
        np.testing.assert_array_equal(found.t, whole.t)
    with pytest.raises(ValueError, match="nor in hits that were written to given arrays"):
        _ = found.position
    held = scene.intersect(*some, out={**out, "uv": np.empty((500, 2))})
    with pytest.raises(ValueError, match="nor in hits that were written to given arrays"):
        _ = held.normal


def test_what_follows_from_the_parts_is_known():
    scene, some = SCENES["meshes"], rays((9, 11))
    whole = scene.intersect(*some)
    found = scene.intersect(*some, fields=["shape_id", "primitive_id", "uv"])
    np.testing.assert_array_equal(found.position, whole.position)
    np.testing.assert_array_equal(found.normal, whole.normal)
    np.testing.assert_array_equal(scene.intersect(*some, fields="shape_id").hit, whole.hit)
    with pytest.raises(AttributeError, match=r"fields=\('t',\) have no "):
        _ = scene.intersect(*some, fields="t").position


@pytest.mark.parametrize(
    "fields", ["t", "hit", ("uv", "t"), ("instance_id", "primitive_id"), ("shape_id", "hit")]
)
def test_some_parts_are_indexed_compared_copied_and_pickled(fields):
    scene, some = SCENES["copies"], rays((6, 8))
    found, again = scene.intersect(*some, fields=fields), scene.intersect(*some, fields=fields)
    assert found == again
    assert found != scene.intersect(*some)
    assert found != scene.intersect(*rays((6, 8), 5), fields=fields)
    assert len(found) == 6
    assert f"{found}".startswith("Hits(shape=(6, 8)")
    for other in (copy.copy(found), copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert other == found
        with pytest.raises((AttributeError, ValueError)):
            _ = other.surface.normal
    names = (fields,) if isinstance(fields, str) else fields
    for part in names:
        np.testing.assert_array_equal(getattr(found[2:, 3], part), getattr(found, part)[2:, 3])
        np.testing.assert_array_equal(getattr(found[4], part), getattr(found, part)[4])
    assert "<table" in found._repr_html_()
    columns = {"u", "v"} if "uv" in names else set()
    assert columns.union(names) - {"uv", "hit"} <= set(found.to_dict())


def test_filters_and_masks_count_as_for_all():
    scene, some = SCENES["meshes"], rays((200,))
    mask = np.arange(200) % 3 == 0
    how = {"mask": mask, "shapes": [False, True], "cull": "back", "t_min": 0.2, "t_max": 3.0}
    whole = scene.intersect(*some, **how)
    found = scene.intersect(*some, **how, fields=("hit", "uv"))
    np.testing.assert_array_equal(found.hit, whole.hit)
    np.testing.assert_array_equal(found.uv, whole.uv)
    np.testing.assert_array_equal(scene.intersect(*some, **how, fields="hit").hit, whole.hit)


def test_a_byte_a_ray_and_no_more_than_is_asked_for():
    scene, count = SCENES["mesh"], 1000
    some = rays((count,))
    sizes = {"hit": 1, ("t", "primitive_id"): 12, "primitive_id": 4, ("t", "uv"): 24, STORED: 32}
    for fields, size in sizes.items():
        found = vars(scene.intersect(*some, fields=fields))
        arrays = [array for array in found.values() if isinstance(array, np.ndarray) and any(array.strides)]
        assert sum(array.nbytes for array in arrays) == size * count


def test_broadcast_rays_are_read_where_they_are():
    scene = SCENES["mesh"]
    _, ways = rays((50, 40))
    eyes = np.random.default_rng(1).normal(size=(50, 1, 3))
    for origins in (np.array([0.0, 0.0, 4.0]), eyes, np.broadcast_to(eyes, (50, 40, 3))):
        for kind in (np.float32, np.float64):
            part, way = origins.astype(kind, copy=False), ways.astype(kind)
            if isinstance(origins, np.ndarray) and 0 in origins.strides:
                part = np.broadcast_to(eyes.astype(kind), (50, 40, 3))
            full = np.ascontiguousarray(np.broadcast_to(part, way.shape))
            wanted = scene.intersect(full, way)
            found = scene.intersect(part, way, fields=("t", "primitive_id"))
            np.testing.assert_array_equal(found.t, wanted.t)
            np.testing.assert_array_equal(found.primitive_id, wanted.primitive_id)


REFUSED = [
    (
        {"fields": "depth"},
        ValueError,
        "fields must be among t, shape_id, primitive_id, uv, instance_id, hit, got 'depth'",
    ),
    ({"fields": ()}, ValueError, "fields must name at least one of"),
    ({"fields": 3}, TypeError, "fields must be names among .*, got 3"),
    (
        {"fields": "t", "out": {"uv": np.empty((5, 2))}},
        ValueError,
        r"out has an array of 'uv', which is not among",
    ),
    ({"out": {"t": np.empty(5, np.int32)}}, TypeError, r"out\['t'\] must be an array of float64 or float32"),
    ({"out": {"t": [1.0]}}, TypeError, r"out\['t'\] must be an array of .*, got list"),
    ({"out": {"t": np.empty(4)}}, ValueError, r"out\['t'\] has shape \(4,\), expected \(5,\)"),
    ({"out": {"uv": np.empty(5)}}, ValueError, r"out\['uv'\] has shape \(5,\), expected \(5, 2\)"),
    ({"out": {"t": np.empty(10)[::2]}}, ValueError, r"out\['t'\] must be C-contiguous and writable"),
    ({"out": {"t": np.broadcast_to(0.0, 5)}}, ValueError, r"out\['t'\] must be C-contiguous and writable"),
    (
        {"out": {"primitive_id": np.empty(5, np.int64)}},
        TypeError,
        r"out\['primitive_id'\] must be an array of int32",
    ),
    (
        {"out": {"hit": np.empty(5, np.uint8)}},
        TypeError,
        r"out\['hit'\] must be an array of bool, got dtype uint8",
    ),
    ({"out": {}}, ValueError, "fields must name at least one of"),
    ({"out": [], "fields": "t"}, TypeError, "out must be arrays by name where fields are given, got list"),
]


@pytest.mark.parametrize(("wrong", "kind", "message"), REFUSED)
def test_what_is_no_choice_is_refused(wrong, kind, message):
    with pytest.raises(kind, match=message):
        SCENES["mesh"].intersect(*rays((5,)), **wrong)


def test_arrays_that_overlap_are_refused():
    scene, (origins, ways) = SCENES["mesh"], rays((5,))
    store = np.empty(12)
    with pytest.raises(ValueError, match=r"out\['uv'\] and out\['t'\] share memory"):
        scene.intersect(origins, ways, out={"t": store[:5], "uv": store[2:].reshape(5, 2)})
    with pytest.raises(ValueError, match=r"out\.t cannot be written to"):
        scene.intersect(origins, ways, out={"t": origins.reshape(-1)[:5]})
    with pytest.raises(TypeError, match="out must be arrays by name where fields are given, got Hits"):
        scene.intersect(origins, ways, out=scene.intersect(origins, ways), fields="t")
