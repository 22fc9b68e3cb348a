"""Attributes and cells of meshes: what they keep, what hits tell of them, and what they refuse."""

import pickle

import numpy as np
import pytest
import trimesh
from conftest import CORNERS, QUADS
from hypothesis import given
from hypothesis import strategies as st

import raywright as rw

BOX = (np.array(CORNERS), np.array(QUADS))
DOWN = (0, 0, -1)


def above(count, seed=0, most=1.0):
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(0, most, (count, 2)), np.full(count, 9.0)])


def heated(**more):
    """The unit cube of quads with a temperature that is linear in space, and a number for each quad."""
    mesh = rw.Mesh.of(BOX)
    points = mesh.vertices
    values = {"temperature": points @ (1.0, 2.0, 3.0), "place": points}
    faces = {"number": mesh.cells * 10}
    return rw.Mesh(
        points, mesh.faces, vertex_attributes=values, face_attributes=faces, cells=mesh.cells, **more
    )


def test_a_linear_attribute_is_itself_where_rays_hit():
    hits = rw.Scene(heated()).intersect(above(200), DOWN)
    assert np.allclose(hits.interpolate("temperature"), hits.position @ (1.0, 2.0, 3.0), rtol=0, atol=1e-14)
    assert np.allclose(hits.interpolate("place"), hits.position, rtol=0, atol=1e-15)
    # QUADS has the top, z = 1, as its last.
    assert (hits.interpolate("number") == 50).all()
    assert (hits.cell == 5).all()
    assert set(hits.primitive_id) == {10, 11}


def test_a_miss_has_no_value_and_no_cell():
    origins = np.array([[0.5, 0.5, 9], [5, 5, 9]])
    hits = rw.Scene(heated()).intersect(origins, DOWN)
    assert hits.cell.tolist() == [5, -1]
    assert np.isnan(hits.interpolate("temperature")).tolist() == [False, True]
    assert np.isnan(hits.interpolate("place")).tolist() == [[False] * 3, [True] * 3]
    one = hits[1]
    assert one.cell == -1
    assert one.interpolate("place").shape == (3,)


def test_shapes_without_the_attribute_have_nan():
    scene = rw.Scene([rw.Sphere((5, 0.5, 0.5), 0.5), rw.Mesh(*BOX[:1], [(0, 4, 2)]), heated()])
    hits = scene.intersect([[5, 0.5, 9], [0.2, 0.2, 9], [0.2, 0.2, -9]], [DOWN, DOWN, (0, 0, 1)])
    assert hits.shape_id.tolist() == [0, 2, 1]
    values = hits.interpolate("temperature")
    assert np.isnan(values).tolist() == [True, False, True]
    assert hits.cell.tolist() == [0, 5, 0]


def test_copies_within_copies_have_the_values_of_their_shape():
    shifted = np.stack([np.eye(4)] * 3)
    shifted[:, 1, 3] = (2, 4, 6)
    inner = rw.Instance([rw.Mesh(CORNERS, [(0, 4, 2)]), heated()], shifted)
    matrices = np.stack([np.eye(4)] * 2)
    matrices[1, 0, 3] = 10
    scene = rw.Scene([rw.Sphere((50, 0, 0), 1), rw.Instance([heated(), inner], matrices)])
    rng = np.random.default_rng(4)
    local, row, copy = rng.uniform(0, 1, (80, 2)), rng.integers(0, 4, 80), rng.integers(0, 2, 80)
    origins = np.column_stack([local[:, 0] + 10 * copy, local[:, 1] + 2 * row, np.full(80, 9.0)])
    hits = scene.intersect(origins, DOWN)
    assert np.array_equal(hits.instance_id, copy)
    there = np.column_stack([local, np.ones(80)])
    assert np.allclose(hits.interpolate("temperature"), there @ (1.0, 2.0, 3.0), rtol=0, atol=1e-12)
    assert (hits.cell == 5).all()
    below = scene.intersect(origins * (1, 1, -1), (0, 0, 1))
    for primitive, cell in zip(below.primitive_id, below.cell, strict=True):
        place = scene.shapes[1].locate(primitive)
        assert cell == (place.face if place.shape.cells is None else place.shape.cells[place.face])


def test_closest_points_and_all_hits_tell_values_too():
    scene = rw.Scene(heated())
    points = np.random.default_rng(3).uniform(-1, 2, (100, 3))
    near = scene.closest_point(points)
    assert np.allclose(near.interpolate("temperature"), near.position @ (1.0, 2.0, 3.0), rtol=0, atol=1e-14)
    every = scene.intersect_all(above(20), DOWN)
    assert np.allclose(every.interpolate("temperature"), every.position @ (1.0, 2.0, 3.0), rtol=0, atol=1e-14)
    assert np.array_equal(every.cell, np.tile([5, 4], 20))


def test_a_face_attribute_stands_behind_a_vertex_attribute_of_its_name():
    mesh = rw.Mesh(CORNERS, [(1, 5, 7)], vertex_attributes={"a": np.ones(8)}, face_attributes={"a": [2.0]})
    assert rw.Scene(mesh).intersect((0.7, 0.3, 9), DOWN).interpolate("a") == pytest.approx(1, abs=1e-15)


def test_a_pickle_of_hits_keeps_cells_that_were_asked_for():
    hits = rw.Scene(heated()).intersect(above(5), DOWN)
    cells = hits.cell
    back = pickle.loads(pickle.dumps(hits))
    assert np.array_equal(back.cell, cells)
    with pytest.raises(ValueError, match="pickled hits have no attributes"):
        back.interpolate("temperature")
    assert np.array_equal(hits[2:].cell, cells[2:])


def test_meshes_with_values_compare_pickle_and_move():
    mesh = heated(name="stove")
    back = pickle.loads(pickle.dumps(mesh))
    assert back == mesh
    assert hash(back) == hash(mesh)
    assert not back.vertex_attributes["place"].flags.writeable
    assert mesh != rw.Mesh(mesh.vertices, mesh.faces, name="stove")
    assert mesh != heated(name="stove", normals=mesh.vertices)
    moved = mesh.transformed(np.diag([-1.0, 1, 1, 1]))
    assert np.array_equal(moved.cells, mesh.cells)
    assert moved.face_attributes == mesh.face_attributes
    assert moved.name == "stove"
    scene = rw.Scene(mesh)
    scene.refit(mesh.vertices + np.array((0, 0, 1)))
    hits = scene.intersect(above(9), DOWN)
    assert np.allclose(hits.interpolate("place"), hits.position - (0, 0, 1), rtol=0, atol=1e-14)
    assert "vertex_attributes=['temperature', 'place'], face_attributes=['number']" in repr(mesh)


@pytest.mark.parametrize(
    ("values", "error", "told"),
    [
        ({"vertex_attributes": {"a": np.ones(3)}}, ValueError, r"\['a'\] must have shape \(8,"),
        ({"face_attributes": {"a": 1.0}}, ValueError, r"face_attributes\['a'\] must have shape \(1,"),
        ({"vertex_attributes": {3: np.ones(8)}}, TypeError, "names of type str, got 3"),
        ({"vertex_attributes": [1, 2]}, TypeError, "must be a dict of arrays by name, got list"),
        ({"vertex_attributes": {"a": ["x"] * 8}}, TypeError, r"_attributes\['a'\] must be real numbers"),
        ({"cells": [1, 2]}, ValueError, r"cells must have shape \(1,\), one number per face, got \(2,\)"),
        ({"cells": [-1]}, ValueError, "cells must be at least 0, got -1 of face 0"),
        ({"cells": [0.5]}, TypeError, "cells must be integers, got dtype float64"),
    ],
)  # fmt: skip
def test_wrong_values_are_refused(values, error, told):
    with pytest.raises(error, match=told):
        rw.Mesh(CORNERS, [(1, 5, 7)], **values)


def test_an_attribute_that_is_not_there_is_refused_with_those_that_are():
    hits = rw.Scene(heated()).intersect(above(2), DOWN)
    with pytest.raises(ValueError, match="got 'heat': there are 'number', 'place', 'temperature'"):
        hits.interpolate("heat")
    with pytest.raises(TypeError, match="name must be a str, got int"):
        hits.interpolate(3)
    with pytest.raises(ValueError, match="there are none"):
        rw.Scene(rw.Sphere((0, 0, 0), 1)).intersect(above(2), DOWN).interpolate("heat")
    other = rw.Mesh(CORNERS, [(1, 5, 7)], vertex_attributes={"place": np.ones(8)})
    with pytest.raises(ValueError, match=r"values of one shape, 'place' has \(\) and \(3,\)"):
        rw.Scene([heated(), other]).intersect(above(2), DOWN).interpolate("place")


def test_a_ply_file_keeps_all_values(tmp_path):
    look = {"material": rw.Diffuse(rw.VertexColors()), "colors": np.array(CORNERS) * 0.5}
    mesh = heated(normals=np.tile((0.0, 0, 1), (8, 1)), uv=BOX[0][:, :2], **look)
    mesh.save(tmp_path / "stove.ply")
    [back] = rw.Scene(tmp_path / "stove.ply").shapes
    for name in ("vertices", "faces", "normals", "uv"):
        assert np.array_equal(getattr(back, name), getattr(mesh, name)), name
    assert np.allclose(back.colors, mesh.colors, rtol=0, atol=1e-7)
    for name, array in mesh.vertex_attributes.items():
        assert np.array_equal(back.vertex_attributes[name], array), name
    assert np.array_equal(back.face_attributes["number"], mesh.face_attributes["number"])
    assert np.array_equal(back.face_attributes["cell"], mesh.cells)
    # Other readers take it, too.
    read = trimesh.load(tmp_path / "stove.ply", process=False)
    assert np.array_equal(read.vertices, mesh.vertices)
    assert np.array_equal(read.faces, mesh.faces)


def test_cells_are_the_faces_of_a_file(tmp_path):
    points = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    quads = [f"f {' '.join(str(i + 1) for i in quad)}\n" for quad in QUADS]
    looks = ["usemtl a\n", "", "usemtl b\n", "f 1 2\n", "usemtl a\n", "usemtl c\nusemtl a\n"]
    (tmp_path / "plain.obj").write_text(points + "".join(quads))
    (tmp_path / "parts.obj").write_text(points + "".join(a + b for a, b in zip(looks, quads, strict=True)))
    body = "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS)
    body += "".join(f"4 {a} {b} {c} {d}\n" for a, b, c, d in QUADS)
    (tmp_path / "plain.off").write_text(f"OFF\n8 6 0\n{body}")
    for name in ("plain.obj", "plain.off"):
        [mesh] = rw.Scene(tmp_path / name).shapes
        assert np.array_equal(mesh.cells, np.repeat(np.arange(6), 2)), name
    with pytest.warns(RuntimeWarning):
        scene = rw.Scene(tmp_path / "parts.obj")
    # The fourth face, of two corners, is none, and counts.
    first, second = scene.shapes
    assert first.cells.tolist() == [0, 0, 1, 1, 5, 5, 6, 6]
    assert second.cells.tolist() == [2, 2, 4, 4]
    assert scene.intersect((0.2, 0.3, 9), DOWN).cell == 6


def test_names_that_mean_something_only_together_are_attributes(tmp_path):
    values = {"t": np.arange(8.0), "u": np.arange(8), "alpha": np.ones(8), "g": np.zeros((8, 2))}
    rw.Mesh(CORNERS, [(1, 5, 7)], vertex_attributes=values).save(tmp_path / "a.ply")
    [back] = rw.Scene(tmp_path / "a.ply").shapes
    assert back.uv is None
    assert back.vertex_attributes.keys() == values.keys()
    for name, array in values.items():
        assert np.array_equal(back.vertex_attributes[name], array), name


@pytest.mark.parametrize("suffix", ["ply", "stl", "obj", "glb", "off"])
def test_files_keep_places_and_faces(tmp_path, suffix):
    mesh = rw.Mesh(np.array(CORNERS, np.float32), rw.Mesh.of(BOX).faces)
    mesh.save(tmp_path / f"box.{suffix}")
    [back] = rw.Scene(tmp_path / f"box.{suffix}").shapes
    assert np.array_equal(back.vertices[back.faces], mesh.vertices[mesh.faces])


def test_values_that_a_file_cannot_hold_are_told(tmp_path):
    with pytest.warns(RuntimeWarning, match="left out of a.stl: 'temperature', 'place', 'cell', 'number'"):
        heated().save(tmp_path / "a.stl")
    with pytest.raises(ValueError, match=r"path must end in one of .ply, .glb, .*, got 'a.exe'"):
        heated().save(tmp_path / "a.exe")
    for name in ("blue", "X", "vertex_indices"):
        values = {"red": np.ones(8), "green": np.ones(8), name: np.ones(8)}
        mesh = rw.Mesh(CORNERS, [(1, 5, 7)], vertex_attributes=values)
        with pytest.raises(ValueError, match=f"vertex_attributes has '{name}', which is a reserved name"):
            mesh.save(tmp_path / "a.ply")
    huge = rw.Mesh(CORNERS, [(1, 5, 7)], face_attributes={"id": np.array([2**40])})
    with pytest.raises(ValueError, match=r"face_attributes\['id'\] must be between -2\^31 and 2\^32 - 1"):
        huge.save(tmp_path / "a.ply")


NUMBERS = st.floats(-1e6, 1e6, width=32)


@given(
    st.lists(st.tuples(NUMBERS, NUMBERS, NUMBERS), min_size=3, max_size=9),
    st.data(),
    st.sampled_from([np.float32, np.float64]),
)
def test_faces_and_places_come_back_from_trimesh(points, data, dtype):
    corner = st.integers(0, len(points) - 1)
    faces = data.draw(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=9))
    heat = data.draw(st.lists(NUMBERS, min_size=len(points), max_size=len(points)))
    mesh = rw.Mesh(np.array(points, dtype), faces, vertex_attributes={"heat": heat})
    back = rw.Mesh.of(mesh.to_trimesh())
    assert np.array_equal(back.vertices, mesh.vertices)
    assert np.array_equal(back.faces, mesh.faces)
    assert np.array_equal(back.vertex_attributes["heat"], mesh.vertex_attributes["heat"])


def test_colors_come_back_from_trimesh():
    colored = rw.Mesh(CORNERS, [(1, 5, 7)], material=rw.Diffuse(rw.VertexColors()), colors=np.array(CORNERS))
    assert np.allclose(rw.Mesh.of(colored.to_trimesh()).colors, colored.colors, rtol=0, atol=5e-3)
    for more in ({}, {"uv": BOX[0][:, :2]}):
        plain = rw.Mesh(CORNERS, [(1, 5, 7)], material=rw.Diffuse((1.0, 0.0, 0.25)), **more)
        back = rw.Mesh.of(plain.to_trimesh())
        assert back.material.reflectance == pytest.approx((1, 0, 0.25), abs=5e-3)
        assert np.array_equal(back.uv, plain.uv) if more else back.uv is None
