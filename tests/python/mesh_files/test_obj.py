"""Triangles of OBJ files: all forms of them, in their order."""

import warnings

import numpy as np
import pytest
from PIL import Image

import raywright as rw
from raywright.mesh_files.meshes import load_whole

POINTS = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"


def read(tmp_path, text, *told):
    path = tmp_path / "file.obj"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        shapes = rw.Scene(path).shapes
    assert [str(one.message) for one in caught] == [f"file.obj: {one}" for one in told]
    return shapes


def triangles(mesh):
    return mesh.vertices[mesh.faces].tolist()


def corners(*numbers):
    points = [[float(word) for word in line.split()[1:]] for line in POINTS.splitlines()]
    return [[points[i - 1] for i in face] for face in numbers]


def test_polygons_are_fans_in_the_order_of_the_file(tmp_path):
    """Of squares alone, and of squares beside others."""
    (squares,) = read(tmp_path, f"{POINTS}f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\n")
    assert triangles(squares) == corners((1, 2, 3), (1, 3, 4), (5, 6, 7), (5, 7, 8), (1, 2, 6), (1, 6, 5))
    (mixed,) = read(tmp_path, f"{POINTS}f 1 2 3 4\nf 5 6 7\nf 1 2 6 7 5\nf 3 4\n")
    expected = corners((1, 2, 3), (1, 3, 4), (5, 6, 7), (1, 2, 6), (1, 6, 7), (1, 7, 5))
    assert triangles(mixed) == expected
    hits = rw.Scene(squares).intersect([(0.9, 0.1, -1), (0.9, 0.1, 2)], [(0, 0, 1), (0, 0, -1)])
    assert hits.primitive_id.tolist() == [0, 2]


def test_materials_come_in_the_order_of_the_file(tmp_path):
    (tmp_path / "file.mtl").write_text("newmtl b\nKd 1 0 0\nnewmtl a\nKd 0 1 0\n")
    faces = "f 1 2 3\nusemtl a\nusemtl b\nf 2 3 4\nusemtl a\nf 3 4 5\nusemtl b\nf 4 5 6\n"
    shapes = read(tmp_path, f"mtllib file.mtl\n{POINTS}{faces}")
    assert [shape.material for shape in shapes] == [
        rw.Diffuse(),
        rw.Diffuse((1, 0, 0)),
        rw.Diffuse((0, 1, 0)),
    ]
    expected = [corners((1, 2, 3)), corners((2, 3, 4), (4, 5, 6)), corners((3, 4, 5))]
    assert [triangles(shape) for shape in shapes] == expected


def test_numbers_may_count_back_from_where_they_stand(tmp_path):
    """Each of two objects counts from its own last vertex, coordinate and normal."""
    one = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nf -3/-3/-1 -2/-2/-1 -1/-1/-1\n"
    two = "v 0 0 5\nv 1 0 5\nv 0 1 5\nvt .5 0\nvt 1 .5\nvt .5 1\nvn 1 0 0\nf -3/-3/-1 -2/-2/-1 -1/-1/-1\n"
    (mesh,) = read(tmp_path, one + two)
    assert triangles(mesh) == [
        [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        [[0, 0, 5], [1, 0, 5], [0, 1, 5]],
    ]
    uv, normals = mesh.uv[mesh.faces], mesh.normals[mesh.faces]
    assert uv[1].tolist() == [[0.5, 0], [1, 0.5], [0.5, 1]]
    assert normals[:, 0].tolist() == [[0, 0, 1], [1, 0, 0]]


@pytest.mark.parametrize("first", range(4))
def test_concave_polygons_keep_their_area(tmp_path, first):
    order = np.roll([1, 2, 3, 4], first)
    text = "v 0 0 0\nv 4 1 0\nv 0 2 0\nv 1.5 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    (mesh,) = read(tmp_path, text + "f " + " ".join(f"{k}/{k}" for k in order) + "\n")
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normals[:, 2] > 0).all()
    assert normals[:, 2].sum() == 5
    # Each corner keeps its coordinates.
    own = {(0, 0): [0, 0], (4, 1): [1, 0], (0, 2): [1, 1], (1.5, 1): [0, 1]}
    for place, uv in zip(mesh.vertices.tolist(), mesh.uv.tolist(), strict=True):
        assert uv == own[tuple(place[:2])]


@pytest.mark.parametrize("seed", range(6))
def test_all_forms_of_faces_say_the_same(tmp_path, seed):
    """The same random polygons: each line in a form of its own, with other white space and line ends."""
    rng = np.random.default_rng(seed)
    # Points on a circle, so that polygons are convex.
    angles = np.sort(rng.uniform(0, 2 * np.pi, 20))
    points = np.stack([np.cos(angles), np.sin(angles), rng.normal() - np.sin(angles)], axis=1)
    uv, normals = rng.random((9, 2)), rng.normal(size=(7, 3))
    faces = [rng.integers(0, (20, 9, 7), (rng.integers(3, 7), 3)) for _ in range(40)]
    for face in faces:
        face[:, 0] = np.sort(rng.choice(20, len(face), replace=False))
    lines = [
        f"{keyword} {' '.join(map(repr, row.tolist()))}"
        for keyword, table in (("v", points), ("vt", uv), ("vn", normals))
        for row in table
    ]
    counts = np.array([20, 9, 7])

    def told(corner):
        back = rng.random() < 0.2
        return "/".join(str(n) for n in (corner - counts if back else corner + 1))

    for face in faces:
        between = rng.choice([" ", "  ", "\t", " \\\n "])
        lines.append(
            rng.choice(["", " ", "\t"]) + "f " + between.join(map(told, face)) + rng.choice(["", " # x"])
        )
        lines += rng.choice(["", "o a", "g b c", "s 1", "# f 1 2 3"], 1).tolist()
    end = rng.choice(["\n", "\r\n", "\r"])
    text = end.join(lines).replace("\n", end) if end != "\n" else "\n".join(lines)
    (mesh,) = read(tmp_path, text.encode("utf-16") if seed == 5 else text)
    expected = [np.stack([f[[0, i, i + 1]] for i in range(1, len(f) - 1)]) for f in faces]
    index = np.concatenate(expected)
    assert np.array_equal(mesh.vertices[mesh.faces], points[index[..., 0]])
    assert np.array_equal(mesh.uv[mesh.faces], uv[index[..., 1]])
    assert np.array_equal(mesh.normals[mesh.faces], normals[index[..., 2]])
    # One vertex for each of its uses, and no more.
    assert len(mesh.vertices) == len(np.unique(index.reshape(-1, 3), axis=0))


@pytest.mark.parametrize(
    ("faces", "uv", "normals"),
    [
        ("f 1 2 3", None, None),
        ("f 1/ 2/ 3/", None, None),
        ("f 1// 2// 3//", None, None),
        ("f 1//1 2//1 3//1", None, 1),
        ("f 1/1 2/2 3/3", [[[0, 0], [1, 0], [1, 1]]], None),
        ("f 1/1/ 2/2/ 3/3/", [[[0, 0], [1, 0], [1, 1]]], None),
        ("f 1/1/1 2/2/1 3/3/1", [[[0, 0], [1, 0], [1, 1]]], 1),
        # Faces without coordinates have those of the pictures' corner, and normals count if all faces have
        # them.
        ("f 1/2/1 2/3/1 3/4/1\nf 1 2 4", [[[1, 0], [1, 1], [0, 1]], [[0, 0]] * 3], None),
        ("fo 1 2 3", None, None),
    ],
)
def test_what_a_corner_has(tmp_path, faces, uv, normals):
    head = f"{POINTS}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 2\n"
    (mesh,) = read(tmp_path, f"{head}{faces}\n")
    assert (mesh.uv is None and uv is None) or mesh.uv[mesh.faces].tolist() == uv
    assert (mesh.normals is None) == (normals is None)


def test_what_faces_name_and_is_not_there_is_told(tmp_path):
    missing = "what faces name, and is not there, is left out: "
    (mesh,) = read(tmp_path, f"{POINTS}vt 0 0\nf 1/1 2/2 3/1\n", f"{missing}texture coordinates")
    assert mesh.uv is None
    (mesh,) = read(tmp_path, f"{POINTS}vn 0 0 1\nf 1//1 2//-2 3//1\n", f"{missing}normals")
    assert mesh.normals is None


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("f 0 1 2", r"a face has vertex 0, out of bounds: there are 8"),
        ("f 1 2 9", r"a face has vertex 9, out of bounds: there are 8"),
        ("f 1 2 -9", r"a face has vertex -9, out of bounds: there are 8"),
        ("f 1 2 -99999999999999999999", r"a face has vertex [-0-9]+, out of bounds"),
        ("f 1 2 1.5", r"a face has corner '1.5'"),
        ("f 1 2 x", r"a face has corner 'x'"),
        ("f 1/2/3/4 2 3", r"a face has corner '1/2/3/4'"),
        ("f 1 2 /3", r"a face has vertex 0, out of bounds"),
        ("f 1 2 " + "9" * 5000, r"a face has (corner|vertex) '?9"),
        ("v 1 2\nf 1 2 3", r"vertices must have shape \(N, 3\), and one is '1 2'"),
        ("v 1 2 x\nf 1 2 3", r"vertices have 'x', which is not a number"),
        ("v 1,5 2 0\nf 1 2 3", r"vertices have '1,5', which is not a number"),
        ("vn 0 1\nf 1 2 3", r"normals must have shape \(N, 3\), and one is '0 1'"),
        ("vt \nf 1 2 3", r"texture coordinates must have shape \(N, 1\), and one is ''"),
    ],
)
def test_what_is_broken_is_refused(tmp_path, lines, message):
    (tmp_path / "file.obj").write_text(f"{POINTS}{lines}\n")
    with pytest.raises(ValueError, match=rf"file.obj is not a mesh that can be read \({message}") as caught:
        rw.Scene(tmp_path / "file.obj")
    assert len(str(caught.value)) < 250 + len(str(tmp_path))


def test_colors_of_vertices_are_srgb(tmp_path):
    points = "v 0 0 0 1 0 0\nv 1 0 0 0 0.5 0\nv 0 1 0 0 0 1\nf 1 2 3\n"
    (mesh,) = read(tmp_path, points)
    assert mesh.material == rw.Diffuse(rw.VertexColors())
    assert mesh.colors == pytest.approx(np.diag([1, ((0.5 + 0.055) / 1.055) ** 2.4, 1]))
    (same,) = read(
        tmp_path,
        points.replace("0.5", "127.5").replace(" 1 0 0\n", " 255 0 0\n", 1).replace(" 0 0 1\n", " 0 0 255\n"),
    )
    assert same.colors == pytest.approx(mesh.colors)
    (even,) = read(tmp_path, "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n")
    assert (even.material, even.colors) == (rw.Diffuse((1, 0, 0)), None)


def test_files_of_mitsuba_are_read_whole_and_in_order(tmp_path):
    (tmp_path / "file.obj").write_text(f"mtllib none.mtl\n{POINTS}usemtl a\nf 1 2 3 4\nusemtl b\nf 5 6 7 8\n")
    mesh = load_whole(tmp_path / "file.obj", "obj")
    assert triangles(mesh) == corners((1, 2, 3), (1, 3, 4), (5, 6, 7), (5, 7, 8))


def test_files_without_faces_hold_none(tmp_path):
    (tmp_path / "file.obj").write_text(POINTS + "l 1 2\np 3\n")
    with pytest.raises(ValueError, match=r"file.obj holds no faces"):
        rw.Scene(tmp_path / "file.obj")


@pytest.mark.parametrize(
    ("named", "there"),
    [
        ("a.mtl", "A.MTL"),
        ("A.MTL", "a.mtl"),
        ("Parts\\\\Red.mtl", "parts/RED.MTL"),
        ("parts/red.mtl", "Parts/red.mtl"),
        ("C:\\\\work\\\\a.mtl", "A.mtl"),
        ("two words.mtl", "Two Words.MTL"),
    ],
)
def test_libraries_are_found_whatever_the_case_of_their_letters(tmp_path, named, there):
    (tmp_path / there).parent.mkdir(exist_ok=True)
    (tmp_path / there).write_text("newmtl red\nKd 1 0 0\nmap_Kd picture.png\n")
    Image.new("RGB", (1, 1), (255, 0, 0)).save((tmp_path / there).parent / "PICTURE.PNG")
    text = f"mtllib {named.replace(chr(92) * 2, chr(92))}\n" + "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n"
    (mesh,) = read(tmp_path, f"{text}usemtl red\nf 1/1 2/1 3/1\n")
    assert isinstance(mesh.material.reflectance, rw.ImageTexture)


def test_names_of_the_same_letters_are_told_apart_where_both_are_there(tmp_path):
    for name, color in (("a.mtl", "1 0 0"), ("A.MTL", "0 1 0")):
        (tmp_path / name).write_text(f"newmtl m\nKd {color}\n")
    for name, color in (("a.mtl", (1, 0, 0)), ("A.MTL", (0, 1, 0))):
        (mesh,) = read(tmp_path, f"mtllib {name}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")
        assert mesh.material.reflectance == color


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "\ufeff" + text,
        lambda text: text.replace("\n", "\r"),
        lambda text: text.replace("\n", "\f\n"),
        lambda text: text.replace(" ", " \t "),
        lambda text: text.replace("\n", " # Größe\n"),
        lambda text: text + "\0\0\0",
        lambda text: text + "\x1a",
        lambda text: "g Größe\n" + text,
    ],
)
def test_white_space_and_ends_of_files_may_be_any(tmp_path, change):
    text = "v 0 0 0\nv 4 1 0\nv 0 2 0\nv 1.5 1 0\nf 1 2 3 4\n"
    (mesh,) = read(tmp_path, change(text))
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    assert np.cross(b - a, c - a)[:, 2].sum() == 5
