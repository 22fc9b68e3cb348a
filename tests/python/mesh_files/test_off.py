"""OFF files in all the forms that programs write them."""

import struct

import numpy as np
import pytest
import trimesh

import raywright as rw

CUBE = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
VERTICES = "".join(f"{x} {y} {z}\n" for x, y, z in CUBE)
FACES = "".join(f"4 {' '.join(map(str, quad))}\n" for quad in QUADS)
PLAIN = f"OFF\n8 6 12\n{VERTICES}{FACES}"


def read(tmp_path, text, name="a.off"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    (mesh,) = rw.Scene(path).shapes
    return mesh


def volume(mesh):
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume


@pytest.mark.parametrize(
    "text",
    [
        PLAIN,
        PLAIN.replace(" ", "\n"),
        PLAIN.replace("\n", " ").replace("OFF ", "OFF\n"),
        PLAIN.replace("\n", " "),
        PLAIN.replace("\n", "\r"),
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("\n", "\n\n"),
        PLAIN.replace(" ", "\t \t"),
        PLAIN.replace("\n", "\f\n"),
        PLAIN.replace("\n", "\v"),
        PLAIN.replace("\n", "\u2028"),
        PLAIN.replace(" ", "\u00a0"),
        PLAIN.replace("OFF\n", "OFF"),
        PLAIN.replace("OFF\n", "OFF "),
        PLAIN.replace("OFF\n", ""),
        PLAIN.replace("OFF", "off"),
        "\ufeff" + PLAIN,
        "\ufeff" + PLAIN.removeprefix("OFF\n"),
        "\n  \n" + PLAIN,
        "# made by hand\n" + PLAIN,
        PLAIN.replace("8 6 12", "# counts\n\n8 6 12 # of vertices, faces, edges"),
        PLAIN.replace("\n", " # Größe\n"),
        PLAIN.replace("8 6 12", "8 6"),
        PLAIN.replace("8 6 12", "8 6\n12"),
        PLAIN.replace("8 6 12", "8\n6\n12"),
        PLAIN.rstrip("\n"),
        PLAIN + "\n\n",
        PLAIN + "\x00\x00\x00",
        PLAIN + "# the end\n",
        PLAIN + "and more\n",
        PLAIN.replace(VERTICES, VERTICES.replace("\n", " 255 0 0\n")),
        PLAIN.replace(FACES, FACES.replace("\n", " 255 128 0\n")),
        PLAIN.replace(FACES, FACES.replace("\n", " 1.0 0.5 0 1\n")),
        PLAIN.replace(FACES, FACES.replace("\n", " 7\n", 3)),
        PLAIN.encode("utf-16"),
        PLAIN.replace("0 ", "0.000e+00 ").replace("1 ", "+1. ").replace("4 +1. ", "4 1 "),
    ],
)
def test_all_forms_of_a_cube(tmp_path, text):
    mesh = read(tmp_path, text)
    assert mesh.vertices.tolist() == [list(map(float, p)) for p in CUBE]
    assert len(mesh.faces) == 12
    assert volume(mesh) == 1
    assert mesh.material == rw.Diffuse()


def row(letters, point):
    """A vertex as letters before OFF say: its normal points out, color and coordinates are its place."""
    out = np.sign(np.array(point) - 0.5).tolist()
    words = list(point)
    words += [1] * ("4" in letters)
    words += out * ("N" in letters)
    words += [*point, 1] * ("C" in letters)
    words += point[:2] * ("ST" in letters)
    return " ".join(map(str, words))


@pytest.mark.parametrize("letters", ["", "N", "C", "CN", "NC", "ST", "STN", "STCN", "4", "C4", "STCN4"])
@pytest.mark.parametrize("apart", [" ", "\n"])
def test_letters_tell_what_vertices_have(tmp_path, letters, apart):
    vertices = "".join(row(letters, point) + "\n" for point in CUBE)
    mesh = read(tmp_path, f"{letters}OFF\n8 6 12\n{vertices}{FACES}".replace(" ", apart))
    assert mesh.vertices.tolist() == [list(map(float, p)) for p in CUBE]
    assert volume(mesh) == 1
    if "N" in letters:
        assert np.array_equal(np.sign(mesh.normals), np.sign(np.array(CUBE) - 0.5))
    assert (mesh.normals is None) == ("N" not in letters)
    assert (mesh.uv is None) == ("ST" not in letters)
    if "ST" in letters:
        assert np.array_equal(mesh.uv, np.array(CUBE)[:, :2])
    assert (mesh.colors is None) == ("C" not in letters)
    if "C" in letters:
        assert np.array_equal(mesh.colors, CUBE)


@pytest.mark.parametrize("numbers", [3, 4])
@pytest.mark.parametrize("most", [255, 1.0])
def test_colors_have_three_or_four_numbers(tmp_path, numbers, most):
    vertices = "".join(
        " ".join(map(str, (*point, *(c * most for c in (*point, 1)[:numbers])))) + "\n" for point in CUBE
    )
    mesh = read(tmp_path, f"COFF\n8 6 12\n{vertices}{FACES}")
    assert np.array_equal(mesh.colors, CUBE)
    assert mesh.material == rw.Diffuse(rw.VertexColors())


def test_homogeneous_coordinates_are_divided(tmp_path):
    vertices = "".join(f"{2 * x} {2 * y} {2 * z} 2\n" for x, y, z in CUBE)
    assert volume(read(tmp_path, f"4OFF\n8 6 12\n{vertices}{FACES}")) == 1


@pytest.mark.parametrize("colors", [0, 3])
def test_bytes(tmp_path, colors):
    data = b"OFF BINARY\n" + struct.pack(">3i", 8, 6, 12) + np.array(CUBE, ">f4").tobytes()
    for quad in QUADS:
        data += struct.pack(">6i", 4, *quad, colors) + struct.pack(f">{colors}f", *[0.5] * colors)
    mesh = read(tmp_path, data)
    assert volume(mesh) == 1
    assert mesh.vertices.tolist() == [list(map(float, p)) for p in CUBE]
    with pytest.raises(ValueError, match="cut short"):
        read(tmp_path, data[:-1], "cut.off")


@pytest.mark.parametrize("first", range(4))
def test_concave_polygons_keep_their_area(tmp_path, first):
    ring = np.roll(np.arange(4), first)
    mesh = read(tmp_path, f"OFF 4 1 0\n0 0 0\n4 1 0\n0 2 0\n1.5 1 0\n4 {' '.join(map(str, ring))}\n")
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.linalg.norm(normals, axis=1).sum() == 5


def test_polygons_of_several_sizes_and_edges(tmp_path):
    text = "OFF\n5 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n.5 1.5 0\n3 0 1 2\n2 0 1\n3 0 2 3\n5 0 1 2 4 3\n"
    for form in (text, text.replace(" ", "\n"), text.replace("\n", "  0 0 1\n").replace("OFF  0 0 1", "OFF")):
        form = form.replace("5 4 0  0 0 1", "5 4 0")
        mesh = read(tmp_path, form)
        assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 4], [0, 4, 3]]


@pytest.mark.parametrize("seed", range(6))
def test_trimesh_reads_the_same(tmp_path, seed):
    made = trimesh.creation.icosphere(subdivisions=1)
    made.vertices += np.random.default_rng(seed).normal(size=made.vertices.shape)
    path = tmp_path / "ball.off"
    path.write_text(made.export(file_type="off"))
    (mesh,), oracle = rw.Scene(path).shapes, trimesh.load(path, process=False)
    assert np.array_equal(mesh.vertices, oracle.vertices)
    assert np.array_equal(mesh.faces, oracle.faces)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (PLAIN.replace("8 6", "x 6"), "it has no counts of vertices and faces"),
        (PLAIN.replace("8 6", "-8 6"), "it has no counts of vertices and faces"),
        ("OFF\n", "it has no counts of vertices and faces"),
        ("nOFF\n4 3 1 0\n", "any number of dimensions"),
        (PLAIN.replace("4 0 2 3 1", "4 0 2 3 8"), "a face has vertex 8, but there are 8 vertices"),
        (PLAIN.replace("4 0 2 3 1", "4 0 2 3 -1"), "a face has vertex -1, but there are 8 vertices"),
        (PLAIN.replace("1 0 1", "1 zero 1"), "'zero', which is not a number"),
    ],
)
def test_what_cannot_be_read_is_told(tmp_path, text, message):
    with pytest.raises(ValueError, match=message) as caught:
        read(tmp_path, text)
    assert "a.off is not a mesh that can be read" in str(caught.value)
