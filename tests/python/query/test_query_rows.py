"""Hits by ray: indexed, iterated, as tables and as pickles."""

import copy
import pickle

import numpy as np
import pytest

import raywright as rw


def scene_of(kind):
    knot = rw.scenes.torus_knot(along=60, around=8)
    if kind == "mesh":
        return rw.Scene(knot)
    places = np.tile(np.eye(4), (2, 1, 1))
    places[1, 0, 3] = 1.5
    return rw.Scene(
        [knot, rw.Sphere((0, 0, 0), 1.0), rw.Instance(rw.Torus((0, 0, 0), (0, 0, 1), 1.0, 0.2), places)]
    )


@pytest.fixture(params=["mesh", "curved"])
def scene(request):
    return scene_of(request.param)


RAYS = rw.Camera((2, 3, 6), (0, 0, 0), width=9, height=7).rays()
INDICES = [
    3,
    -1,
    (2, 4),
    slice(1, 6, 2),
    (slice(None), 4),
    (..., 2),
    ([0, 3, 3], [8, 1, 1]),
    np.arange(63).reshape(7, 9) % 2 == 0,
    np.arange(7) > 3,
    np.array([], np.int64),
    None,
]
ARRAYS = ("t", "shape_id", "primitive_id", "instance_id", "hit", "uv", "position", "normal")


@pytest.mark.parametrize("index", INDICES, ids=repr)
@pytest.mark.parametrize("asked", [False, True])
def test_some_hits_are_those_of_some_rays(scene, index, asked):
    hits = scene.intersect(*RAYS)
    assert 10 < hits.hit.sum() < 63
    if asked:
        for name in (*ARRAYS, "surface"):
            getattr(hits, name)
    some = hits[index]
    assert isinstance(some, rw.query.Hits)
    assert some.shape == hits.t[index].shape
    for name in ARRAYS:
        every = getattr(hits, name)
        tail = (slice(None),) if name in ("uv", "position", "normal") else ()
        lead = index if isinstance(index, tuple) else (index,)
        wanted = every[(*lead, *tail)] if tail else every[index]
        assert np.array_equal(getattr(some, name), wanted, equal_nan=name in ("uv", "position", "normal"))
        assert getattr(some, name).flags.writeable == (wanted.dtype.kind in "fb")
    tail = (*(index if isinstance(index, tuple) else (index,)), slice(None))
    assert np.array_equal(some.surface.dp_du, hits.surface.dp_du[tail], equal_nan=True)
    assert some == scene.intersect(RAYS[0][tail] if RAYS[0].ndim == 3 else RAYS[0], RAYS[1][tail])
    ways = np.array([0.3, 0.2, 1.0])
    assert np.array_equal(some.spawn_rays(ways).origins, hits.spawn_rays(ways).origins[tail], equal_nan=True)


def test_one_of_many_is_as_some_that_are_one(scene):
    """What is known, of points, closest points and all hits, of two dimensions and of one."""
    origins, ways = RAYS[0], RAYS[1]
    for known in (False, True):
        for found in (
            scene.intersect(origins, ways),
            scene.intersect(origins, ways)[3],
            scene.closest_point(ways),
            scene.intersect_all(origins, ways),
            scene.intersect_all(origins, ways)[:, 4],
        ):
            if known:
                for name in ("position", "normal", "surface", "instance_id"):
                    getattr(found, name)
            for i in (0, -1, np.int32(2), len(found) - 1):
                one, some = found[i], found[[i]]
                assert one.shape == some.shape[1:] == found.shape[1:]
                for name in (
                    "shape_id",
                    "primitive_id",
                    "uv",
                    "position",
                    "normal",
                    "instance_id",
                    "surface",
                ):
                    mine, theirs = getattr(one, name), getattr(some, name)
                    if name == "surface":
                        mine, theirs = mine.dp_du, theirs.dp_du
                    assert np.array_equal(
                        mine.reshape(-1), theirs.reshape(-1), equal_nan=mine.dtype.kind == "f"
                    )
                    assert mine.flags.writeable == (mine.dtype.kind in "fb")
            for i in (len(found), -len(found) - 1):
                with pytest.raises(IndexError, match="out of bounds for axis 0"):
                    found[i]


def test_hits_are_iterated_by_rays(scene):
    hits = scene.intersect(*RAYS)
    rows = list(hits)
    assert len(rows) == len(hits) == 7
    assert all(row.shape == (9,) for row in rows)
    assert np.array_equal(np.stack([row.t for row in rows]), hits.t)
    single = [one for one in hits[2]]
    assert [one.shape for one in single] == [()] * 9
    with pytest.raises(IndexError):
        hits[7]
    with pytest.raises(TypeError):
        iter(single[0]).__next__()
    # Picked hits keep no reference to the others, and another query may write over them.
    some = hits[:2]
    assert some.t.base is None
    assert (
        scene.intersect(RAYS[0][2:4] if RAYS[0].ndim == 3 else RAYS[0], RAYS[1][2:4], out=some) == hits[2:4]
    )


def test_all_hits_by_rays(scene):
    every = scene.intersect_all(*RAYS)
    assert len(every) == 7
    assert every.count.shape == every.first.shape == (7, 9)  # kept, and of no use to some
    assert every.t.size > 20
    for index in INDICES:
        some = every[index]
        wanted = np.arange(63).reshape(7, 9)[index]
        assert some.shape == wanted.shape
        assert np.array_equal(some.count, every.count[index])
        parts = [slice(every.ray_splits[i], every.ray_splits[i + 1]) for i in wanted.reshape(-1)]
        for name in ("t", "shape_id", "primitive_id", "uv", "position", "normal", "instance_id"):
            array = getattr(every, name)
            assert np.array_equal(
                getattr(some, name), np.concatenate([array[:0], *(array[part] for part in parts)])
            )
        assert some.first == scene.intersect(*RAYS)[index]
    assert [len(row) for row in every] == [9] * 7
    # More hits than rays have ends.
    straight = scene.intersect_all(
        np.tile((0.0, 0, 9), (40, 1)), np.linspace((-0.1, 0, -1), (0.2, 0.1, -1), 40)
    )
    assert straight.t.size > 50
    assert np.array_equal(straight[30:].t, straight.t[straight.ray_splits[30] :])
    with pytest.raises(TypeError, match="hits of one ray have no length"):
        len(every[0, 0])


def test_the_first_of_all_hits_is_what_intersect_finds(scene):
    every = scene.intersect_all(*RAYS)
    first, hits = every.first, scene.intersect(*RAYS)
    assert first == hits
    assert first.shape == (7, 9)
    for name in ("position", "normal", "instance_id"):
        assert np.array_equal(getattr(first, name), getattr(hits, name), equal_nan=True)
    assert every.first is first
    nothing = scene.intersect_all((9.0, 9, 9), (0, 0, 1.0)).first
    assert not nothing.hit
    assert nothing.t == np.inf


def test_closest_points_by_points():
    scene = scene_of("mesh")
    points = np.random.default_rng(2).normal(size=(4, 5, 3))
    near = scene.closest_point(points, max_distance=1.0)
    assert near[1:3] == scene.closest_point(points[1:3], max_distance=1.0)
    assert np.array_equal(near[2].position, near.position[2], equal_nan=True)
    assert len(list(near)) == len(near) == 4


def test_tables(scene):
    hits = scene.intersect(*RAYS)
    table = hits.to_dict()
    position = ["x", "y", "z"]
    assert list(table) == ["t", "shape_id", "name", "instance_id", "primitive_id", "u", "v", *position,
                           "normal_x", "normal_y", "normal_z"]  # fmt: skip
    assert all(column.shape == (63,) for column in table.values())
    stacked = np.stack([table[axis] for axis in position], axis=-1)
    assert np.array_equal(stacked, hits.position.reshape(-1, 3), equal_nan=True)
    every = scene.intersect_all(*RAYS)
    assert list(every.to_dict())[:2] == ["ray", "t"]
    assert all(column.shape == every.t.shape for column in every.to_dict().values())
    near = scene_of("mesh").closest_point([(3.0, 2, 1)]).to_dict()
    assert list(near)[:3] == ["distance", "shape_id", "name"]
    assert set(pickle.loads(pickle.dumps(hits[0])).to_dict()) >= {"t", "u", "v"}


def test_frames():
    pandas = pytest.importorskip("pandas")
    hits = scene_of("mesh").intersect(*RAYS)
    frame = hits.to_dataframe()
    assert isinstance(frame, pandas.DataFrame)
    assert frame.shape == (63, 13)
    assert np.array_equal(frame["t"], hits.t.reshape(-1))
    assert frame["name"][0] == ""


def test_without_pandas_that_is_told(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(
        ImportError, match="to_dataframe needs pandas, which is not installed: pip install pandas"
    ):
        scene_of("mesh").intersect(*RAYS).to_dataframe()


def test_a_pickle_is_as_small_as_its_arrays(scene):
    many = np.random.default_rng(1).normal(size=(5000, 3))
    hits = scene.intersect(many, -many)
    arrays = [hits.t, hits.shape_id, hits.primitive_id, hits.uv]
    arrays += [hits.instance_id] if vars(hits).get("instance_id") is not None else []
    assert len(pickle.dumps(hits)) < sum(array.nbytes for array in arrays) + 1500
    back = pickle.loads(pickle.dumps(hits))
    assert back == hits
    for name in ("position", "normal", "surface", "names"):
        with pytest.raises(
            ValueError, match=f"{name} is not in pickled hits unless it was computed before pickling"
        ):
            getattr(back, name)
    with pytest.raises(ValueError, match="position is not in pickled hits"):
        back.spawn_rays((0, 0, 1.0))
    # Computed attributes are kept.
    known = {name: getattr(hits, name) for name in ("position", "normal", "names")}
    back = pickle.loads(pickle.dumps(hits))
    for name, array in known.items():
        assert np.array_equal(getattr(back, name), array, equal_nan=name != "names")
        assert getattr(back, name).flags.writeable == (name != "names")
    assert back[:7] == hits[:7]


def test_a_copy_knows_as_much(scene):
    hits = scene.intersect(*RAYS)
    again = copy.deepcopy(hits)
    assert again == hits
    assert np.array_equal(again.position, hits.position, equal_nan=True)
    scene.intersect(RAYS[0], -RAYS[1], out=hits)
    assert again == scene.intersect(*RAYS)


def test_names_come_from_files(tmp_path, box):
    trimesh = pytest.importorskip("trimesh")
    parts = trimesh.Scene()
    parts.add_geometry(trimesh.creation.box(), geom_name="chair")
    parts.add_geometry(trimesh.creation.icosphere(), geom_name="lamp")
    assert rw.Scene(parts).names == ("chair", "lamp")
    parts.export(tmp_path / "room.glb")
    assert set(rw.Scene(tmp_path / "room.glb").names) == {"chair", "lamp"}
    (tmp_path / "two.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 3 2\n"
    )
    with pytest.warns(RuntimeWarning):
        assert rw.Scene(tmp_path / "two.obj").names == ("red", "blue")
    named = rw.Mesh(box.vertices, box.faces, name="cube")
    assert named != box
    assert named.transformed(np.eye(4)).name == "cube"
    assert pickle.loads(pickle.dumps(named)) == named
    assert "name='cube'" in repr(named)
    scene = rw.Scene([named, rw.Sphere(name="ball")])
    scene.refit([box.vertices + 1, None])
    assert scene.names == ("cube", "ball")
    with pytest.raises(TypeError, match="name must be a str, got int"):
        rw.Mesh(box.vertices, box.faces, name=3)
    with pytest.raises(TypeError, match="name must be a str, got int"):
        rw.Sphere(name=3)


def test_arrays_in_place_of_shapes_are_told_how_to_be_one(box):
    for arrays in ((box.vertices, box.faces), (box.vertices.tolist(), box.faces.tolist())):
        with pytest.raises(TypeError, match=r"make a mesh: raywright\.Mesh\(vertices, faces\)"):
            rw.Scene(*arrays)
