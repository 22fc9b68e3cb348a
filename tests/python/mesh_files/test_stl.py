"""STL files in all the forms that programs write them."""

import re
import struct

import numpy as np
import pytest
import trimesh

import raywright as rw

BOX = trimesh.creation.box()
TEXT = BOX.export(file_type="stl_ascii")
BYTES = BOX.export(file_type="stl")


def read(tmp_path, data, name="a.stl"):
    path = tmp_path / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return rw.Scene(path).shapes


@pytest.mark.parametrize(
    "data",
    [
        TEXT,
        TEXT.replace("\n", "\r"),
        TEXT.replace("\n", "\r\n"),
        TEXT.replace("\n", "\n\n"),
        TEXT.replace("\n", " "),
        TEXT.replace(" ", "\t"),
        TEXT.replace(" ", "\n"),
        TEXT.replace("vertex ", "vertex\n   "),
        TEXT.replace("facet normal", "facet\n normal"),
        TEXT.replace("solid", "solid Part of a solid facet, vertex 1", 1),
        TEXT.upper(),
        "\ufeff" + TEXT,
        TEXT.encode("utf-16"),
        "\n\n  " + TEXT,
        "; made by hand\n" + TEXT,
        TEXT + "\n\n",
        TEXT + "\0\0\0\0",
        TEXT + "Exported on a Monday, 12 facets\n",
        TEXT.encode() + bytes(range(256)),
        re.sub(r"normal .*", "normal nan nan nan", TEXT),
        re.sub(r"normal .*", "normal -1.#IND -1.#IND 1.#QNAN", TEXT),
        re.sub(r"normal .*", "normal", TEXT),
        TEXT.replace("endsolid", "endsolid the name of it"),
        BYTES,
        BYTES + b"\n",
        BYTES + bytes(50),
        BYTES + b"solid facet normal endsolid" * 100,
        b"solid part".ljust(80) + BYTES[80:],
        b"solid part".ljust(80) + BYTES[80:] + b"behind the end",
        b"\xef\xbb\xbfsolid".ljust(80) + BYTES[80:],
    ],
)
def test_all_forms_of_a_box(tmp_path, data):
    (mesh,) = read(tmp_path, data)
    assert np.array_equal(mesh.vertices[mesh.faces], BOX.triangles)
    assert len(mesh.vertices) == 8
    assert mesh.name == "a.stl"


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_solids_of_text_are_meshes_of_their_names(tmp_path, end):
    moved = BOX.copy()
    moved.apply_translation((5, 0, 0))
    two = [
        re.sub("^solid.*", f"solid {name}", made.export(file_type="stl_ascii"))
        for name, made in (("The first", BOX), ("second", moved))
    ]
    for text in ("\n".join(two), "\n".join(re.sub("endsolid.*", "endsolid The solid", one) for one in two)):
        first, second = read(tmp_path, text.replace("\n", end))
        assert (first.name, second.name) == ("The first", "second")
        assert np.array_equal(second.vertices[second.faces], moved.triangles)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("kind", ["stl", "stl_ascii"])
def test_trimesh_reads_the_same(tmp_path, kind, seed):
    made = trimesh.creation.icosphere(subdivisions=1)
    made.vertices += np.random.default_rng(seed).normal(size=made.vertices.shape)
    path = tmp_path / "ball.stl"
    data = made.export(file_type=kind)
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    (mesh,), oracle = rw.Scene(path).shapes, trimesh.load(path, process=False)
    assert np.array_equal(mesh.vertices[mesh.faces], oracle.triangles)


def test_facets_with_more_corners_are_triangulated(tmp_path):
    corners = "".join(f"vertex {x} {y} 0\n" for x, y in ((0, 0), (4, 1), (0, 2), (1.5, 1)))
    facet = f"facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n"
    (mesh,) = read(tmp_path, f"solid a\n{facet}endsolid a\n")
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    assert np.cross(b - a, c - a)[:, 2].sum() == 5
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (TEXT.replace("vertex", "vertex x", 1), "not a mesh that can be read"),
        (TEXT.replace("endfacet", "", 1), "12 facets begin and 11 end"),
        (TEXT[: TEXT.rindex("endsolid")], "12 facets begin and 12 end, and the solid does not end"),
        (BYTES[:-1], "it has 12 faces by its header, and room for 11"),
        (b"solid".ljust(80) + struct.pack("<I", 0), "holds no faces"),
        ("solid\nendsolid\n", "holds no faces"),
    ],
)
def test_what_cannot_be_read_is_told(tmp_path, data, message):
    with pytest.raises(ValueError, match=message):
        read(tmp_path, data)
