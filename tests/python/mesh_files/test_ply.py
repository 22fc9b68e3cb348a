"""PLY files in all the forms that programs write them."""

import re
import struct

import numpy as np
import pytest
import trimesh
from PIL import Image

import raywright as rw

CUBE = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
# Five quads and two triangles with outward normals, as Blender writes a cube with one face split.
POLYGONS = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7], [1, 7, 5]]
CODES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I"}
CODES |= {"float": "f", "double": "d"}


def only(path):
    (mesh,) = rw.Scene(path).shapes
    return mesh


def area(mesh):
    corners = mesh.vertices[mesh.faces]
    return (
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
        / 2
    )


def write(path, form, elements, end="\n", between="\n", header=()):
    """Write elements: a name, properties as (type, name) or (count type, type, name), and rows."""
    lines = ["ply", f"format {form} 1.0", "comment made by hand", *header]
    body = b""
    for name, properties, rows in elements:
        lines.append(f"element {name} {len(rows)}")
        for *types, called in properties:
            lines.append(f"property {'list ' * (len(types) == 2)}{' '.join(types)} {called}")
        for row in rows:
            words = []
            for (*types, _), value in zip(properties, row, strict=True):
                if len(types) == 2:
                    words.append((types[0], len(value)))
                words += [(types[-1], one) for one in (value if len(types) == 2 else [value])]
            if form == "ascii":
                body += between.join(repr(v) for _, v in words).encode() + end.encode()
            else:
                order = "<" if "little" in form else ">"
                body += b"".join(struct.pack(order + CODES[kind], v) for kind, v in words)
    path.write_bytes(end.join([*lines, "end_header", ""]).encode() + body)
    return path


def xyz(kind="float"):
    return [(kind, axis) for axis in "xyz"]


def faces(rows):
    return ("face", [("uchar", "int", "vertex_indices")], [(row,) for row in rows])


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_polygons_of_several_sizes_are_read(tmp_path, form):
    mesh = only(write(tmp_path / "cube.ply", form, [("vertex", xyz(), CUBE.tolist()), faces(POLYGONS)]))
    assert np.array_equal(mesh.vertices, CUBE)
    assert len(mesh.faces) == 12
    assert area(mesh) == 6
    assert trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume == pytest.approx(1, rel=1e-15)
    # pbrt reads the same files.
    (tmp_path / "scene.pbrt").write_text(
        'Camera "perspective"\nWorldBegin\nShape "plymesh" "string filename" "cube.ply"\n'
    )
    assert len(rw.load(tmp_path / "scene.pbrt").scene.shapes[0].faces) == 12


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
@pytest.mark.parametrize("first", range(4))
def test_concave_polygons_keep_their_area(tmp_path, form, first):
    points = [(0, 0, 0), (4, 1, 0), (0, 2, 0), (1.5, 1, 0)]
    ring = np.roll(np.arange(4), first).tolist()
    mesh = only(write(tmp_path / "arrow.ply", form, [("vertex", xyz(), points), faces([ring])]))
    assert area(mesh) == 2.5


@pytest.mark.parametrize("seed", range(30))
def test_any_form_says_the_same(tmp_path, seed):
    """Random elements and properties, of which only those that matter are looked at."""
    rng = np.random.default_rng(seed)
    form = ["ascii", "binary_little_endian", "binary_big_endian"][seed % 3]
    count = int(rng.integers(4, 30))
    turns = np.sort(rng.uniform(0, 6, count))
    points = np.stack([np.cos(turns), np.sin(turns), rng.normal() * np.sin(turns)], axis=1).astype(np.float32)
    sizes = np.full(9, 3 + seed % 2) if rng.random() < 0.4 else rng.integers(2, min(count, 7), 9)
    rings = [np.sort(rng.choice(count, n, replace=False)).tolist() for n in sizes]
    kind = rng.choice(["float", "double"])
    vertex, rows = xyz(kind), [list(map(float, p)) for p in points]
    if rng.random() < 0.5:
        vertex.insert(int(rng.integers(4)), ("uchar", "quality"))
        place = [name for _, name in vertex].index("quality")
        for row in rows:
            row.insert(place, int(rng.integers(256)))
    if rng.random() < 0.5:
        vertex.append(("uchar", "short", "tags"))
        for row in rows:
            row.append(rng.integers(-5, 5, rng.integers(0, 4)).tolist())
    face = [(str(rng.choice(["uchar", "int", "ushort"])), str(rng.choice(["int", "uint"])), "vertex_index")]
    polygons = [[ring] for ring in rings]
    for name in ("flags", "before"):
        if rng.random() < 0.5:
            at = 0 if name == "before" else len(face)
            face.insert(at, ("int", name))
            for row in polygons:
                row.insert(at, int(rng.integers(-9, 9)))
    if rng.random() < 0.3:
        face.append(("uchar", "float", "texcoord"))
        for ring, row in zip(rings, polygons, strict=True):
            row.append([0.0, 0.5] * len(ring))
    elements = [("vertex", vertex, rows), ("face", face, polygons)]
    if rng.random() < 0.5:
        elements.insert(int(rng.integers(3)), ("edge", [("int", "vertex1")], [(1,), (2,)]))
    end, between = rng.choice(["\n", "\r\n", "\r"]), rng.choice([" ", "\t", "\n", "  ", "\r\n"])
    mesh = only(write(tmp_path / "any.ply", form, elements, end, between))
    wanted = [points[[ring[0], ring[k], ring[k + 1]]] for ring in rings for k in range(1, len(ring) - 1)]
    assert np.array_equal(mesh.vertices[mesh.faces], wanted)


@pytest.mark.parametrize("name", ["cube", "ball", "cylinder"])
@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_trimesh_reads_the_same(tmp_path, name, encoding):
    made = {
        "cube": trimesh.creation.box(),
        "ball": trimesh.creation.icosphere(subdivisions=2),
        "cylinder": trimesh.creation.cylinder(1, 2),
    }[name]
    path = tmp_path / f"{name}.ply"
    path.write_bytes(made.export(file_type="ply", encoding=encoding, vertex_normal=True))
    mesh, oracle = only(path), trimesh.load(path, process=False)
    assert np.array_equal(mesh.vertices, oracle.vertices)
    assert np.array_equal(mesh.faces, oracle.faces)
    assert np.array_equal(mesh.normals, oracle.vertex_normals)


SQUARE = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)]


@pytest.mark.parametrize(
    "names", ["red green blue", "r g b", "diffuse_red diffuse_green diffuse_blue", "Red Green Blue"]
)
@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
@pytest.mark.parametrize("kind", ["uchar", "ushort", "float"])
def test_colors_have_many_names(tmp_path, names, form, kind):
    most = {"uchar": 255, "ushort": 65535, "float": 1.0}[kind]
    vertex = xyz() + [(kind, name) for name in names.split()]
    shares = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)]
    rows = [(*p, *(c * most for c in color)) for p, color in zip(SQUARE, shares, strict=True)]
    mesh = only(write(tmp_path / "colors.ply", form, [("vertex", vertex, rows), faces([[0, 1, 2, 3]])]))
    assert mesh.material == rw.Diffuse(rw.VertexColors())
    assert np.array_equal(mesh.colors, shares)


def test_dark_colors_of_integers_stay_dark(tmp_path):
    vertex = xyz() + [("uchar", name) for name in ("red", "green", "blue")]
    rows = [(*p, 1, 0, k % 2) for k, p in enumerate(SQUARE)]
    mesh = only(write(tmp_path / "dark.ply", "ascii", [("vertex", vertex, rows), faces([[0, 1, 2, 3]])]))
    assert mesh.colors[0] == pytest.approx((1 / 255 / 12.92, 0, 0), rel=1e-12)


def test_one_color_of_all_and_the_most_frequent_one_of_faces(tmp_path):
    vertex = xyz() + [("uchar", name) for name in ("red", "green", "blue", "alpha")]
    rows = [(*p, 255, 0, 188, 255) for p in SQUARE]
    mesh = only(write(tmp_path / "one.ply", "ascii", [("vertex", vertex, rows), faces([[0, 1, 2, 3]])]))
    assert mesh.material.reflectance == pytest.approx((1, 0, 0.502886), abs=1e-6)
    face = [("uchar", "int", "vertex_indices"), *(("uchar", name) for name in "rgb")]
    rows = [([0, 1, 2], 255, 0, 0), ([0, 2, 3], 0, 255, 0), ([0, 1, 3], 0, 255, 0)]
    mesh = only(write(tmp_path / "faces.ply", "ascii", [("vertex", xyz(), SQUARE), ("face", face, rows)]))
    assert mesh.material.reflectance == (0, 1, 0)


@pytest.mark.parametrize("names", ["u v", "s t", "texture_u texture_v"])
def test_pictures_lie_on_coordinates_of_vertices(tmp_path, names):
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "Red Bricks.PNG")
    vertex = xyz() + [("float", name) for name in names.split()]
    rows = [(*p, p[0], p[1]) for p in SQUARE]
    elements = [("vertex", vertex, rows), faces([[0, 1, 2, 3]])]
    path = write(tmp_path / "on.ply", "ascii", elements, header=["comment TextureFile red bricks.png"])
    mesh = only(path)
    assert np.array_equal(mesh.uv, mesh.vertices[:, :2])
    assert isinstance(mesh.material.reflectance, rw.ImageTexture)
    path.write_bytes(path.read_bytes().replace(b"red bricks", b"missing"))
    with pytest.warns(RuntimeWarning, match=r"on.ply: its picture 'missing.png' is left out"):
        only(path)


def test_coordinates_of_corners_part_vertices(tmp_path):
    face = [("uchar", "int", "vertex_indices"), ("uchar", "float", "texcoord")]
    rows = [([0, 1, 2], [0.0, 0.0, 1.0, 0.0, 1.0, 1.0]), ([0, 2, 3], [0.5, 0.0, 1.0, 1.0, 0.0, 1.0])]
    mesh = only(write(tmp_path / "corners.ply", "ascii", [("vertex", xyz(), SQUARE), ("face", face, rows)]))
    assert len(mesh.vertices) == 5
    assert mesh.uv[mesh.faces].reshape(2, 6).tolist() == [row[1] for row in rows]
    assert mesh.vertices[mesh.faces].tolist() == [[list(SQUARE[i]) for i in row[0]] for row in rows]


@pytest.mark.parametrize("form", ["ascii", "binary_big_endian"])
def test_strips_of_triangles(tmp_path, form):
    """As Stanford's scans have them: -1 ends a strip."""
    points = [(float(k // 2), float(k % 2), 0.0) for k in range(8)]
    strips = (
        "tristrips",
        [("int", "int", "vertex_indices")],
        [([0, 2, 1, 3, 5, -1, 4, 6, 5, 7],), ([0, 2, 1],)],
    )
    mesh = only(write(tmp_path / "strips.ply", form, [("vertex", xyz(), points), strips]))
    assert mesh.faces.tolist() == [[0, 2, 1], [2, 3, 1], [1, 3, 5], [4, 6, 5], [6, 7, 5], [0, 2, 1]] or (
        mesh.faces.tolist() == [[0, 2, 1], [1, 2, 3], [1, 3, 5], [4, 6, 5], [5, 6, 7], [0, 2, 1]]
    )
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.array_equal(normals[[0, 1, 3, 4, 5]], np.tile((0, 0, 1), (5, 1)))


@pytest.mark.parametrize(
    "change",
    [
        lambda data: b"\xef\xbb\xbf" + data,
        lambda data: data.decode().encode("utf-16"),
        lambda data: data + b"\n\n1 2 3 extra\n",
        lambda data: data + bytes(7),
        lambda data: data.replace(b"ply\n", b"PLY\n", 1),
        lambda data: data.replace(b"3 0 1 2\n", b"3 0 1 2 255 128 0\n"),
        lambda data: data.replace(b"end_header\n", b"end_header\n\n\n"),
        lambda data: data.replace(b" ", b"   ").replace(b"\n", b" \n"),
        lambda data: data.replace(b"\n", b"\r"),
        lambda data: data.replace(b"end_header\n", b"end_header\ncomment 1 2 3\n"),
        lambda data: re.sub(
            rb"(?<=end_header\n).*", lambda m: m[0].replace(b"\n", b" "), data, flags=re.DOTALL
        ),
        lambda data: re.sub(
            rb"(?<=end_header\n).*", lambda m: m[0].replace(b" ", b"\n"), data, flags=re.DOTALL
        ),
    ],
)
def test_text_is_read_by_its_numbers(tmp_path, change):
    path = write(tmp_path / "a.ply", "ascii", [("vertex", xyz(), SQUARE), faces([[0, 1, 2], [0, 2, 3]])])
    path.write_bytes(change(path.read_bytes()))
    mesh = only(path)
    assert mesh.vertices.tolist() == [list(p) for p in SQUARE]
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_bytes_may_begin_with_those_of_line_ends(tmp_path, end):
    """The first coordinate is 1.5e-19, or bytes 0a 0a 0d 20."""
    first = struct.unpack("<f", b"\x0a\x0a\x0d\x20")[0]
    points = [(first, 0.0, 0.0), *SQUARE[1:]]
    elements = [("vertex", xyz(), points), faces([[0, 1, 2, 3]])]
    path = write(tmp_path / "a.ply", "binary_little_endian", elements, end)
    path.write_bytes(path.read_bytes() + b"behind the end")
    assert only(path).vertices[0, 0] == first


def test_many_polygons_are_read_at_once(tmp_path):
    """As fast as numpy copies them: 40,000 faces of several sizes."""
    count = 20_000
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {4 * count}\n" + "".join(
        f"property float {axis}\n" for axis in "xyz"
    )
    head += f"element face {2 * count}\nproperty list uchar int vertex_indices\nend_header\n"
    points = (np.array(SQUARE)[None] + np.arange(count)[:, None, None] * (0, 0, 1)).astype("<f4")
    kind = np.dtype([("n", "u1"), ("quad", "<i4", 4), ("m", "u1"), ("triangle", "<i4", 3)])
    rows = np.zeros(count, kind)
    rows["n"], rows["m"] = 4, 3
    rows["quad"] = np.arange(4 * count).reshape(-1, 4)
    rows["triangle"] = rows["quad"][:, :3]
    (tmp_path / "many.ply").write_bytes(head.encode() + points.tobytes() + rows.tobytes())
    mesh = only(tmp_path / "many.ply")
    assert area(mesh) == 1.5 * count


def test_vertices_of_faces_must_be_there(tmp_path):
    for wrong in (4, -1):
        path = write(tmp_path / "a.ply", "ascii", [("vertex", xyz(), SQUARE), faces([[0, 1, 2, wrong]])])
        with pytest.raises(ValueError, match=rf"a face has vertex {wrong}, but there are 4 vertices"):
            rw.Scene(path)
