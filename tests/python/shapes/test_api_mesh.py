"""Meshes: what they keep, how they compare, and what they refuse."""

import pickle
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import raywright as rw

THREE = [(0.0, 0, 0), (1, 0, 0), (0, 1, 0)]
FACE = [(0, 1, 2)]


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        (np.float32, np.float32),
        (np.float64, np.float64),
        (">f4", np.float32),
        (">f8", np.float64),
        (np.float16, np.float64),
        (np.int64, np.float64),
        (np.uint8, np.float64),
    ],
)
def test_vertices_keep_single_and_double_and_widen_the_rest(given, kept):
    mesh = rw.Mesh(np.array(THREE).astype(given), FACE)
    assert mesh.vertices.dtype == kept
    assert mesh.vertices.dtype.isnative
    assert np.array_equal(mesh.vertices, THREE)


@pytest.mark.parametrize("dtype", [np.int8, np.uint16, np.int32, np.uint32, np.int64, np.uint64, ">i4"])
def test_faces_of_any_integer_become_uint32(dtype):
    faces = np.asfortranarray(np.array([(0, 1, 2), (2, 1, 0)]).astype(dtype))
    mesh = rw.Mesh(THREE, faces)
    assert mesh.faces.dtype == np.uint32
    assert mesh.faces.flags.c_contiguous
    assert np.array_equal(mesh.faces, [(0, 1, 2), (2, 1, 0)])


def test_arrays_are_read_only_copies():
    vertices, faces = np.array(THREE), np.array(FACE, np.uint32)
    mesh = rw.Mesh(vertices, faces, normals=vertices, uv=vertices[:, :2])
    for mine, given in ((mesh.vertices, vertices), (mesh.faces, faces), (mesh.normals, vertices)):
        assert not np.shares_memory(mine, given)
    for array in (mesh.vertices, mesh.faces, mesh.normals, mesh.uv):
        assert not array.flags.writeable
    vertices[:] = 7
    assert np.array_equal(mesh.vertices, THREE)


def test_fields_cannot_be_set(triangle):
    with pytest.raises(FrozenInstanceError):
        triangle.material = rw.Diffuse(0.1)


@pytest.mark.parametrize(
    ("emission", "kept"),
    [(None, None), (2, (2.0, 2.0, 2.0)), ((1, 2, 3), (1.0, 2.0, 3.0)), (0, (0.0, 0.0, 0.0))],
)
def test_emission_is_none_or_three_floats(emission, kept):
    assert rw.Mesh(THREE, FACE, emission=emission).emission == kept


def test_default_material_is_half_gray(triangle):
    assert triangle.material == rw.Diffuse(0.5)


@pytest.mark.parametrize("vertices", [[], np.empty((0, 3)), THREE])
@pytest.mark.parametrize("faces", [[], np.empty((0, 3), np.int64)])
def test_meshes_may_be_empty(vertices, faces):
    mesh = rw.Mesh(vertices, faces)
    assert mesh.faces.shape == (0, 3)
    assert mesh.vertices.shape == (len(vertices), 3)
    assert mesh.bounds is None


def test_equality_is_by_content(box):
    same = rw.Mesh(box.vertices.copy(), box.faces.copy())
    assert box == same
    assert hash(box) == hash(same)
    assert box != rw.Mesh(box.vertices, box.faces[::-1])
    assert box != rw.Mesh(box.vertices + 1, box.faces)
    assert box != rw.Mesh(box.vertices.astype(np.float32), box.faces)
    assert box != rw.Mesh(box.vertices, box.faces, normals=box.vertices)
    assert box != rw.Mesh(box.vertices, box.faces, material=rw.Diffuse(0.2))
    assert box != rw.Mesh(box.vertices, box.faces, emission=1)
    assert box != "box"


def test_nan_vertices_are_kept_and_equal_themselves():
    vertices = np.array(THREE)
    vertices[1, 2] = np.nan
    mesh = rw.Mesh(vertices, FACE)
    assert np.isnan(mesh.vertices[1, 2])
    assert mesh == rw.Mesh(vertices, FACE)
    assert np.array_equal(mesh.bounds, [(0, 0, 0), (0, 1, 0)])


def test_pickle_gives_an_equal_read_only_mesh(box):
    lamp = rw.Mesh(box.vertices, box.faces, box.vertices, box.vertices[:, :2], rw.Diffuse((0.1, 0.2, 0.3)), 4)
    back = pickle.loads(pickle.dumps(lamp))
    assert back == lamp
    assert not back.vertices.flags.writeable


def test_repr_is_one_short_line(box):
    assert repr(box) == "Mesh(8 vertices, 12 faces, Diffuse(reflectance=(0.5, 0.5, 0.5)))"


def test_bounds_are_of_vertices_in_use():
    mesh = rw.Mesh([*THREE, (9, 9, 9)], FACE)
    assert np.array_equal(mesh.bounds, [(0, 0, 0), (1, 1, 0)])


def test_transform_moves_vertices_and_keeps_normals_perpendicular(triangle):
    sheared = np.array([[2.0, 0, 0, 1], [0, 1, 0, 2], [1, 0, 1, 3], [0, 0, 0, 1]])
    mesh = rw.Mesh(triangle.vertices, triangle.faces, [(0, 0, 1)] * 3).transformed(sheared)
    a, b, c = mesh.vertices
    assert np.array_equal(a, (1, 2, 3))
    assert np.array_equal(b, (3, 2, 4))
    normal = np.cross(b - a, c - a)
    assert np.allclose(mesh.normals, normal / np.linalg.norm(normal))


def test_mirror_keeps_the_outside_outside(box):
    mirrored = rw.Mesh(box.vertices, box.faces, box.vertices - 0.5).transformed(np.diag([-1.0, 1, 1, 1]))
    assert _volume(box) == pytest.approx(1)
    assert _volume(mirrored) == pytest.approx(1)
    outward = mirrored.vertices - (-0.5, 0.5, 0.5)
    assert ((mirrored.normals * outward).sum(axis=1) > 0).all()


def _volume(mesh):
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return float((a * np.cross(b, c)).sum() / 6)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (
            (THREE, [(0, 1, 2), (0, 1, 3)]),
            ValueError,
            r"face 1 of faces is \(0, 1, 3\), but there are 3 vertices",
        ),
        ((THREE, [(0, -1, 2)]), ValueError, r"face 0 of faces is \(0, -1, 2\), but there are 3 vertices"),
        (([], FACE), ValueError, r"face 0 .* there are 0 vertices"),
        ((THREE, np.array([(0, 1, 2**63 + 2)], np.uint64)), ValueError, r"face 0 .* 9223372036854775810"),
        ((THREE, [(0.0, 1.0, 2.0)]), TypeError, r"faces must be integers, got .*float64"),
        ((THREE, [(True, False, True)]), TypeError, r"faces must be integers, got .*bool"),
        ((THREE, [(0, 1, 2, 3)]), ValueError, r"faces must have shape \(F, 3\), got \(1, 4\)"),
        ((THREE, np.empty((0, 4), np.int32)), ValueError, r"faces must have shape \(F, 3\), got \(0, 4\)"),
        ((THREE, [0, 1, 2]), ValueError, r"faces must have shape \(F, 3\), got \(3,\)"),
        ((THREE, [(0, 1, 2), (0, 1)]), ValueError, r"faces must be a rectangular array"),
        (([(0, 0), (1, 1)], FACE), ValueError, r"vertices must have shape \(N, 3\), got \(2, 2\)"),
        ((np.zeros((2, 3, 3)), FACE), ValueError, r"vertices must have shape \(N, 3\), got \(2, 3, 3\)"),
        (([("a", "b", "c")], FACE), TypeError, r"vertices must be real numbers"),
        (
            (np.zeros((3, 3), complex), FACE),
            TypeError,
            r"vertices must be real numbers, got dtype complex128",
        ),
        ((None, FACE), TypeError, r"vertices must be real numbers, got None"),
        ((THREE, FACE, [(0, 0, 1)]), ValueError, r"normals must have shape \(3, 3\), got \(1, 3\)"),
        ((THREE, FACE, None, THREE), ValueError, r"uv must have shape \(3, 2\), got \(3, 3\)"),
        ((THREE, FACE, None, None, 0.5), TypeError, r"material must be a raywright material, got float"),
        ((THREE, FACE, None, None, None, -1), ValueError, r"emission must be at least 0, got -1"),
        (
            (THREE, FACE, None, None, None, (1, 2)),
            ValueError,
            r"emission must be one number or 3, got shape \(2,\)",
        ),
        ((THREE, FACE, None, None, None, np.nan), ValueError, r"emission must be finite"),
    ],
)
def test_bad_meshes_are_refused_in_one_line(arguments, error, message):
    with pytest.raises(error, match=message) as caught:
        rw.Mesh(*arguments)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("matrix", [np.eye(3), np.full((4, 4), np.nan), np.ones((4, 4)), np.zeros((2, 4, 4))])
def test_transform_takes_affine_matrices_only(box, matrix):
    with pytest.raises(ValueError, match="matrix must"):
        box.transformed(matrix)
